"""What the pictures of a run cost: from a key to what it does while all are drawn, against before the first."""

import re
import select
import time
from pathlib import Path

import pytest

from tests.benchmarks.test_pictures import KEY_MS, SIZES, process_cpu_s, say
from tests.patience import HANG_S
from tests.system.command import catseye, emulated, own_runtime
from tests.system.screen import Screen, on_screen

PRESSES = 100
SPEED = "60"
DRAWN = "v: next"
"""Stands in the frame of the pictures, which are more than have room."""

MOST = 3.0
"""Times the peer's median: the same key on the same screen before there is a picture, in the same terminal."""


@pytest.mark.parametrize("size", SIZES)
def test_keys_are_served_while_pictures_are_drawn(tmp_path: Path, size: tuple[int, int]) -> None:
    """The key changes the level of the log, which its frame says, with open-loop under way."""
    with own_runtime(), emulated(tmp_path, "--speed", SPEED) as bench:
        arguments = ("--cell", bench.cell, "--speed", SPEED, "--runs", "runs")
        catseye("run", "reflector-search", *arguments, cwd=tmp_path)
        with on_screen("tui", *arguments, cwd=tmp_path, size=size) as screen:
            screen.shows("STOP F12")
            screen.press("f4")
            screen.shows("Log")
            before_ms = sorted(_press(screen) for _ in range(PRESSES))
            catseye("run", "open-loop", *arguments, "--detach", cwd=tmp_path)
            screen.shows(DRAWN)
            cpu_s = process_cpu_s(screen)
            during_ms = sorted(_press(screen) for _ in range(PRESSES))
            key_cpu_ms = 1e3 * (process_cpu_s(screen) - cpu_s) / PRESSES
            shown = screen.text
            screen.press("f12")
            screen.shows("stopped")
    middle, last = PRESSES // 2, round(0.99 * PRESSES) - 1
    say(
        f"{size[0]}×{size[1]}, a run under way: key p50 {during_ms[middle]:.0f} ms, p99 {during_ms[last]:.0f} ms of "
        f"{PRESSES} (aim {KEY_MS:g} ms), {key_cpu_ms:.0f} ms of CPU each, with all that comes in; before the first "
        f"picture {before_ms[middle]:.0f} and {before_ms[last]:.0f} ms"
    )
    assert DRAWN in shown
    assert during_ms[middle] < MOST * before_ms[middle]


def _press(screen: Screen) -> float:
    """Press the key for the next level of the log; return how long it takes until the frame says so, ms."""
    before = _level(screen.text)
    pressed_s = time.monotonic()
    screen.press("f")
    while _level(screen.text) == before:
        assert time.monotonic() < pressed_s + HANG_S, screen.text
        select.select([screen.descriptor], [], [], 0.5)
    return 1e3 * (time.monotonic() - pressed_s)


def _level(text: str) -> str:
    found = re.search(r"─ Log(: \w+)?", text)
    return "" if found is None else found[0]
