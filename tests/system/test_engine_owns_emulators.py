"""The emulated bench of Set-up: it outlives the screen that started it, and ends with its engine."""

import contextlib
import os
import signal
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.service.address import find_socket, is_live
from tests.system.command import own_runtime
from tests.system.guarded import until
from tests.system.screen import Screen, on_screen
from tests.system.socket_client import Lines


@pytest.fixture
def screen(tmp_path: Path) -> Iterator[Screen]:
    """A terminal on an emulated bench that was started by a key."""
    with own_runtime(), on_screen("tui", "--speed", "20", cwd=tmp_path, size=(120, 40)) as shown:
        shown.shows("Emulated bench")
        shown.press("4")
        shown.shows("beam")
        try:
            yield shown
        finally:
            with contextlib.suppress(OSError, AssertionError):
                os.kill(engine_pid(tmp_path), signal.SIGKILL)


def is_served(folder: Path) -> bool:
    """Return whether somebody listens at the robot of the emulated bench."""
    robot = load_cell(folder / "emulated-bench.toml").cell.robot.endpoint
    with contextlib.closing(socket.socket()) as probe:
        return probe.connect_ex(("127.0.0.1", int(robot.rpartition(":")[2]))) == 0


def engine_pid(folder: Path) -> int:
    path = find_socket(folder / "catseye-runs")
    # A process that was killed leaves its socket behind.
    assert path is not None
    assert is_live(path)
    with contextlib.closing(Lines(str(path))) as client:
        snapshot = client.ask("hello", client="test", who="test")["snapshot"]
    assert snapshot["emulated_speed"] == 20.0
    return int(snapshot["pid"])


@pytest.mark.parametrize("end", [signal.SIGTERM, signal.SIGKILL], ids=["ended", "killed"])
def test_a_killed_screen_leaves_engine_and_bench_which_end_together(
    screen: Screen, end: signal.Signals, tmp_path: Path
) -> None:
    until(lambda: is_served(tmp_path))
    screen.process.kill()
    screen.process.wait()
    pid = engine_pid(tmp_path)
    assert is_served(tmp_path)
    os.kill(pid, end)
    until(lambda: not is_served(tmp_path))


def test_quitting_an_idle_screen_ends_the_bench(screen: Screen, tmp_path: Path) -> None:
    until(lambda: is_served(tmp_path))
    screen.press("ctrl+q")
    assert screen.ended() == 0
    until(lambda: not is_served(tmp_path))
