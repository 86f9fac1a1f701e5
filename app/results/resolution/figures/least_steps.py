"""Least steps and lost motion of a joint over its positions, motor torque below (Fig. 8 of the resolution paper)."""

from collections.abc import Iterable, Sequence
from typing import Final, TypeAlias

import numpy as np

from catseye.app.results.figures import Axis, Figure, Ink, Level, Line, Mark, Panel, Points, Role
from catseye.app.results.resolution.naming import UNIT_SIGNS, shipped_mark
from catseye.app.results.resolution.result import AnyTest
from catseye.calibration.core.types import Floats

_CAPTION: Final = (
    "Least increment steps and reversal error over the joint's position, with 95 % intervals of the steps. Hollow: a "
    "reversal error without a change of the torque's sign, which says nothing about play; lost motion is positive, "
    "the negative of ISO 230-2's reversal error. Below: mean motor torque of the backlash test in both directions; "
    "play is crossed where zero lies between them."
)
_NOTHING: Final = 1e-12
PointWithEnds: TypeAlias = tuple[float, float, float, float]
"""Place across, value, lower and upper end."""


def least_step_figure(joint: str, tests: Sequence[AnyTest]) -> Figure | None:
    """Return what was found of one joint over its positions; None where less than two positions were tested.

    Args:
        joint: its name.
        tests: of any joint.
    """
    placed = [test for test in tests if test.joint == joint and test.position is not None]
    if len({test.position for test in placed}) < 2:
        return None
    unit = UNIT_SIGNS[placed[0].unit]
    steps = Panel(
        joint,
        Axis(shared=True),
        decades_of(f"step, reversal / {unit}", _shown(placed)),
        _step_marks(placed),
    )
    torques = _torque_marks(placed)
    rows: tuple[tuple[Panel, ...], ...] = ((steps,),)
    below = Axis(f"position of {joint} / {unit}")
    if torques:
        rows = (*rows, (Panel("", below, Axis("torque / N m"), torques),))
    else:
        rows = ((Panel(joint, below, steps.y, steps.marks),),)
    return Figure(
        f"least-steps-{joint}",
        f"Least steps and reversal error of {joint}",
        f"{joint}{shipped_mark(placed)}. {_CAPTION}",
        rows,
        heights=(2.0, 1.0) if torques else (),
        aspect=0.5 if torques else 0.4,
    )


def _shown(tests: Sequence[AnyTest]) -> list[float]:
    ends = [end for test in tests if test.lis is not None for end in (test.lis.low, test.lis.high)]
    return ends + [test.reversal.value for test in tests if test.reversal is not None]


def decades_of(label: str, values: Sequence[float]) -> Axis:
    """Return an axis from one power of ten to another that holds all positive values."""
    shown = np.log10([value for value in values if value > 0.0] or [1.0])
    return Axis(label, low=float(np.floor(shown.min())), high=float(np.ceil(shown.max())), decades=True)


def _step_marks(tests: Sequence[AnyTest]) -> tuple[Mark, ...]:
    marks: list[Mark] = []
    kinds: tuple[tuple[str, int | None, Ink, str], ...] = (
        ("decaying", 1, Role.POSITIVE, "least step, positive"),
        ("decaying", -1, Role.NEGATIVE, "least step, negative"),
        ("iso", None, Role.CONVENTIONAL, "least step, ISO 230"),
    )
    for kind, direction, ink, label in kinds:
        found = [
            (test.position, test.lis.value, test.lis.low, test.lis.high)
            for test in tests
            if test.test == kind
            and test.direction == direction
            and test.lis is not None
            and test.position is not None
        ]
        marks += with_intervals(found, ink, label)
    for valid, label in ((True, "reversal error"), (False, "reversal error, not valid")):
        reversals = [
            (test.position, test.reversal.value, test.reversal.value, test.reversal.value)
            for test in tests
            if test.reversal is not None and bool(test.reversal.valid) is valid and test.position is not None
        ]
        if points := _logarithms(reversals):
            x, y, _, _ = points
            marks.append(Points(x, y, Role.REVERSAL, label, hollow=not valid, size=5.0))
    return tuple(marks)


def with_intervals(found: Iterable[PointWithEnds], ink: Ink, label: str, *, marker: str = "") -> list[Mark]:
    """Return points with their intervals over a logarithmic axis; those without a marker of their own are joined."""
    points = _logarithms(found)
    if points is None:
        return []
    x, y, low, high = points
    interrupted = np.full(x.size, np.nan)
    return [
        Line(np.repeat(x, 3), np.column_stack([low, high, interrupted]).ravel(), ink, width=0.7),
        Points(x, y, ink, label, marker=marker, joined=not marker),
    ]


def _logarithms(found: Iterable[PointWithEnds]) -> tuple[Floats, Floats, Floats, Floats] | None:
    """Return points by place; a lower end of 0, below which nothing was judged, lies below every axis."""
    rows = np.array([row for row in sorted(found) if row[1] > 0.0])
    if not rows.size:
        return None
    x, value, low, high = rows.T
    return x, np.log10(value), np.log10(np.maximum(low, _NOTHING)), np.log10(high)


def _torque_marks(tests: Sequence[AnyTest]) -> tuple[Mark, ...]:
    rows = sorted(
        (test.position, test.torque.forward_nm, test.torque.backward_nm)
        for test in tests
        if test.torque is not None and test.position is not None
    )
    if not rows:
        return ()
    x, forward, backward = np.array(rows).T
    return (
        Level(0.0, Role.CHANGE, width=1.0),
        Points(x, forward, Role.POSITIVE, "torque forwards", joined=True),
        Points(x, backward, Role.NEGATIVE, "torque backwards", joined=True),
    )
