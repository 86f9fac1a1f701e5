"""A profile with the wrong sign or unit: search and measurement say so and stop."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from catseye.app.store.catalog import resolve_run
from catseye.app.store.reader import RunReader
from catseye.drivers import counter
from tests.system.command import Emulated, catseye, emulated, last_run

SPEED = "400"

DEFAULT = Path(counter.__file__).parent / "profiles" / "default.toml"

FAULTS = {
    ("sign = 1 ", "sign = -1 "): "falls where the beam grows longer: its sign is reversed",
    (
        'unit = "mm"',
        'unit = "um"',
    ): r"gives 0\.00\d+ mm where .*, as if m were read as mm, or mm as µm",
    (
        'unit = "mm"',
        'unit = "inch"',
    ): r"gives 25\.\d+ mm where the beam changes by 1 mm, as if mm were read as inches",
}
"""What a profile says of a counter in mm, and what is said of that."""


@dataclass(frozen=True)
class Searched:
    """A bench whose reflectors have been found with a sound profile."""

    folder: Path
    bench: Emulated

    def wrong_cell(self, right: str, wrong: str) -> Path:
        """Write a cell file of the same bench with a wrong profile."""
        profile = DEFAULT.read_text(encoding="utf-8").replace("(?P<unit>[A-Za-zµ]*)", "[A-Za-zµ]*")
        assert right in profile
        (self.folder / "counter.toml").write_text(profile.replace(right, wrong), encoding="utf-8")
        text = self.bench.cell.read_text(encoding="utf-8")
        assert 'profile = "default"' in text
        cell = self.folder / "wrong.toml"
        cell.write_text(text.replace('profile = "default"', 'profile = "counter.toml"'), encoding="utf-8")
        return cell


@pytest.fixture(scope="module")
def searched(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Searched]:
    folder = tmp_path_factory.mktemp("counter")
    with emulated(folder, "--speed", SPEED, "--seed", "5") as bench:
        done = catseye("run", "reflector-search", "--cell", bench.cell, "--speed", SPEED, cwd=folder)
        assert done.returncode == 0, done.stderr
        yield Searched(folder, bench)


@pytest.mark.parametrize("procedure", ["reflector-search", "open-loop"])
@pytest.mark.parametrize("words", FAULTS)
def test_a_wrong_profile_is_named_and_the_run_fails(
    searched: Searched, procedure: str, words: tuple[str, str]
) -> None:
    cell, folder = searched.wrong_cell(*words), searched.folder
    done = catseye("run", procedure, "--cell", cell, "--speed", SPEED, cwd=folder)
    assert done.returncode == 1, done.stderr
    assert re.search(FAULTS[words], " ".join(done.stderr.split())), done.stderr
    run = RunReader(resolve_run(folder / "catseye-runs", last_run(folder, procedure)))
    assert run.status == "failed"
    assert len(run.rows("points")) <= 20
