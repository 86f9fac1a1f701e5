"""Runs that lose their disk: what the command has to say and do, and what has to be left."""

import random
import resource
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from catseye.app.exitcode import ExitCode
from catseye.app.store.catalog import list_runs
from tests.system.command import Emulated
from tests.system.failing_disk import CALLS, FAULTS, FailingDisk
from tests.system.interruptions import Moment, Process
from tests.system.procedure_kills import Reference, to_its_end
from tests.system.trials import Trial


@dataclass
class Losses:
    """What was tried.

    Attributes:
        struck: how often each fault met a run.
        missed: how often it came too late.
        points: how many points had been reported as stored by then.
        resumed: how many of the runs went on to their end, or had said nothing and were begun anew.
    """

    struck: Counter[str] = field(default_factory=Counter)
    missed: int = 0
    points: int = 0
    resumed: int = 0

    def met(self, fault: str, life: Process) -> None:
        """Count a fault that met a run."""
        self.struck[fault] += 1
        self.points += len(life.points)


def with_a_failing_disk(
    trial: Trial, bench: Emulated, disk: FailingDisk, reference: Reference, rng: random.Random, losses: Losses
) -> None:
    """Let the disk fail at a random call of a random kind; the run goes on when it is whole again."""
    fault, calls = rng.choice(list(FAULTS)), rng.choice(CALLS)
    most = {"write": 400, "sync": 40, "make": 8, "name": 12, "all": 400}[calls]
    # As many early calls as late ones.
    number = int(most ** rng.random())
    order = disk.order(fault, calls, number, rng.choice([0, 0, 1, 100, 3000]))
    story = trial.story(bench)
    life = story.live(disk=order)
    text = f"{fault}, {calls} {number}: {disk.struck or 'not reached'}"
    if not disk.struck:
        assert life.returncode == 0, (text, life.stderr)
        losses.missed += 1
        return
    require_stopped(life, bench, text)
    losses.met(fault, life)
    to_its_end(trial, story, reference)
    losses.resumed += 1


def with_a_lost_folder(
    trial: Trial, bench: Emulated, reference: Reference, moment: Moment, losses: Losses, name: str
) -> None:
    """Take the folder away, or the room in it, while the run is under way; it goes on when that is undone."""
    story = trial.story(bench)
    runs = story.folder / "catseye-runs"
    known = {run.path for run in list_runs(runs)}
    moved: list[Path] = []

    def strike(pid: int) -> None:
        new = [run.path for run in list_runs(runs) if run.path not in known]
        if new:
            moved.extend(STRIKES[name](pid, new[0]))

    def repair() -> None:
        for one in moved:
            _back(one, runs)

    life = story.live(moment=moment, strike=strike, repair=repair)
    if not moved or life.returncode == ExitCode.DONE:
        losses.missed += 1
        return
    require_stopped(life, bench, name)
    losses.met(name, life)
    to_its_end(trial, story, reference)
    losses.resumed += 1


def require_stopped(life: Process, bench: Emulated, text: str) -> None:
    """The command says what is wrong with storing in a sentence, with its exit code; the arm stands and stays so."""
    assert life.returncode == ExitCode.STORAGE, f"{text}: code {life.returncode}: {life.stderr}"
    assert "Traceback" not in life.stderr, f"{text}: {life.stderr}"
    assert "internal error" not in life.stderr, f"{text}: {life.stderr}"
    before = bench.ask(op="arm")
    assert not before["moving"], text
    assert bench.ask(op="arm")["joints"] == before["joints"], text


def _move_run(_pid: int, run: Path) -> list[Path]:
    return [run.rename(run.parent.parent / run.name)]


def _no_file_grows(pid: int, run: Path) -> list[Path]:
    resource.prlimit(pid, resource.RLIMIT_FSIZE, (0, 0))
    return [run]


STRIKES: dict[str, Callable[[int, Path], list[Path]]] = {
    "folder moved": _move_run,
    "file size limit": _no_file_grows,
}


def _back(moved: Path, runs: Path) -> None:
    if moved.parent != runs:
        moved.rename(runs / moved.name)
