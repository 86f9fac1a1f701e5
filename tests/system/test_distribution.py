"""Wheel and source distribution: what is in them, and that what is unpacked works beside a stranger's folders."""

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

import pytest

import catseye

ROOT = Path(__file__).parents[2]
ROOMS = ("app", "calibration", "drivers", "procedures", "simulators")
SOURCE = Path(catseye.__path__[0])


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the wheel and the sdist, built from a copy of what belongs to the project."""
    folder = tmp_path_factory.mktemp("dist")
    copy = folder / "checkout"
    shutil.copytree(ROOT, copy, symlinks=True, ignore=_IGNORED)
    command = [sys.executable, "-c", _BUILD, str(folder)]
    subprocess.run(command, cwd=copy, check=True, capture_output=True, timeout=300)
    return folder


_BUILD = """
import sys
from setuptools.build_meta import build_sdist, build_wheel
(folder,) = sys.argv[1:]  # the first build changes them
build_wheel(folder)
build_sdist(folder)
"""
_IGNORED = shutil.ignore_patterns(
    ".*_cache", ".venv*", ".git", "__pycache__", "build", "*.egg-info", "catseye-*"
)


@pytest.fixture(scope="module")
def unpacked(built: Path) -> Path:
    """Return the folder that the wheel is unpacked in, as an installer does it."""
    (wheel,) = built.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(built / "site")
    return built / "site"


def sources() -> Iterator[PurePosixPath]:
    """Yield every file of the rooms, named from the package's folder."""
    for room in ROOMS:
        for path in (SOURCE / room).rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts:
                yield PurePosixPath(path.relative_to(SOURCE))


def test_a_wheel_installs_one_package_alone(unpacked: Path) -> None:
    names = {path.name for path in unpacked.iterdir() if path.suffix != ".dist-info"}
    assert names == {"catseye"}


def test_every_file_of_the_rooms_is_in_the_wheel(unpacked: Path) -> None:
    files = set(sources())
    assert len(files) > 1000
    assert {name for name in files if not (unpacked / "catseye" / name).is_file()} == set()


def test_the_sdist_holds_tests_docs_and_makefile(built: Path) -> None:
    (sdist,) = built.glob("*.tar.gz")
    with tarfile.open(sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    kept = {
        str(path.relative_to(ROOT))
        for folder in ("tests", "docs")
        for path in (ROOT / folder).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    kept |= {"Makefile", "constraints.txt", "CHANGELOG.md", "LICENSE", "README.md", "pyproject.toml"}
    assert kept - names == set()


def test_the_description_has_no_link_that_leads_nowhere(unpacked: Path) -> None:
    (metadata,) = unpacked.glob("*.dist-info/METADATA")
    description = metadata.read_text("utf-8").partition("\n\n")[2]
    assert len(description.splitlines()) > 10
    targets = [part.partition(")")[0] for part in description.split("](")[1:]]
    assert [target for target in targets if not target.startswith("https://")] == []


@pytest.mark.parametrize("words", [["-m", "catseye", "procedures"], ["-c", "import catseye.drivers"]])
def test_a_strangers_folders_never_shadow_ours(unpacked: Path, tmp_path: Path, words: list[str]) -> None:
    for room in ROOMS:
        (tmp_path / room).mkdir()
        (tmp_path / room / "__init__.py").write_text("raise SystemExit(9)", encoding="utf-8")
    where = {**os.environ, "PYTHONPATH": str(unpacked)}
    done = subprocess.run(
        [sys.executable, *words],
        cwd=tmp_path,
        env=where,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
