"""Panels of motion resolution in rows, and what panels of step errors have in common."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from catseye.app.results.figures import Axis, Dash, Ink, Level, Mark, Panel, Points, Role
from catseye.app.results.resolution.naming import UNIT_SIGNS, named_positions, shipped_mark
from catseye.app.results.resolution.result import AnyTest, Unit

SHOWN_PERCENT: Final = 60.0
"""Where axes of step errors end; steps far below the least one scatter by hundreds."""

BEYOND: Final = f"Points beyond ±{SHOWN_PERCENT:g} % are not shown."

_ACROSS: Final = 3

Rows = tuple[tuple[Panel | None, ...], ...]


def in_rows(panels: Sequence[Panel | None]) -> Rows:
    """Return panels of one scale up, at most three a row; those beside another have its numbers."""
    across = min(_ACROSS, len(panels))
    places = [*panels, *[None] * (-len(panels) % across)]
    rows = (places[first : first + across] for first in range(0, len(places), across))
    return tuple(
        tuple(
            replace(panel, y=replace(panel.y, label="", shared=True)) if panel and beside else panel
            for beside, panel in zip([None, *row], row, strict=False)
        )
        for row in rows
    )


def aspect_of(rows: Rows) -> float:
    """Return the height of rows over their width; two figures of two rows stand on a page."""
    return 0.07 + 0.25 * len(rows)


def error_panel(title: str, unit: Unit, tests: Sequence[AnyTest], marks: Sequence[Mark]) -> Panel:
    """Return a panel of step errors over the logarithm of the command, with the thresholds of tests."""
    levels: list[Mark] = [Level(0.0, Role.AXIS, width=0.6)]
    for percent in sorted({test.threshold_percent for test in tests}):
        levels += [Level(sign * percent, Role.CHANGE, dash="dashed") for sign in (1.0, -1.0)]
    return Panel(
        title,
        Axis(f"commanded step / {UNIT_SIGNS[unit]}", decades=True),
        Axis("step error / %", low=-SHOWN_PERCENT, high=SHOWN_PERCENT),
        (*levels, *marks),
    )


def measured_points(test: AnyTest, ink: Ink, label: str = "") -> Points:
    """Return the errors of single steps that the instrument resolves."""
    judged = [move for move in test.moves if move.judged and move.error_percent is not None]
    error = np.array([move.error_percent for move in judged], dtype=np.float64)
    return Points(np.log10([abs(move.command) for move in judged]), error, ink, label, size=2.5, faint=True)


def least_step_mark(least: float, ink: Ink, dash: Dash = "dotted") -> Level:
    """Return the upright line of a least step, which is positive."""
    return Level(float(np.log10(least)), ink, vertical=True, dash=dash, width=1.2)


def by_position(joint: str, tests: Sequence[AnyTest]) -> list[tuple[str, list[AnyTest]]]:
    """Return the tests of a joint by position, each with its name."""
    groups = [
        (name, [test for test in tests if test.joint == joint and test.position == position])
        for name, position in named_positions(tests, joint)
    ]
    return [(f"{name}{shipped_mark(members)}", members) for name, members in groups]
