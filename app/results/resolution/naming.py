"""How tests and what they give are called in reports."""

import math
from collections.abc import Sequence
from typing import Final

from catseye.app.results.numbers import NOTHING, Format, fixed, number
from catseye.app.results.resolution.result import AnyTest, Direction, Unit

UNIT_SIGNS: Final[dict[Unit, str]] = {"deg": "°", "mm": "mm"}
STEP: Final = Format("significant", 2)
"""A least step is known to a few steps of a series of 7 % each."""

SHIPPED: Final = "✱"
"""Marks what was recorded on the emulated bench and shipped with the program."""

POSITION: Final = Format("plain")


def with_unit(value: float | None, unit: Unit, form: Format = STEP) -> str:
    """Return a length or an angle with its unit; a dash for none."""
    text = number(value, form)
    blank = "" if unit == "deg" else " "
    return text if text == NOTHING else f"{text}{blank}{UNIT_SIGNS[unit]}"


def direction_sign(direction: Direction | None) -> str:
    """Return + or −, ± for both."""
    return {1: "+", -1: "−", None: "±"}[direction]


def least_step_text(test: AnyTest) -> str:
    """Return the least step of a test with its interval: `0.0012° (0.0011° … 0.0014°)`; a dash for none."""
    if test.lis is None:
        return NOTHING
    value, low, high = (
        with_unit(one, test.unit, _as_exact_as(test.lis.value))
        for one in (test.lis.value, test.lis.low, test.lis.high)
    )
    return f"{value} ({low} … {high}){shipped_mark([test])}"


def shipped_mark(tests: Sequence[AnyTest]) -> str:
    """Return what stands behind values of tests of which one is shipped with the program."""
    return f" {SHIPPED}" if any(test.shipped for test in tests) else ""


def _as_exact_as(value: float) -> Format:
    """Return the format of the ends of an interval: the decimals that show the value with two digits."""
    return fixed(max(0, 1 - math.floor(math.log10(abs(value))))) if value else STEP


def interval_text(value: float | None, low: float | None, high: float | None) -> str:
    """Return a least step with its interval in the unit of its table, a dash for what is not known."""
    if value is None:
        return NOTHING
    form = _as_exact_as(value)
    return f"{number(value, form)} ({number(low, form)} … {number(high, form)})"


def place(test: AnyTest) -> str:
    """Return joint and position of a test, direction and pose of a Cartesian one: `A1 at −175°`, `+X at P1`."""
    if test.test == "cartesian":
        name = f"{direction_sign(test.direction)}{test.joint}"
        return name if test.pose is None else f"{name} at {test.pose}"
    where = "" if test.position is None else f" at {with_unit(test.position, test.unit, POSITION)}"
    return f"{test.joint}{where}"


def title(test: AnyTest) -> str:
    """Return what a figure of a test is called."""
    if test.test == "cartesian" or test.direction is None:
        return place(test)
    return f"{place(test)}, {direction_sign(test.direction)}"


def joints_of(tests: Sequence[AnyTest]) -> list[str]:
    """Return the joints of tests in their first order."""
    return list(dict.fromkeys(test.joint for test in tests))


def named_positions(tests: Sequence[AnyTest], joint: str) -> list[tuple[str, float | None]]:
    """Return where a joint was tested, upwards, with names: `K1 = −175°`; without a name where nothing is stated.

    Names are those of the runs and of the arm's description. Where they do not contradict it, positions are counted
    upwards.
    """
    own = [test for test in tests if test.joint == joint]
    stated = sorted({test.position for test in own if test.position is not None})
    given = {test.position: test.position_name for test in own if test.position_name is not None}
    counted = {position: f"K{place}" for place, position in enumerate(stated, 1)}
    names = counted if given.items() <= counted.items() else given
    named: list[tuple[str, float | None]] = []
    for position in stated:
        value = with_unit(position, own[0].unit, POSITION)
        named.append((f"{names[position]} = {value}" if position in names else value, position))
    return [*named, ("", None)] if any(test.position is None for test in own) else named
