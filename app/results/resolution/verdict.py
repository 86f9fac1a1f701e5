"""What tests come to, in sentences: a statement each, and one for many tests of one joint."""

from collections.abc import Sequence
from typing import Final

from catseye.app.results.model import Block, Sign, Statement
from catseye.app.results.numbers import counted, listed
from catseye.app.results.resolution.naming import least_step_text, place, title, with_unit
from catseye.app.results.resolution.result import AnyTest

_MOST_APART: Final = 4
"""More tests of one kind and joint are said in one statement."""


def verdict(tests: Sequence[AnyTest], refused: Sequence[str] = ()) -> list[Block]:
    """Return what the tests come to.

    Args:
        refused: tests that cannot be evaluated: which, and why.
    """
    groups: dict[tuple[str, str], list[AnyTest]] = {}
    for test in tests:
        groups.setdefault((test.joint, test.test), []).append(test)
    said: list[Block] = [statement for members in groups.values() for statement in _said_of(members)]
    shipped = [test for test in tests if test.shipped]
    if shipped:
        text = (
            f"{counted(len(shipped), 'shipped recording')} of the emulated bench among the tests, which say nothing "
            f"about this arm: {listed(dict.fromkeys(place(test) for test in shipped), 6)}"
        )
        said.append(Statement(Sign.ATTENTION, text))
    return [*said, *(Statement(Sign.ATTENTION, f"Not evaluated: {text}") for text in refused)]


def _said_of(tests: Sequence[AnyTest]) -> list[Statement]:
    """Return what tests of one kind and joint come to."""
    of_reversal = tests[0].test == "backlash"
    if len(tests) <= _MOST_APART:
        return [_reversal_said(test) if of_reversal else _step_said(test) for test in tests]
    return _reversals_said(tests) if of_reversal else _steps_said(tests)


def _step_said(test: AnyTest) -> Statement:
    name = f"{title(test)}, ISO 230" if test.test == "iso" else title(test)
    if test.lis is None:
        why = f": {test.flags[-1]}" if test.flags else ""
        return Statement(Sign.ATTENTION, f"{name}: no least step can be stated{why}")
    return Statement(Sign.NEUTRAL, f"{name}: least step {least_step_text(test)}")


def _steps_said(tests: Sequence[AnyTest]) -> list[Statement]:
    stated = sorted(
        (test for test in tests if test.lis), key=lambda test: test.lis.value if test.lis else 0.0
    )
    kind = ", ISO 230" if tests[0].test == "iso" else ""
    said = [_step_said(test) for test in tests if test.lis is None]
    if stated:
        smallest, largest = least_step_text(stated[0]), least_step_text(stated[-1])
        text = (
            f"{tests[0].joint}{kind}, {counted(len(stated), 'test')}: least steps from {smallest}, "
            f"{title(stated[0])}, to {largest}, {title(stated[-1])}"
        )
        said.insert(0, Statement(Sign.NEUTRAL, text))
    return said


def _reversal_said(test: AnyTest) -> Statement:
    if test.reversal is None:
        return Statement(Sign.ATTENTION, f"{place(test)}: no reversal error can be stated")
    said = f"{place(test)}: reversal error {with_unit(test.reversal.value, test.unit)}"
    if test.reversal.valid:
        return Statement(Sign.NEUTRAL, f"{said}; the torque changes its sign: it is lost motion")
    why = "no torque was recorded" if test.reversal.valid is None else "the torque keeps its sign"
    return Statement(Sign.ATTENTION, f"{said}; {why}: it says nothing certain about play")


def _reversals_said(tests: Sequence[AnyTest]) -> list[Statement]:
    valid = [test for test in tests if test.reversal is not None and test.reversal.valid]
    said = [_reversal_said(test) for test in tests if test not in valid]
    if valid:
        ends = sorted(test.reversal.value for test in valid if test.reversal is not None)
        smallest, largest = (with_unit(end, valid[0].unit) for end in (ends[0], ends[-1]))
        text = (
            f"{valid[0].joint}: reversal errors {smallest} … {largest} at {counted(len(valid), 'position')}, where "
            "the torque changes its sign: they are lost motion"
        )
        said.insert(0, Statement(Sign.NEUTRAL, text))
    return said
