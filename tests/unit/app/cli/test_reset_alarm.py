"""reset-alarm at a terminal: what is typed there, and Ctrl-C."""

import asyncio
import os
import pty
import signal
import sys
import threading
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, closing
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace

import pytest

from catseye.app.cell import load
from catseye.app.cli import reset_alarm as command
from catseye.app.errors import SafetyError
from catseye.app.service import alarm as service
from catseye.app.service.alarm import Alarm
from tests.patience import HANG_S


@dataclass
class Controller:
    """In an alarm, with somebody at a terminal before it."""

    terminal: int
    alarm: Alarm = field(default_factory=lambda: Alarm(2600, "out of the range", resets=True))
    resets: int = 0

    async def reset(self) -> None:
        self.resets += 1

    def ask(self) -> None:
        """Run the command."""
        command.reset_alarm(Path("cell.toml"))


@pytest.fixture
def controller(monkeypatch: pytest.MonkeyPatch) -> Iterator[Controller]:
    ours, theirs = pty.openpty()
    made = Controller(ours)

    @asynccontextmanager
    async def seen(_cell: object) -> AsyncIterator[Controller]:
        yield made

    monkeypatch.setattr(service, "seen_controller", seen)
    monkeypatch.setattr(load, "load_cell", lambda _file: SimpleNamespace(cell=None))
    with closing(os.fdopen(ours, "wb", 0)), os.fdopen(theirs) as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        yield made


@pytest.fixture
def interrupt(monkeypatch: pytest.MonkeyPatch) -> None:
    """Press Ctrl-C once the question is there."""

    def asked(text: str, *, heard: bool) -> None:
        del heard
        if "Type its number" in text:
            loop = asyncio.get_running_loop()
            loop.call_soon(lambda: loop.call_soon(lambda: os.kill(os.getpid(), signal.SIGINT)))

    monkeypatch.setattr(command, "note", asked)


def test_one_ctrl_c_ends_the_question_and_resets_nothing(controller: Controller, interrupt: None) -> None:
    del interrupt
    # Whatever still reads the terminal then would keep the program waiting: this lets go of it after a while.
    late = threading.Timer(HANG_S, lambda: os.write(controller.terminal, b"\n"))
    late.start()
    with pytest.raises(KeyboardInterrupt):
        controller.ask()
    assert late.is_alive()
    late.cancel()
    assert controller.resets == 0


def test_its_number_resets_it(controller: Controller) -> None:
    os.write(controller.terminal, b"2600\n")
    controller.ask()
    assert controller.resets == 1


@pytest.mark.parametrize(
    ("typed", "said"), [(b"\n", "the alarm stays"), (b"7\n", "not 7"), (b"x\n", "not 0")]
)
def test_anything_else_leaves_it(controller: Controller, typed: bytes, said: str) -> None:
    os.write(controller.terminal, typed)
    with pytest.raises(SafetyError, match=said):
        controller.ask()
    assert controller.resets == 0
