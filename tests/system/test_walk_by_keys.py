"""A plan walked by a held key, at a terminal and in the terminal UI; the emulator reports whether the arm moves."""

import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.engine.walked.register import own_legs
from catseye.app.exitcode import ExitCode
from catseye.app.store.reader import RunReader
from tests.patience import HANG_S
from tests.system.by_keys import choose
from tests.system.command import Emulated, emulated, own_runtime
from tests.system.screen import Screen, on_screen

REPEAT_S = 0.033
DELAY_S = 0.5


SMALL = re.sub(
    r"theta2_deg = .*",
    "theta2_deg = [40.0, 70.0]",
    re.sub(r"theta1_deg = .*", "theta1_deg = [-30.0, 0.0]", TEMPLATE),
)


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    with (
        own_runtime(),
        emulated(
            tmp_path_factory.mktemp("walk"), "--speed", "1", text=SMALL, module="tests.system.prompt_drives"
        ) as running,
    ):
        yield running


def moving(bench: Emulated) -> bool:
    return bool(bench.ask(op="state")["moving"])


def held_until(screen: Screen, met: Callable[[], bool]) -> None:
    """Hold the space bar as a keyboard does until something is so."""
    screen.press(" ")
    time.sleep(DELAY_S)
    end_s = time.monotonic() + HANG_S
    while not met():
        assert time.monotonic() < end_s, screen.text
        screen.press(" ")
        time.sleep(REPEAT_S)


def stands(bench: Emulated) -> None:
    end_s = time.monotonic() + HANG_S
    while moving(bench):
        assert time.monotonic() < end_s
        time.sleep(0.02)


def walked(folder: Path, runs: str) -> Path:
    (path,) = (folder / runs).glob("*_walk_*")
    return path


def test_a_held_space_bar_walks_at_a_terminal(bench: Emulated) -> None:
    folder = bench.cell.parent
    words = ("run", "open-loop", "--cell", bench.cell, "--search", "none", "--walk", "--runs", "by-terminal")
    with on_screen(*words, cwd=folder, size=(120, 40)) as screen:
        screen.shows("not an enabling device", "SUSPENDED")
        screen.press(" ")
        time.sleep(DELAY_S)
        assert not moving(bench), "a key that does not repeat moves nothing"
        held_until(screen, lambda: moving(bench))
        stands(bench)
        # Held again it goes on; a motion that is driven to its end counts.
        path = walked(folder, "by-terminal")
        held_until(screen, lambda: len(RunReader(path).steps()) >= 2)
        screen.press("s")
        assert screen.ended() == ExitCode.INTERRUPTED
        stands(bench)
        assert "stopped" in screen.text
    assert RunReader(path).status == "stopped"
    assert len(own_legs(path)) >= 2
    assert RunReader(path).rows("points") == []


def test_a_held_space_bar_walks_in_the_terminal_ui(bench: Emulated) -> None:
    folder = bench.cell.parent
    with on_screen("tui", "--cell", bench.cell, "--runs", "by-tui", cwd=folder, size=(100, 30)) as screen:
        screen.shows("● robot", "● interferometer")
        screen.press("f3")
        screen.shows("beam-level", "limits hold")
        choose(screen, "Automated open-loop")
        screen.press("w")
        screen.shows("Walk-through", "not an enabling device", "hold Space")
        screen.press("enter")
        screen.shows("Walk-through")
        screen.press("f8")
        screen.shows("SUSPENDED", "hold the space bar to walk on")
        assert not moving(bench)
        # Said only while it moves: looked for while the key is held.
        shown = ("Walking", "hold Space, let go to stop")
        held_until(screen, lambda: moving(bench) and all(text in screen.text for text in shown))
        stands(bench)
        screen.shows("SUSPENDED")
        held_until(screen, lambda: moving(bench))
        screen.press("focus lost")
        stands(bench)
        screen.press("f12")
        screen.shows("STOPPED")
    assert RunReader(walked(folder, "by-tui")).meta["procedure"] == "walk"
