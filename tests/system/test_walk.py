"""Walking an emulated arm without a terminal: it goes on by itself, is killed, goes on again, and is walked once."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from catseye.app.engine.walked.register import own_legs
from catseye.app.exitcode import ExitCode
from catseye.app.store.reader import RunReader
from catseye.app.store.verify import verify
from tests.system.command import SPEED, Emulated, catseye, emulated, only

SMALL = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-60.0, -30.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [40.0, 70.0]",
    **only("P1"),
}


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    with emulated(tmp_path_factory.mktemp("walk"), edit=SMALL) as running:
        yield running


def words(bench: Emulated, *more: str) -> tuple[str | Path, ...]:
    return ("run", "open-loop", "--cell", bench.cell, "--search", "none", "--walk", *more)


def walks(folder: Path) -> list[Path]:
    return sorted((folder / "catseye-runs").glob("*_walk_*"))


def test_a_killed_walk_goes_on_and_is_walked_once(bench: Emulated, tmp_path: Path) -> None:
    killed = catseye(*words(bench, "--speed", SPEED), cwd=tmp_path, crash="after-commit")
    assert killed.returncode < 0
    (path,) = walks(tmp_path)
    first = own_legs(path)
    assert first
    resumed = catseye("resume", path.name, cwd=tmp_path)
    assert resumed.returncode == 0, resumed.stderr
    assert own_legs(path)[: len(first)] == first
    assert RunReader(path).status == "complete"
    assert RunReader(path).meta["walk"]
    assert verify(path).ok
    # Nothing is left to walk: the next one ends where it began.
    again = catseye(*words(bench, "--speed", SPEED), cwd=tmp_path)
    assert again.returncode == 0, again.stderr
    assert own_legs(walks(tmp_path)[-1]) == []


def test_a_walk_is_listed_as_a_run(bench: Emulated, tmp_path: Path) -> None:
    walked = catseye(*words(bench, "--speed", SPEED, "--json"), cwd=tmp_path)
    assert walked.returncode == 0, walked.stderr
    (path,) = walks(tmp_path)
    listed = catseye("runs", cwd=tmp_path)
    assert "walk" in listed.stdout
    shown = catseye("show", path.name, cwd=tmp_path)
    assert "the speed override stays at" in shown.stdout
    assert catseye("report", path.name, "-o", "walk.html", cwd=tmp_path).returncode == 0


def test_a_rehearsal_mentions_the_walk(bench: Emulated, tmp_path: Path) -> None:
    rehearsed = catseye(
        "run", "open-loop", "--cell", bench.cell, "--search", "none", "--dry-run", cwd=tmp_path
    )
    assert rehearsed.returncode == 0
    assert "--walk" in rehearsed.stderr


@pytest.mark.parametrize(
    ("option", "says"), [("--dry-run", "touches no device"), ("--detach", "at its keys")]
)
def test_what_contradicts_a_walk_is_refused(bench: Emulated, tmp_path: Path, option: str, says: str) -> None:
    refused = catseye(*words(bench, option), cwd=tmp_path)
    assert refused.returncode == ExitCode.USAGE
    assert says in refused.stderr
    assert walks(tmp_path) == []
