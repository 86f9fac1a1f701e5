"""What a run under way costs a key: while its pictures are drawn, against the same screen on hold."""

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
WATCHED_S = 3.0
SPEED = "60"
DRAWN = "v: next"
"""Stands in the frame of the pictures, which are more than have room."""

MOST = 3.0
"""Times the CPU of the peer: the same key with the same pictures and log, but nothing new to draw with it."""


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
            catseye("run", "open-loop", *arguments, "--detach", cwd=tmp_path)
            screen.shows(DRAWN)
            without = _cpu_share(screen)
            during_ms, during_cpu_ms = _pressed(screen, without)
            shown = screen.text
            screen.press("h")
            screen.shows("GO ON F8")
            held_ms, held_cpu_ms = _pressed(screen)
            screen.press("f12")
            screen.shows("stopped")
    say(
        f"{size[0]}×{size[1]}, a run under way: {100 * without:.0f} % of a core for it, "
        f"key {during_cpu_ms:.0f} ms of CPU, {latency_text(during_ms)}; "
        f"on hold {held_cpu_ms:.0f} ms of CPU, {latency_text(held_ms)}"
    )
    assert DRAWN in shown
    assert during_cpu_ms < MOST * held_cpu_ms


def _pressed(screen: Screen, without: float = 0.0) -> tuple[list[float], float]:
    """Press the key many times; return how long each took, sorted, ms, and the CPU time of one, ms.

    Args:
        without: share of a core that the program takes without a key, which is not the key's.
    """
    began_s, began_cpu_s = time.monotonic(), process_cpu_s(screen)
    taken_ms = sorted(_press(screen) for _ in range(PRESSES))
    cpu_s = process_cpu_s(screen) - began_cpu_s - without * (time.monotonic() - began_s)
    return taken_ms, 1e3 * cpu_s / PRESSES


def _cpu_share(screen: Screen) -> float:
    """Return the share of a core that the program takes while no key is pressed."""
    began_s, began_cpu_s = time.monotonic(), process_cpu_s(screen)
    while time.monotonic() < began_s + WATCHED_S:
        assert screen.text
        select.select([screen.descriptor], [], [], 0.5)
    return (process_cpu_s(screen) - began_cpu_s) / (time.monotonic() - began_s)


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
