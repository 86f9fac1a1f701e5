"""Keyboards as they repeat, against what the switch says is held."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.service.dead_man import FIRST_REPEAT_S, REPEAT_S, DeadMan

BIT = 1e-6


@pytest.mark.parametrize(("delay_s", "interval_s"), [(0.25, 0.03), (0.5, 0.033), (0.66, 0.04), (1.0, 0.1)])
def test_a_key_counts_as_held_while_it_repeats(delay_s: float, interval_s: float) -> None:
    switch: DeadMan[str] = DeadMan()
    switch.press("left", 0.0)
    assert switch.held(delay_s / 2.0) is None
    times = [delay_s + number * interval_s for number in range(30)]
    for time_s in times:
        switch.press("left", time_s)
        assert switch.held(time_s) == "left"
    assert switch.held(times[-1] + 0.3 - BIT) == "left"
    assert switch.held(times[-1] + 0.3 + BIT) is None
    assert switch.held(times[-1] + 0.3) is None


@given(st.floats(0.0, 10.0))
def test_a_tap_moves_nothing(later_s: float) -> None:
    switch: DeadMan[str] = DeadMan()
    switch.press("left", 5.0)
    assert switch.held(5.0 + later_s) is None


@given(st.floats(FIRST_REPEAT_S + BIT, 100.0))
def test_taps_that_are_far_apart_move_nothing(apart_s: float) -> None:
    switch: DeadMan[str] = DeadMan()
    for number in range(5):
        switch.press("left", number * apart_s)
        assert switch.held(number * apart_s) is None


def test_another_key_begins_anew() -> None:
    switch: DeadMan[str] = DeadMan()
    switch.press("left", 0.0)
    switch.press("left", 0.5)
    switch.press("right", 0.53)
    assert switch.held(0.53) is None
    switch.press("right", 0.56)
    assert switch.held(0.56) == "right"


def test_what_was_let_go_has_to_be_held_anew() -> None:
    switch: DeadMan[str] = DeadMan()
    for time_s in (0.0, 0.5, 0.53):
        switch.press("left", time_s)
    switch.let_go()
    assert switch.held(0.54) is None
    switch.press("left", 0.56)
    assert switch.held(0.56) is None


@given(st.floats(REPEAT_S + BIT, FIRST_REPEAT_S))
def test_the_press_after_a_pause_is_a_first_one(pause_s: float) -> None:
    switch: DeadMan[str] = DeadMan()
    switch.press("left", 0.0)
    switch.press("left", 0.5)
    switch.press("left", 0.5 + pause_s)
    assert switch.held(0.5 + pause_s) is None
