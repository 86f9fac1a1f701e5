"""What pictures cost: the first screen, keys that draw another picture, and one map against matplotlib's.

Times are targets, printed with the machine and never asserted; latencies only where other work leaves the machine
alone. What a key costs is CPU time of the program, which other work hardly changes.
"""

import os
import platform
import select
import statistics
import time
from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path

import pytest

from catseye.app.render import mpl
from catseye.app.results.figures import Figure
from catseye.app.results.scara.figures.maps import map_figure
from catseye.app.results.scara.result import read_result
from catseye.app.tui.widgets.figure_drawing import draw_figure
from tests.patience import HANG_S
from tests.system.command import Emulated, emulated, own_runtime
from tests.system.screen import CATSEYE, Screen, on_screen
from tests.system.test_engine_service import SMALL, SPEED
from tests.unit.app.tui.stored_results import write_results

SIZES = [(80, 24), (120, 40), (200, 60)]
STARTS = 5
ROUNDS = 20
DRAWN = 9
FIRST_S, KEY_MS = 1.0, 100.0
QUIET_LOAD = 2.0
"""Above it latencies are those of the other work."""

PARTS = {
    "3": "quantity ",
    "4": "nominal  identified",
    "5": "distances  rms",
    "6": "The error map was identified",
    "2": "reversal / mdeg",
}
"""What stands on the part of a result that a key shows, and not on the part before it."""


EMPTY = """
from textual.app import App
from textual.widgets import Static

class Empty(App):
    def compose(self):
        yield Static("STOP F12")

Empty().run()
"""
"""The peer of the first screen: a program of the same toolkit that shows one line."""

MOST = 3.0
"""Times the peer's median."""


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    with own_runtime(), emulated(tmp_path_factory.mktemp("tui"), "--speed", SPEED, edit=SMALL) as running:
        write_results(running.cell.parent)
        yield running


@pytest.mark.parametrize("size", SIZES)
def test_first_screen_and_keys_with_every_picture(bench: Emulated, size: tuple[int, int]) -> None:
    first_s, empty_s = [], []
    for _ in range(STARTS):
        first_s.append(opened_s("tui", "--cell", bench.cell, cwd=bench.cell.parent, size=size))
        empty_s.append(opened_s(cwd=bench.cell.parent, size=size, program=("-c", EMPTY)))
    with on_screen("tui", "--cell", bench.cell, cwd=bench.cell.parent, size=size) as screen:
        screen.press("f6")
        screen.shows("error-map.json", "Enter shows one")
        screen.press("enter")
        screen.shows(PARTS["2"])
        before_s = process_cpu_s(screen)
        taken_ms = sorted(pressed_ms(screen, key) for _ in range(ROUNDS) for key in PARTS)
        key_cpu_ms = 1e3 * (process_cpu_s(screen) - before_s) / len(taken_ms)
    say(
        f"{size[0]}×{size[1]}: first screen {statistics.median(first_s):.2f} s (aim {FIRST_S:g} s), "
        f"of an empty program of the same toolkit {statistics.median(empty_s):.2f} s; "
        f"key to another picture {key_cpu_ms:.0f} ms of CPU, {latency_text(taken_ms)}"
    )
    assert len(taken_ms) == ROUNDS * len(PARTS)
    assert statistics.median(first_s) < MOST * statistics.median(empty_s)


def test_a_map_costs_less_than_matplotlibs(tmp_path: Path) -> None:
    write_results(tmp_path)
    figure = map_figure(read_result(tmp_path / "error-map.json"))
    assert figure is not None
    ours_s, theirs_s = [], []
    for _ in range(DRAWN):
        ours_s.append(cpu_s(lambda: draw_figure(figure, 198, 50)))
        theirs_s.append(cpu_s(lambda: page_picture(figure)))
    ours, theirs = statistics.median(ours_s), statistics.median(theirs_s)
    say(f"a map of 198 × 50 cells {1e3 * ours:.1f} ms, by matplotlib as SVG {1e3 * theirs:.0f} ms of CPU")
    assert ours < 0.5 * theirs


def page_picture(figure: Figure) -> None:
    mpl.drawn(figure).savefig(BytesIO(), format="svg")


def cpu_s(work: Callable[[], object]) -> float:
    began_s = time.process_time()
    work()
    return time.process_time() - began_s


def process_cpu_s(screen: Screen) -> float:
    """Return the CPU time that a program in a terminal has used, s: other work hardly changes it."""
    fields = Path(f"/proc/{screen.process.pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def opened_s(
    *arguments: str | Path, cwd: Path, size: tuple[int, int], program: tuple[str, ...] = CATSEYE
) -> float:
    """Return how long a program takes until its first screen is there, s."""
    start_s = time.monotonic()
    with on_screen(*arguments, cwd=cwd, size=size, program=program) as screen:
        screen.shows("STOP F12")
        return time.monotonic() - start_s


def pressed_ms(screen: Screen, key: str) -> float:
    """Press the key of a part; return how long it takes until its bytes are at the terminal, ms."""
    assert PARTS[key] not in screen.text
    pressed_s = time.monotonic()
    screen.press(key)
    while PARTS[key] not in screen.text:
        assert time.monotonic() < pressed_s + HANG_S, screen.text
        select.select([screen.descriptor], [], [], 0.05)
    return 1e3 * (screen.read_at_s - pressed_s)


def latency_text(taken_ms: list[float]) -> str:
    """Return median and 99th percentile of sorted latencies, if the machine is quiet enough to tell them."""
    if os.getloadavg()[0] >= QUIET_LOAD:
        return f"latencies not told at this load (aim p99 {KEY_MS:g} ms)"
    p99_ms = taken_ms[round(0.99 * len(taken_ms)) - 1]
    return f"p50 {statistics.median(taken_ms):.0f} ms, p99 {p99_ms:.0f} ms of {len(taken_ms)} (aim {KEY_MS:g} ms)"


def say(figure: str) -> None:
    load = ", ".join(f"{one:.1f}" for one in os.getloadavg())
    machine = f"{platform.machine()}, {os.cpu_count()} cores, load {load}, Python {platform.python_version()}"
    print(f"\n{figure} [{machine}]")  # noqa: T201  # the figure is the result of a benchmark
