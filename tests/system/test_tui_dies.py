"""The user interface dies in every way a terminal can: the controller's emulator shows what the arm does then."""

import contextlib
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from catseye.app.service.address import find_socket
from catseye.app.store.reader import RunReader
from tests.patience import HANG_S
from tests.system.command import Emulated, emulated, own_runtime
from tests.system.screen import Screen, on_screen
from tests.system.socket_client import Lines
from tests.system.test_engine_service import (
    SMALL,
    SPEED,
    held,
    motions,
    nothing_moves,
    while_the_arm_moves,
)


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    with own_runtime(), emulated(tmp_path_factory.mktemp("tui"), "--speed", SPEED, edit=SMALL) as running:
        yield running


@pytest.fixture
def run(bench: Emulated) -> Iterator[Path]:
    """Return a run that is held; whatever becomes of it, nothing moves after the test."""
    found = held(bench)
    yield found
    if (path := find_socket(found)) is not None and RunReader(found).status == "running":
        with contextlib.closing(Lines(str(path))) as client:
            client.ask("hello", client="test", who="test")
            client.ask("abort")
            client.until(event="run-ended")


@contextlib.contextmanager
def at_work(bench: Emulated, run: Path, size: tuple[int, int] = (80, 24)) -> Iterator[Screen]:
    """Open a terminal from which a held run goes on, as soon as the arm moves."""
    with on_screen("tui", "--cell", bench.cell, "--speed", SPEED, cwd=bench.cell.parent, size=size) as screen:
        screen.shows("HELD", run.name)
        screen.let_go_on()
        while_the_arm_moves(bench)
        yield screen


def _terminate(screen: Screen) -> None:
    screen.process.send_signal(signal.SIGTERM)


def _hang_up(screen: Screen) -> None:
    screen.process.send_signal(signal.SIGHUP)


def _kill(screen: Screen) -> None:
    screen.process.send_signal(signal.SIGKILL)


def _close(screen: Screen) -> None:
    screen.close()


@pytest.mark.parametrize(
    ("die", "code"),
    [(_terminate, 143), (_hang_up, 129), (_close, None), (_kill, -signal.SIGKILL)],
    ids=["SIGTERM", "SIGHUP", "closed terminal", "SIGKILL"],
)
def test_arm_is_held_when_the_interface_dies(
    bench: Emulated, run: Path, die: object, code: int | None
) -> None:
    assert callable(die)
    with at_work(bench, run) as screen:
        before = motions(bench)
        die(screen)
        screen.ended()
        if code is not None:
            assert screen.process.returncode == code
    assert motions(bench) >= before
    end_s = time.monotonic() + HANG_S
    while (state := state_of(run)) != "HELD":
        assert time.monotonic() < end_s, state
    nothing_moves(bench)


def test_a_terminal_that_takes_no_more_output_keeps_nobody(bench: Emulated, run: Path) -> None:
    """Nobody reads: the program waits for its terminal while the strip and the ages go on being drawn."""
    with at_work(bench, run, size=(200, 60)) as screen:
        time.sleep(5.0)
        screen.process.send_signal(signal.SIGTERM)
        assert screen.process.wait(10.0) == 143


def test_quitting_with_stop_ends_the_run_at_standstill(bench: Emulated, run: Path) -> None:
    with at_work(bench, run) as screen:
        screen.press("ctrl+q")
        screen.shows("leave it running")
        screen.press("3")
        assert screen.ended() == 0
    assert RunReader(run).status == "stopped"
    nothing_moves(bench)


def test_stop_works_above_a_dialog(bench: Emulated, run: Path) -> None:
    with at_work(bench, run) as screen:
        screen.press("ctrl+q")
        screen.shows("leave it running")
        screen.press("f12")
        screen.shows("stopped")
    nothing_moves(bench)


def state_of(run: Path) -> str:
    """Return the state that the engine of a run reports."""
    path = find_socket(run)
    assert path is not None
    with contextlib.closing(Lines(str(path))) as client:
        return str(client.ask("hello", client="test", who="test")["snapshot"]["state"])
