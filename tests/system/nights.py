"""Nights on an emulated bench: a job with one fault at a random moment, then the same job again without one."""

import json
import os
import random
import shutil
import socket
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import IO, Any

from catseye.app.errors import StorageError
from catseye.app.store.catalog import list_runs
from catseye.app.store.reader import Accept, RunReader
from catseye.app.store.verify import verify
from tests.machine_lines import faults_of
from tests.patience import HANG_S
from tests.system import forked
from tests.system.command import SPEED, Emulated, emulated, environment, start
from tests.system.interruptions import commands

JOB = "night"
STAGES = ("reflector-search", "open-loop", "identify", "report")
DEADLINE_S = float(os.environ.get("CATSEYE_NIGHT_S", "200"))
"""Of each call; on a quiet machine one takes 40 s."""

LATE_S = 30.0
"""How long after its deadline a job may still seal its run and write its verdict."""

STEPS = {"reflector-search": 15, "open-loop": 120}
"""How many steps of a run a moment may lie behind."""

NODES = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-70.0, -40.0, -10.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [40.0, 65.0, 90.0]",
}
"""The smallest plan with three reflectors whose maps can be identified."""

_HEAD = 'format = "catseye-campaign/1"\nname = "night"\n'
_SEARCH = 'name = "reflector-search"\n'
_UNANSWERED = '[[stage]]\nname = "validation-path"\nparams.instrument = "file"\nparams.step_mm = 50\n'


@dataclass(frozen=True)
class Moment:
    """When a fault strikes: busy machines are slow, so a run's life is counted in its steps.

    Attributes:
        stage: in which; empty for before the first.
        steps: of its run that are done.
        delay_s: real seconds after that.
    """

    stage: str
    steps: int
    delay_s: float

    @classmethod
    def drawn(cls, rng: random.Random, weights: tuple[int, ...] = (1, 3, 6, 1, 1)) -> "Moment":
        """Draw a moment anywhere in a night, most of them while the arm moves.

        Args:
            weights: of the time before the first stage, and of each stage.
        """
        (stage,) = rng.choices(("", *STAGES), weights)
        steps = rng.randint(0, STEPS.get(stage, 0))
        return cls(stage, steps, rng.uniform(0.0, 0.05 if steps else 2.0))


class Lab:
    """An emulated bench whose emulators may be killed, and start again on the same ports."""

    def __init__(self, bench: Emulated, said: IO[bytes]) -> None:
        self._bench = bench
        self._process = bench.process
        self._said = said

    @property
    def folder(self) -> Path:
        return self._bench.cell.parent

    @property
    def runs(self) -> Path:
        return self.folder / "catseye-runs"

    def ask(self, **request: object) -> dict[str, Any]:
        return self._bench.ask(**request)

    def kill(self) -> None:
        """Kill the emulators."""
        self._process.kill()
        self._process.wait(HANG_S)

    def restart(self) -> None:
        """Start the emulators again."""
        words = ("emulate", "cell.toml", "--speed", SPEED)
        with open(os.devnull, "wb") as nowhere:
            self._process = forked.Forked(
                "catseye", words, cwd=self.folder, env=environment(), out=nowhere, err=self._said
            )
        until(self._answers, HANG_S)

    def _answers(self) -> bool:
        with suppress(OSError, ValueError), socket.create_connection(self._bench.control, timeout=1.0):
            return bool(self.ask(op="identify"))
        return False


@contextmanager
def lab(folder: Path) -> Iterator[Lab]:
    """Emulate a bench with a small plan."""
    with emulated(folder, edit=NODES) as bench, tempfile.TemporaryFile() as said:
        own = Lab(bench, said)
        few = "params.poses = 5\n"
        stages = "".join(f'[[stage]]\nname = "{name}"\n' for name in STAGES).replace(_SEARCH, _SEARCH + few)
        (folder / "night.toml").write_text(_HEAD + stages, encoding="utf-8")
        (folder / "asking.toml").write_text(_HEAD + stages + _UNANSWERED, encoding="utf-8")
        try:
            yield own
        finally:
            own.kill()


class Call:
    """One call of `catseye campaign`, read as it goes.

    Attributes:
        process: of the campaign.
        lines: of its stdout.
        said: lines of its stderr.
        took_s: real time to its end.
        reads: somebody reads its stdout.
    """

    def __init__(self, place: Lab, *options: str, file: str = "night.toml", job: str = JOB) -> None:
        words = ("campaign", file, "--cell", "cell.toml", "--job", job, "--speed", SPEED, "--json")
        self.begun_s = time.monotonic()
        self.process = start(*words, *options, cwd=place.folder)
        self.lines: list[str] = []
        self.said: list[str] = []
        self.took_s = 0.0
        self.reads = True
        self._leaves = False
        self._told = threading.Condition()
        self._steps: dict[str, int] = {}
        self._stage = ""
        self._threads = [threading.Thread(target=each) for each in (self._read, self._hear)]
        for thread in self._threads:
            thread.start()

    @property
    def code(self) -> int:
        """Exit code."""
        assert self.process.returncode is not None
        return self.process.returncode

    def until(self, moment: Moment) -> bool:
        """Wait for a moment; return whether it has come before the end of the job."""
        with self._told:
            while not self._has_come(moment) and self.process.poll() is None:
                self._told.wait(0.2)
            come = self._has_come(moment)
        time.sleep(moment.delay_s)
        return come and self.process.poll() is None

    def _has_come(self, moment: Moment) -> bool:
        reached = not moment.stage or moment.stage in self._steps
        return reached and self._steps.get(moment.stage, 0) >= moment.steps

    def close_stdout(self) -> None:
        """Read no more of it, and close it."""
        self.reads = False

    def leave_stdout(self) -> None:
        """Read no more of it, and keep it open."""
        self._leaves = True
        self.reads = False

    def end(self, limit_s: float = HANG_S) -> int:
        """Wait for its end; return its exit code."""
        try:
            self.process.wait(limit_s)
        except BaseException:
            self.process.kill()
            self.process.wait()
            raise
        finally:
            for thread in self._threads:
                thread.join()
        return self.code

    def _read(self) -> None:
        assert self.process.stdout is not None
        with closing(self.process.stdout) as stdout:
            while self.reads and (line := stdout.readline()):
                # A kill may cut the last line.
                if line.endswith("\n"):
                    with self._told:
                        self._take(line)
                        self._told.notify_all()
            if self._leaves:
                self.process.wait()

    def _take(self, line: str) -> None:
        self.lines.append(line)
        event = json.loads(line)
        if event.get("event") == "stage-started":
            self._stage = event["stage"]
            self._steps.setdefault(self._stage, 0)
        elif event.get("event") == "step-done":
            self._steps[self._stage] += 1

    def _hear(self) -> None:
        assert self.process.stderr is not None
        with closing(self.process.stderr) as stderr:
            self.said.extend(stderr)
        self.took_s = time.monotonic() - self.begun_s


def children(pid: int) -> list[int]:
    """Return the processes that a process has started."""
    found: list[int] = []
    with suppress(OSError):
        for task in Path(f"/proc/{pid}/task").iterdir():
            found += map(int, (task / "children").read_text().split())
    return found


def descendants(pid: int) -> list[int]:
    """Return the processes that a process and its children have started."""
    return [each for child in children(pid) for each in (child, *descendants(child))]


def is_alive(pid: int) -> bool:
    """Return whether a process goes on; one that nobody has reaped does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def until(holds: Callable[[], bool], limit_s: float) -> None:
    """Wait until something holds."""
    end_s = time.monotonic() + limit_s
    while not holds():
        assert time.monotonic() < end_s, "it did not come to that"
        time.sleep(0.05)


@dataclass
class Night:
    """A night over all of its calls.

    Attributes:
        place: where.
        rng: of its moments.
        struck: the fault has come before the end of the job.
        codes: with which the calls may end, besides 0 where the fault came too late.
        calls: in order; others than the first may be of jobs that run beside.
        faults: of the program, found by the checks.
    """

    place: Lab
    rng: random.Random
    moment: Moment
    struck: bool = False
    calls: list[Call] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    def call(self, *options: str, **how: str) -> Call:
        """Call the job."""
        made = Call(self.place, "--deadline", f"{DEADLINE_S:g}s", *options, **how)
        self.calls.append(made)
        return made

    def require(self, holds: bool, text: str) -> None:
        """Note a fault of the program, unless something holds."""
        if not holds:
            self.faults.append(text)


def decided(call: Call) -> str:
    """Return what a call said at last."""
    last = json.loads(call.lines[-1]) if call.lines else {}
    return f"{last.get('code')} {last.get('text') or last.get('error')}"


def spend(folder: Path, fault: Callable[[Night], None], rng: random.Random) -> Night:
    """Spend a night with a fault, and call its job again; return what came out."""
    with ExitStack() as stack:
        place = stack.enter_context(lab(folder))
        night = Night(place, rng, Moment.drawn(rng))
        try:
            fault(night)
            again = night.call()
            night.require(again.end() == 0, f"called again: code {again.code}: {decided(again)}")
        except (AssertionError, subprocess.TimeoutExpired) as error:
            night.faults.append(f"it did not end: {error}")
        finally:
            for call in night.calls:
                call.process.kill()
        check(night)
        return night


def check(night: Night) -> None:
    """Note what contradicts the promises: ends, verdicts, records, and one run at a time on the arm."""
    for call in night.calls:
        _check_call(night, call)
    _check_runs(night)


def _check_call(night: Night, call: Call) -> None:
    """Its end, and what it said, agree and come in time."""
    night.require(call.took_s < DEADLINE_S + LATE_S, f"took {call.took_s:.0f} s")
    if not call.lines or call.code < 0 or not call.reads:
        return
    for text in faults_of("".join(call.lines)):
        night.faults.append(text)
    last = json.loads(call.lines[-1])
    is_verdict = last.get("event") == "campaign-ended" or "error" in last
    night.require(is_verdict, f"last line: {call.lines[-1][:200]}")
    night.require(last.get("exit_code") == call.code, f"code {call.code}, last line {last.get('exit_code')}")


def _check_runs(night: Night) -> None:
    """No record is lost, no point stored twice, and no two runs have had the arm at a time."""
    verdict = night.place.runs / "jobs" / JOB / "verdict.json"
    night.require(verdict.is_file(), "no verdict.json")
    if verdict.is_file():
        night.require(json.loads(verdict.read_text())["verdict"] == "passed", "verdict.json is not passed")
    told = _told_points(night.calls)
    lives: list[tuple[str, str, str]] = []
    for run in list_runs(night.place.runs):
        try:
            reader = RunReader(run.path, Accept.UNCHECKED)
            night.faults += [f"{run.name}: {text}" for text in verify(run.path).problems]
            stored = commands(reader) if run.procedure == "open-loop" else []
            lives += _lives(reader)
        except StorageError as error:
            night.require(run.name not in told, f"{run.name}: {error}")
            continue
        night.require(len(stored) == len(set(stored)), f"{run.name}: a point is stored twice")
        lost = told.pop(run.name, set()) - set(stored)
        night.require(not lost, f"{run.name}: {len(lost)} points are lost")
    night.require(not told, f"runs are lost: {sorted(told)}")
    lives.sort()
    for (_, end, first), (begin, _, second) in pairwise(lives):
        night.require(end <= begin, f"{first} and {second} had the arm at a time: {end}, {begin}")


def _told_points(calls: list[Call]) -> dict[str, set[tuple[object, ...]]]:
    told: dict[str, set[tuple[object, ...]]] = {}
    for call in calls:
        for line in call.lines:
            event = json.loads(line)
            if event.get("event") == "point":
                point = event["point"]
                key = ("reflector", "theta1_deg", "theta2_deg", "direction1", "direction2")
                told.setdefault(event["run"], set()).add(tuple(point[name] for name in key))
    return told


def _lives(reader: RunReader) -> list[tuple[str, str, str]]:
    """Return from when to when each process of a run had the arm, by its own records."""
    noted = [(event.time_utc, event.kind) for event in reader.events()]
    noted += [(step.started_utc, "") for step in reader.steps()] + [
        (step.done_utc, "") for step in reader.steps()
    ]
    lives: list[tuple[str, str, str]] = []
    for time_utc, kind in sorted(noted):
        if kind in {"run-opened", "run-reopened"} or not lives:
            lives.append((time_utc, time_utc, reader.path.name))
        lives[-1] = (lives[-1][0], time_utc, reader.path.name)
    return lives


def forget(folder: Path) -> None:
    """Remove what a good night has left."""
    shutil.rmtree(folder, ignore_errors=True)
