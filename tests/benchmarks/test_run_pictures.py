"""What the pictures of a run cost: from a key to what it does while all are drawn, against before the first."""

import re
import select
import time
from pathlib import Path

import pytest

from tests.benchmarks.test_pictures import SIZES, latency_text, process_cpu_s, say
from tests.patience import HANG_S
from tests.system.command import catseye, emulated, own_runtime
from tests.system.screen import Screen, on_screen

PRESSES = 100
SPEED = "60"
DRAWN = "v: next"
"""Stands in the frame of the pictures, which are more than have room."""

MOST = 3.0
"""Times the CPU of the peer: the same key on the same screen before there is a picture, in the same terminal."""


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
            before_ms, before_cpu_ms = _pressed(screen)
            catseye("run", "open-loop", *arguments, "--detach", cwd=tmp_path)
            screen.shows(DRAWN)
            during_ms, during_cpu_ms = _pressed(screen)
            shown = screen.text
            screen.press("f12")
            screen.shows("stopped")
    say(
        f"{size[0]}×{size[1]}, a run under way: key {during_cpu_ms:.0f} ms of CPU with all that comes in, "
        f"{latency_text(during_ms)}; before the first picture {before_cpu_ms:.0f} ms of CPU, "
        f"{latency_text(before_ms)}"
    )
    assert DRAWN in shown
    assert during_cpu_ms < MOST * before_cpu_ms


def _pressed(screen: Screen) -> tuple[list[float], float]:
    """Press the key many times; return how long each took, sorted, ms, and the CPU time of one, ms."""
    began_s = process_cpu_s(screen)
    taken_ms = sorted(_press(screen) for _ in range(PRESSES))
    return taken_ms, 1e3 * (process_cpu_s(screen) - began_s) / PRESSES


def _press(screen: Screen) -> float:
    """Press the key for the next level of the log; return how long until its bytes are there, ms."""
    before = _level(screen.text)
    pressed_s = time.monotonic()
    screen.press("f")
    while _level(screen.text) == before:
        assert time.monotonic() < pressed_s + HANG_S, screen.text
        select.select([screen.descriptor], [], [], 0.5)
    return 1e3 * (screen.read_at_s - pressed_s)


def _level(text: str) -> str:
    found = re.search(r"─ Log(: \w+)?", text)
    return "" if found is None else found[0]
