"""The arm moved by keys in a real terminal: the controller's emulator shows where it is, and when it stands."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from tests.patience import HANG_S
from tests.system.command import Emulated, emulated, own_runtime
from tests.system.screen import READ_S, Screen, on_screen

REPEAT_S = 0.033
"""Between two repeats of a held key, as keyboards do it."""

DELAY_S = 0.5
"""From the press to the first repeat."""


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    with (
        own_runtime(),
        emulated(
            tmp_path_factory.mktemp("jog-by-keys"), "--speed", "1", module="tests.system.prompt_drives"
        ) as running,
    ):
        yield running


@contextmanager
def jogging_screen(bench: Emulated) -> Iterator[Screen]:
    """Open a terminal in which somebody jogs at the lowest speed."""
    with on_screen("tui", "--cell", bench.cell, cwd=bench.cell.parent) as screen:
        screen.shows("● robot", "● interferometer")
        screen.press("f5")
        screen.shows("drives on, then the keys move the arm")
        screen.press("-", "-", "-", "-")
        screen.shows("1 % (cap 20 %)")
        screen.press("f8")
        screen.shows("F8  move")
        time.sleep(READ_S)
        screen.press("f8")
        screen.shows("JOG 1 %", "servo on")
        yield screen
    settled(bench, lambda: not moving(bench))


@pytest.fixture
def screen(bench: Emulated) -> Iterator[Screen]:
    """Return a terminal in which somebody jogs at the lowest speed."""
    with jogging_screen(bench) as opened:
        yield opened


def moving(bench: Emulated) -> bool:
    return bool(bench.ask(op="state")["moving"])


def j1_deg(bench: Emulated) -> float:
    return float(bench.ask(op="state")["joints"][0])


def settled(bench: Emulated, met: Callable[[], bool], limit_s: float = HANG_S) -> float:
    """Wait until something is so; return how long that took, s."""
    start_s = time.monotonic()
    while not met():
        assert time.monotonic() < start_s + limit_s, bench.ask(op="state")
        time.sleep(0.005)
    return time.monotonic() - start_s


def hold(bench: Emulated, screen: Screen, key: str) -> None:
    """Hold a key as a keyboard does, until the arm moves."""
    screen.press(key)
    time.sleep(DELAY_S)
    assert not moving(bench), "nothing moves before the key has repeated"
    end_s = time.monotonic() + HANG_S
    while not moving(bench):
        assert time.monotonic() < end_s
        screen.press(key)
        time.sleep(REPEAT_S)


def test_steps_have_the_chosen_length_and_esc_releases_the_arm(bench: Emulated, screen: Screen) -> None:
    start_deg = j1_deg(bench)
    screen.press("3", "left")
    settled(bench, lambda: abs(j1_deg(bench) - start_deg - 1.0) < 0.01 and not moving(bench))
    # A step is over when the engine has seen the arm stand; keys that come before are not taken.
    time.sleep(1.0)
    screen.shows("stands")
    screen.press("right")
    settled(bench, lambda: abs(j1_deg(bench) - start_deg) < 0.01 and not moving(bench))
    screen.press("escape")
    screen.shows("ended it", "servo off")
    screen.press("left")
    time.sleep(0.5)
    assert abs(j1_deg(bench) - start_deg) < 0.01


def test_only_a_held_key_moves_in_hold_mode(bench: Emulated, screen: Screen) -> None:
    start_deg = j1_deg(bench)
    screen.press("m")
    screen.shows("[hold]")
    screen.press("left")
    time.sleep(1.2)
    assert j1_deg(bench) == start_deg
    hold(bench, screen, "left")
    settled(bench, lambda: not moving(bench))
    assert j1_deg(bench) > start_deg
    screen.shows("stands")


@pytest.mark.parametrize(
    "let_go",
    [
        pytest.param(lambda screen: screen.process.kill(), id="SIGKILL"),
        pytest.param(lambda screen: screen.close(), id="closed terminal"),
        pytest.param(lambda screen: screen.press("f12"), id="STOP"),
        pytest.param(lambda screen: screen.press("f2"), id="another screen"),
        pytest.param(lambda screen: screen.press("focus lost"), id="focus lost"),
    ],
)
def test_what_stops_the_arm_although_the_key_is_held(
    bench: Emulated, screen: Screen, let_go: Callable[[Screen], None]
) -> None:
    screen.press("m")
    screen.shows("[hold]")
    hold(bench, screen, "right")
    let_go(screen)
    settled(bench, lambda: not moving(bench))
    time.sleep(0.3)
    assert not moving(bench)
