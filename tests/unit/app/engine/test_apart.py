"""Readings that stand apart from the others of a standstill."""

import random

import pytest

from catseye.app.engine.apart import apart

STILL = [12.3456, 12.3457, 12.3455, 12.3456, 12.3456, 12.3457, 12.3456, 12.3455, 12.3456, 12.3456]


@pytest.mark.parametrize("change_mm", [5e-3, -5e-3, 1e-3, -0.3456, 100.0])
def test_a_changed_digit_stands_apart(change_mm: float) -> None:
    values = [*STILL[:4], STILL[4] + change_mm, *STILL[5:]]
    assert apart(values) == [4]


def test_two_changed_digits_in_ten_stand_apart() -> None:
    assert apart([*STILL[:6], STILL[6] - 5e-3, STILL[7], STILL[8] + 5e-3, STILL[9]]) == [6, 8]


@pytest.mark.parametrize("places", [(8, 9), (9,), (0,), (0, 1), (4, 5)])
def test_a_jump_that_stays_is_left_to_the_scatter(places: tuple[int, ...]) -> None:
    assert apart([value + 20e-3 * (at in places) for at, value in enumerate(STILL)]) == []


def test_more_than_one_in_five_is_scatter() -> None:
    assert apart([*STILL[:7], *(value + 5e-3 for value in STILL[7:])]) == []


def test_the_last_digit_does_not_stand_apart() -> None:
    assert apart([*STILL[:1] * 9, STILL[0] + 1e-4]) == []


def test_seven_readings_are_too_few_to_tell() -> None:
    assert apart([*STILL[:6], 100.0]) == []


def test_readings_that_scatter_are_rarely_told_apart() -> None:
    source = random.Random(1)
    found = sum(bool(apart([source.gauss(0.0, 1e-3) for _ in range(10)])) for _ in range(2000))
    assert found < 15


def test_an_arm_that_creeps_has_no_reading_apart() -> None:
    assert apart([1e-3 * number for number in range(10)]) == []
