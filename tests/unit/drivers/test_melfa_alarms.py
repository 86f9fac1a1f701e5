"""Alarm numbers against section 5.3 of the protocol sheet."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.melfa.alarms import describe


@pytest.mark.parametrize(
    ("number", "beginning"),
    [
        (50, "alarm H0050: external emergency stop"),
        (2000, "alarm L2000: the servo is off; switch the servo on"),
        (2602, "alarm L2602: the target is outside of the range"),
        (2802, "alarm L2802: no joint angles reach the target"),
        (6020, "alarm L6020: no operation right"),
        (6010, "alarm L6010: the controller does not know the command"),
        (5600, "alarm L5600: an alarm is active"),
        (7820, "alarm H7820: real-time control timed out"),
    ],
)
def test_numbers_of_the_sheet(number: int, beginning: str) -> None:
    assert describe(number).startswith(beginning)


@pytest.mark.parametrize(
    ("number", "words"),
    [
        (2161, "joint limit reached upwards, J1"),
        (2174, "joint limit reached downwards, J4"),
        (2132, "over-speed, J2"),
        (963, "excessive following error, J3"),
        (2182, "XYZ limit reached upwards, Y"),
        (2193, "XYZ limit reached downwards, Z"),
        (1825, "position data disagree, J5"),
    ],
)
def test_the_last_digit_of_a_family_is_the_axis(number: int, words: str) -> None:
    assert words in describe(number)


@pytest.mark.parametrize(
    ("number", "level", "beginning"),
    [
        (1650, 0, "alarm C1650: the servo cannot be switched on"),
        (9050, 0, "alarm H9050: alarm raised by a program"),
        (9250, 0, "alarm C9250: alarm raised by a program"),
        (8888, 1, "alarm H8888: alarm of level high, the servo is off"),
        (8888, 2, "alarm L8888: alarm of level low"),
        (8888, 3, "alarm C8888: caution"),
        (8888, 0, "alarm 8888: alarm that is not in the table"),
    ],
)
def test_other_numbers_fall_back_on_range_and_level(number: int, level: int, beginning: str) -> None:
    assert describe(number, level).startswith(beginning)


@given(number=st.integers(0, 9999), level=st.integers(0, 9))
def test_every_alarm_has_a_number_a_meaning_and_a_remedy(number: int, level: int) -> None:
    head, _, remedy = describe(number, level).partition("; ")
    assert f"{number:04d}: " in head
    assert len(remedy) > 10
