"""What tests come to, in sentences: a statement each, and one for many tests of one joint."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from catseye.app.results.model import Block, Sign, Statement
from catseye.app.results.numbers import EXPANDED, counted, listed
from catseye.app.results.resolution.naming import least_step_text, place, title, with_unit
from catseye.app.results.resolution.result import AnyTest

_MOST_APART: Final = 4
"""More tests of one kind and joint are said in one statement."""

_CLEAR: Final = 2.0
"""A reversal error of fewer standard uncertainties may be none."""


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
        said = [_reversal_said(test) if of_reversal else _step_said(test) for test in tests]
    else:
        said = _reversals_said(tests) if of_reversal else _steps_said(tests)
    said = [replace(one, see=_shown_by(tests[0])) for one in said]
    return [*said, *_doubts_said([test for test in tests if test.doubts])]


def _shown_by(test: AnyTest) -> tuple[str, ...]:
    """Return the tables and figures of the report that show tests of one kind and joint."""
    if test.test == "backlash":
        return "table-reversal", f"figure-least-steps-{test.joint}"
    if test.test == "cartesian":
        return "table-cartesian", "figure-cartesian-steps", f"figure-errors-{test.joint}"
    table = "table-methods" if test.test == "iso" else "table-least-steps"
    return table, f"figure-least-steps-{test.joint}", f"figure-errors-{test.joint}"


def _doubts_said(tests: Sequence[AnyTest]) -> list[Statement]:
    """Return what speaks against tests; of many only which they are."""
    if len(tests) <= _MOST_APART:
        return [Statement(Sign.ATTENTION, f"{_named(test)}: {'; '.join(test.doubts)}") for test in tests]
    which = listed([_named(test) for test in tests], 6)
    text = f"{counted(len(tests), 'test')} with something that speaks against them, see “What was noticed”: {which}"
    return [Statement(Sign.ATTENTION, text)]


def _named(test: AnyTest) -> str:
    return f"{title(test)}, ISO 230" if test.test == "iso" else title(test)


def _step_said(test: AnyTest) -> Statement:
    name = _named(test)
    if test.lis is None:
        why = "" if test.lis_reason is None else f": {test.lis_reason}"
        return Statement(Sign.ATTENTION, f"{name}: no least step can be stated{why}")
    by_rule = (
        "" if test.by_rule is None else f"; by the rule on this series {with_unit(test.by_rule, test.unit)}"
    )
    return Statement(Sign.NEUTRAL, f"{name}: least step {least_step_text(test)}{by_rule}")


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
    found = test.reversal
    if found is None:
        return Statement(Sign.ATTENTION, f"{place(test)}: no reversal error can be stated")
    value = with_unit(found.value, test.unit)
    u = "U not known" if found.u is None else f"U = {with_unit(EXPANDED * found.u, test.unit)}, k = 2"
    said = f"{place(test)}: reversal error {value} ({u})"
    if not found.valid:
        why = "the torque keeps its sign"
        if found.valid is None:
            why = "no torque was recorded" if test.torque is None else "the torque is by another clock"
        return Statement(Sign.ATTENTION, f"{said}; {why}: it says nothing certain about play")
    if found.u is None:
        return Statement(Sign.ATTENTION, f"{said}: whether it differs from zero is not known")
    if abs(found.value) < _CLEAR * found.u:
        return Statement(Sign.NEUTRAL, f"{said}: not distinguishable from none")
    if found.value < 0.0:
        return Statement(Sign.ATTENTION, f"{said}: the joint went too far, which is not lost motion")
    return Statement(Sign.NEUTRAL, f"{said}; the torque changes its sign: it is lost motion")


def _is_lost_motion(test: AnyTest) -> bool:
    found = test.reversal
    if found is None or not found.valid or found.u is None:
        return False
    return found.value >= _CLEAR * found.u


def _reversals_said(tests: Sequence[AnyTest]) -> list[Statement]:
    clear = [test for test in tests if _is_lost_motion(test)]
    said = [_reversal_said(test) for test in tests if test not in clear]
    if clear:
        found = [test.reversal for test in clear if test.reversal is not None]
        ends = min(one.value for one in found), max(one.value for one in found)
        smallest, largest = (with_unit(value, clear[0].unit) for value in ends)
        u = with_unit(EXPANDED * max(one.u or 0.0 for one in found), clear[0].unit)
        text = (
            f"{clear[0].joint}: reversal errors {smallest} … {largest} (U = {u} or less, k = 2) at "
            f"{counted(len(clear), 'position')}, where the torque changes its sign: they are lost motion"
        )
        said.insert(0, Statement(Sign.NEUTRAL, text))
    return said
