"""Commands that hear of a run: which events they get, how long they may take, and what a failure means."""

import asyncio
import json
import os
import signal
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from catseye.app.cell.model import Hooks as HooksSection
from catseye.app.protocol.run_events import ErrorReported, RunEnded, RunEvent, RunStarted, StateChanged
from catseye.app.protocol.state import ControlState
from catseye.app.service.hooks import MOST, CommandProcess, Hooks, hook_event
from tests.patience import HANG_S
from tests.unit.app.engine.fakes import ManualClock
from tests.unit.app.service.attended import handle_with

ENDED = RunEnded(status="complete", exit_code=0, text="", path="runs/r1", drives_on=False)
ALARM = ErrorReported(text="lost", exit_code=3)
ALL = HooksSection(on=["run-ended", "prompt", "alarm"], command=["tell", "lab-1"])


class Fake:
    """A command that ends by itself at a time, or by a signal that it minds."""

    def __init__(self, clock: ManualClock, ends_s: float, code: int, minds: tuple[int, ...]) -> None:
        self.clock, self.ends_s, self.code, self.minds = clock, ends_s, code, minds
        self.signals: list[tuple[int, float]] = []

    def poll(self) -> int | None:
        return self.code if self.clock.time_s >= self.ends_s else None

    def deliver(self, number: int) -> None:
        self.signals.append((number, self.clock.time_s))
        if number in self.minds:
            self.ends_s, self.code = self.clock.time_s, -number


class Lab:
    """Hooks with commands that only seem to run."""

    def __init__(
        self,
        ends_s: float = 0.0,
        code: int = 0,
        minds: tuple[int, ...] = (signal.SIGTERM, signal.SIGKILL),
        fails: OSError | None = None,
    ) -> None:
        self.clock = ManualClock()
        self.given: list[tuple[list[str], dict[str, Any]]] = []
        self.started: list[Fake] = []
        self.warnings: list[str] = []
        self.passed: list[RunEvent] = []
        self._as = (ends_s, code, minds)
        self._fails = fails
        self.hooks = Hooks(self.clock, self._start)
        self.of_run = self.hooks.of_run(ALL)
        self.publish = self.of_run.before(self.passed.append)

    def _start(self, command: Sequence[str], line: bytes) -> Fake:
        if self._fails is not None:
            raise self._fails
        assert line.count(b"\n") == 1
        assert line.endswith(b"\n")
        self.given.append((list(command), json.loads(line)))
        self.started.append(Fake(self.clock, *self._as))
        return self.started[-1]

    async def hear(self, *events: RunEvent) -> None:
        """Publish while the run's record is open, and wait until every command is over."""
        with self.of_run.attending(handle_with(self.warnings)):
            for event in events:
                self.publish(event)
            async with asyncio.timeout(HANG_S):
                await self.hooks.end()
                await asyncio.sleep(0)


@pytest.mark.parametrize(
    ("event", "name"),
    [
        (ENDED, "run-ended"),
        (ALARM, "alarm"),
        (StateChanged(state=ControlState.SUSPENDING, reason="door"), "alarm"),
        (StateChanged(state=ControlState.ABORTING), "alarm"),
        (StateChanged(state=ControlState.EXECUTE), None),
        (RunStarted(procedure="search", title="Search"), None),
    ],
)
def test_events_have_the_names_of_the_file(event: RunEvent, name: str | None) -> None:
    assert hook_event(event) == name


async def test_the_command_gets_the_event_as_one_line() -> None:
    lab = Lab()
    await lab.hear(ENDED.stamped("2026-01-02T03:04:05+00:00", "r1"))
    [(command, event)] = lab.given
    assert command == ["tell", "lab-1"]
    assert (event["event"], event["run"], event["exit_code"]) == ("run-ended", "r1", 0)
    assert lab.warnings == []


async def test_only_named_events_are_passed_on() -> None:
    lab = Lab()
    lab.of_run = lab.hooks.of_run(HooksSection(on=["run-ended"], command=["tell"]))
    lab.publish = lab.of_run.before(lab.passed.append)
    await lab.hear(ALARM, ENDED)
    assert [event["event"] for _, event in lab.given] == ["run-ended"]
    assert lab.passed == [ALARM, ENDED]


async def test_a_slow_command_is_ended_after_ten_seconds() -> None:
    lab = Lab(ends_s=1e9)
    await lab.hear(ALARM)
    [(number, at_s)] = lab.started[0].signals
    assert number == signal.SIGTERM
    assert at_s == pytest.approx(10.0, abs=0.1)
    assert len(lab.warnings) == 1
    assert "longer than 10 s" in lab.warnings[0]


async def test_a_command_that_ignores_sigterm_is_killed() -> None:
    lab = Lab(ends_s=1e9, minds=(signal.SIGKILL,))
    await lab.hear(ALARM)
    assert [number for number, _ in lab.started[0].signals] == [signal.SIGTERM, signal.SIGKILL]


async def test_more_than_four_at_once_are_dropped() -> None:
    lab = Lab(ends_s=1.0)
    await lab.hear(*[ALARM] * (MOST + 3))
    assert len(lab.started) == 4
    assert lab.hooks.dropped == 3
    assert len(lab.warnings) == 1
    assert "not passed on" in lab.warnings[0]


async def test_failures_are_one_warning_for_each_run() -> None:
    lab = Lab(code=7)
    await lab.hear(ALARM, ALARM)
    assert len(lab.warnings) == 1
    assert "tell ended with code 7" in lab.warnings[0]


async def test_a_missing_program_is_a_warning() -> None:
    lab = Lab(fails=FileNotFoundError(2, "No such file or directory"))
    await lab.hear(ALARM)
    assert "tell cannot be started: No such file or directory" in lab.warnings[0]


async def test_a_failure_after_the_end_is_logged(caplog: pytest.LogCaptureFixture) -> None:
    lab = Lab(code=7)
    await lab.hear(ENDED)
    assert lab.warnings == []
    assert "tell ended with code 7" in caplog.text


def test_a_command_reads_the_line_from_its_stdin(tmp_path: Path) -> None:
    copy = "import sys; open(sys.argv[1], 'wb').write(sys.stdin.buffer.read())"
    process = CommandProcess([sys.executable, "-c", copy, str(tmp_path / "got")], b'{"event": "x"}\n')
    assert _code_of(process.poll) == 0
    assert (tmp_path / "got").read_bytes() == b'{"event": "x"}\n'


def test_a_signal_reaches_what_the_command_started(tmp_path: Path) -> None:
    told = tmp_path / "pid"
    process = CommandProcess(["/bin/sh", "-c", f"sleep 600 & echo $! > {told}; wait"], b"\n")
    deadline_s = time.monotonic() + HANG_S
    while not told.exists() or not told.read_text():
        assert time.monotonic() < deadline_s
        time.sleep(0.01)
    process.deliver(signal.SIGKILL)
    assert _code_of(process.poll) == -signal.SIGKILL
    _require_gone(int(told.read_text()))


def _code_of(poll: Callable[[], int | None]) -> int:
    deadline_s = time.monotonic() + HANG_S
    while (code := poll()) is None:
        assert time.monotonic() < deadline_s
        time.sleep(0.01)
    return code


def _require_gone(pid: int) -> None:
    """Wait until a process is gone, or a zombie that nobody of ours has to reap."""
    deadline_s = time.monotonic() + HANG_S
    while time.monotonic() < deadline_s:
        try:
            os.kill(pid, 0)
            if Path(f"/proc/{pid}/stat").read_text().split()[2] == "Z":
                return
        except (ProcessLookupError, FileNotFoundError):
            return
        time.sleep(0.01)
    raise AssertionError(f"{pid} runs on")


@pytest.mark.parametrize(
    "given", [{"on": ["alarm"]}, {"command": ["tell"]}, {"on": ["alarm"], "command": [""]}]
)
def test_events_and_command_belong_together(given: dict[str, Any]) -> None:
    with pytest.raises(ValidationError, match="give both"):
        HooksSection.model_validate(given)
