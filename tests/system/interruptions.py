"""Runs that are killed, and what has to be true of them afterwards."""

import contextlib
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

from catseye.app.errors import StorageError
from catseye.app.store.catalog import list_runs
from catseye.app.store.reader import RunReader
from catseye.app.store.seal import APP_LOG, DATABASE, MANIFEST, UNSEALED, WIRE_LOG, read_manifest
from catseye.app.store.verify import verify
from tests.patience import HANG_S
from tests.system import forked
from tests.system.command import Emulated, environment

POINT_KEY = ("reflector", "theta1_deg", "theta2_deg", "direction1", "direction2")

_PLACE = {"step_id", "attempt", "seq", "extra"}
"""Columns that say which row of which step it is, and what holds fields that are columns as well."""

Command = tuple[object, ...]


@dataclass(frozen=True)
class Moment:
    """When a process is to end: busy machines are slow, so its life is counted in its events.

    Attributes:
        event: so many events have been published; 0 counts from its start.
        delay_s: real seconds after that.
    """

    event: int
    delay_s: float

    @classmethod
    def drawn(cls, moments: random.Random, events: int) -> "Moment":
        """Draw a moment in a life of so many events; the first ones stand for the start of the process."""
        event = max(0, moments.randint(-events // 20, events))
        return cls(event, moments.uniform(0.0, 0.1 if event == 0 else 0.03))


@dataclass
class Process:
    """One life of a run.

    Attributes:
        returncode: how the process ended.
        points: commands whose distances it reported as stored.
        steps: steps that it reported as done.
        stderr: what it said.
        events: how many it published.
    """

    returncode: int
    points: list[Command]
    steps: list[str]
    stderr: str
    events: int


@dataclass
class Story:
    """A run over all of its lives.

    Attributes:
        bench: what it runs on.
        begin: words of the command that begins the run.
        table: of its points; empty: all tables.
        key: columns that tell one command from another; empty: all that were measured.
        path: of the run, once there is one.
        lives: one after the other.
    """

    bench: Emulated
    begin: tuple[str, ...] = ("run", "open-loop", "--speed", "400")
    table: str = "points"
    key: tuple[str, ...] = POINT_KEY
    path: Path | None = None
    lives: list[Process] = field(default_factory=list)
    _done: list[str] = field(default_factory=list)
    _rows: dict[str, list[dict[str, Any]]] = field(default_factory=dict)

    @property
    def folder(self) -> Path:
        return self.bench.cell.parent

    @property
    def reader(self) -> RunReader:
        assert self.path is not None
        return RunReader(self.path)

    def live(
        self,
        *options: str,
        crash: str = "",
        moment: "Moment | None" = None,
        number: int = signal.SIGKILL,
        disk: Mapping[str, str] | None = None,
        strike: Callable[[int], None] | None = None,
        repair: Callable[[], None] | None = None,
    ) -> Process:
        """Begin the run, or go on with it, until it ends or dies; what has been reported has to be stored.

        Args:
            options: of the command.
            crash: place at which it dies by itself.
            moment: when it gets a signal.
            number: of that signal.
            disk: environment of a disk that fails; the process is begun anew, as only then it takes effect.
            strike: does at the moment, to the process, what is to be done instead of the signal.
            repair: undoes that before anybody looks at what is stored.
        """
        if self.path is None:
            known = {run.path for run in list_runs(self.folder / "catseye-runs")}
            words = [*self.begin, "--cell", str(self.bench.cell)]
        else:
            known = set()
            words = ["resume", str(self.path)]
        env = {**environment(), "CATSEYE_CRASHPOINT": crash}
        begun = forked.talking if disk is None else spawned
        with (
            tempfile.TemporaryFile() as said,
            begun(
                "catseye",
                [*words, *options, "--json"],
                cwd=self.folder,
                env={**env, **(disk or {})},
                err=said,
            ) as (process, lines),
        ):
            act = strike or (lambda pid: os.kill(pid, number))
            returncode, events = _until_its_end(process, lines, moment, act)
            said.seek(0)
            life = _life(returncode, events, said.read().decode(), self.key)
        self.lives.append(life)
        if repair is not None:
            repair()
        if self.path is None:
            new = [run.path for run in list_runs(self.folder / "catseye-runs") if run.path not in known]
            self.path = new[0] if new else None
        self._check(life)
        return life

    def _check(self, life: Process) -> None:
        """Nothing that was reported is missing, nothing that was done is undone, and the record is sound."""
        try:
            reader = RunReader(self.path) if self.path is not None else None
        except StorageError:
            reader = None
        if reader is None or "configuration" not in reader.meta:
            # It died before it had said what it is: nothing can have been measured, and a new one is begun.
            assert not self._done
            assert not life.points
            assert not life.steps
            self.path = None
            return
        done = [step.step_id for step in reader.steps()]
        assert done[: len(self._done)] == self._done, "a step that was done is gone"
        assert set(life.steps) <= set(done), "a step that was reported as done is not stored"
        reported = {command for each in self.lives for command in each.points}
        stored = commands(reader, self.table, self.key)
        assert reported <= set(stored), "a point that was reported is not stored"
        assert not self.key or len(stored) == len(set(stored)), "a point is stored twice"
        assert len(done) == len(set(done)), "a step is stored twice"
        assert verify(reader.path).problems == ()
        require_no_half_file(reader.path)
        rows = {table.name: reader.rows(table.name) for table in reader.tables()}
        for name, before in self._rows.items():
            assert rows[name][: len(before)] == before, f"{name}: a stored row is another one now"
        self._done, self._rows = done, rows


def commands(reader: RunReader, table: str = "points", key: tuple[str, ...] = POINT_KEY) -> list[Command]:
    """Return which command each stored point was measured at; without a table, each row of all of them."""
    tables = [table] if table else [each.name for each in reader.tables()]
    return [_command(row, key) for name in tables for row in reader.rows(name)]


_FILES = {
    DATABASE,
    f"{DATABASE}-wal",
    f"{DATABASE}-shm",
    f"{DATABASE}-journal",
    WIRE_LOG,
    APP_LOG,
    MANIFEST,
    UNSEALED,
    f"{MANIFEST}.tmp",
}


def require_no_half_file(run: Path) -> None:
    """Check that a run's folder holds nothing but its files, each whole, but for the last line of a log."""
    assert {path.name for path in run.iterdir()} <= _FILES
    read_manifest(run)
    for name in (WIRE_LOG, APP_LOG):
        lines = (run / name).read_bytes().split(b"\n") if (run / name).exists() else []
        broken = sum(not _is_json(line) for line in lines[:-1] if line)
        # A line that was cut by a death is ended by the next life.
        assert broken <= 1, f"{name}: {broken} broken lines"


def _is_json(line: bytes) -> bool:
    try:
        json.loads(line)
    except ValueError:
        return False
    return True


def differences_mm(reader: RunReader, reference: RunReader) -> list[float]:
    """Return what the distances of a run differ by from those of another, dead paths taken away.

    Each segment has an unknown dead path of its own: where both runs have one segment, the mean difference is zero.
    """
    expected = {_command(row): row for row in reference.rows("points")}
    segments: dict[object, list[float]] = {}
    for row in reader.rows("points"):
        other = expected[_command(row)]
        difference = _number(row["displacement_mm"]) - _number(other["displacement_mm"])
        segments.setdefault((row["reflector"], row["segment"], other["segment"]), []).append(difference)
    return [value - sum(each) / len(each) for each in segments.values() for value in each]


def _command(row: Mapping[str, Any], key: tuple[str, ...] = POINT_KEY) -> Command:
    if key:
        return tuple(row[name] for name in key)
    return tuple(sorted((name, _exactly(value)) for name, value in row.items() if name not in _PLACE))


def _exactly(value: object) -> str:
    """Return a value with all of its bits, but for the sign of zero, which SQLite does not keep."""
    return json.dumps(value + 0.0 if isinstance(value, float) else value)


def _number(value: object) -> float:
    assert isinstance(value, float)
    return value


@contextlib.contextmanager
def spawned(
    module: str, arguments: Sequence[str | Path], *, cwd: Path, env: Mapping[str, str], err: IO[Any]
) -> Iterator[tuple[subprocess.Popen[str], IO[str]]]:
    """Run a module with an interpreter of its own and yield it with its stdout; see `forked.talking`."""
    words = [sys.executable, "-m", module, *map(str, arguments)]
    with subprocess.Popen(words, cwd=cwd, env=env, stdout=subprocess.PIPE, stderr=err, text=True) as process:
        assert process.stdout is not None
        try:
            yield process, process.stdout
        finally:
            process.kill()


def _until_its_end(
    process: forked.Forked | subprocess.Popen[str],
    lines: Iterable[str],
    moment: Moment | None,
    act: Callable[[int], None],
) -> tuple[int, list[dict[str, Any]]]:
    """Return the exit code, and what it wrote to stdout."""
    with contextlib.ExitStack() as stack:

        def strike() -> None:
            # It may have ended by itself.
            with contextlib.suppress(ProcessLookupError):
                act(process.pid)

        def end_after(delay_s: float) -> None:
            killer = threading.Timer(delay_s, strike)
            killer.start()
            stack.callback(killer.join)
            stack.callback(killer.cancel)

        if moment is not None and moment.event == 0:
            end_after(moment.delay_s)
        # The last line may be cut by the kill.
        events = []
        for event in _whole(lines):
            events.append(event)
            if moment is not None and len(events) == moment.event:
                end_after(moment.delay_s)
        return process.wait(HANG_S), events


def _life(
    returncode: int, events: list[dict[str, Any]], stderr: str, key: tuple[str, ...] = POINT_KEY
) -> Process:
    points = [_command(event["point"], key) for event in events if event.get("event") == "point"]
    steps = [str(event["step"]) for event in events if event.get("event") == "step-done"]
    return Process(returncode, points, steps, stderr, len(events))


def _whole(lines: Iterable[str]) -> Iterable[dict[str, Any]]:
    for line in lines:
        if line.endswith("\n"):
            yield json.loads(line)
