"""Examples of docs/examples as packages of somebody else: listed on their page, and as if they were installed."""

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from tests.patience import HANG_S

ROOT = Path(__file__).parents[2]

_LISTING = re.compile(r"^`([\w/.]+)`\n\n```\w+\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_ENTRY = re.compile(r"^\[project\.entry-points\.\"([^\"]+)\"\]\n(.+)$", re.MULTILINE)
_NAME = re.compile(r'^name = "(.+)"$', re.MULTILINE)


@dataclass(frozen=True)
class Example:
    """A package in docs/examples, and its page.

    Attributes:
        folder: name of its folder.
        page: name of its page in docs.
    """

    folder: str
    page: str

    @property
    def path(self) -> Path:
        return ROOT / "docs" / "examples" / self.folder

    def text(self, name: str) -> str:
        """Return a file of it."""
        return (self.path / name).read_text(encoding="utf-8")

    def check_page(self) -> None:
        """Require that the page lists the files as they are."""
        shown = _LISTING.findall((ROOT / "docs" / self.page).read_text(encoding="utf-8"))
        files = [
            path
            for path in self.path.rglob("*.*")
            if path.suffix in {".py", ".toml"} and path.name != "__init__.py"
        ]
        assert sorted(name for name, _ in shown) == sorted(str(path.relative_to(self.path)) for path in files)
        for name, listing in shown:
            assert listing == self.text(name), f"{name} has changed: copy it into docs/{self.page}"

    def installed(self, folder: Path) -> Path:
        """Return a copy that looks installed: its entry point is found next to it."""
        project = folder / self.folder
        shutil.copytree(self.path, project, ignore=shutil.ignore_patterns("__pycache__", ".*"))
        described = self.text("pyproject.toml")
        entry, name = _ENTRY.search(described), _NAME.search(described)
        assert entry is not None
        assert name is not None
        facts = project / f"{name[1].replace('-', '_')}-0.1.0.dist-info"
        facts.mkdir()
        metadata = f"Metadata-Version: 2.1\nName: {name[1]}\nVersion: 0.1.0\n"
        (facts / "METADATA").write_text(metadata, encoding="utf-8")
        line = entry[2].replace('"', "")
        (facts / "entry_points.txt").write_text(f"[{entry[1]}]\n{line}\n", encoding="utf-8")
        return project


def environment(project: Path) -> dict[str, str]:
    """Return that of a process in which a project is installed."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join((str(project), str(ROOT))), "OMP_NUM_THREADS": "1"}


def run_python(project: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a module of Python in the folder of a project."""
    return subprocess.run(
        [sys.executable, "-m", *arguments],
        cwd=project,
        env=environment(project),
        capture_output=True,
        text=True,
        timeout=HANG_S,
        check=False,
    )


def run_pytest(project: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run tests in the folder of a project."""
    return run_python(project, "pytest", "-p", "no:cacheprovider", *arguments)
