"""Step errors over the commanded step, with moving mean, band, threshold and least step (Fig. 7 of the paper)."""

from collections.abc import Sequence

import numpy as np

from catseye.app.results.figures import Band, Figure, Ink, Line, Mark, Role
from catseye.app.results.resolution.figures.panels import (
    BEYOND,
    aspect_of,
    by_position,
    error_panel,
    in_rows,
    least_step_mark,
    measured_points,
)
from catseye.app.results.resolution.result import AnyTest, Direction

_INKS: dict[Direction | None, tuple[Ink, str]] = {
    1: (Role.POSITIVE, "positive direction"),
    -1: (Role.NEGATIVE, "negative direction"),
    None: (Role.COMMAND, "both directions"),
}
_CAPTION = (
    "Step error over the commanded step. Points: single steps; lines: mean of 11 neighbours; bands: ± one standard "
    f"deviation about it; dashed: threshold; upright: least increment step. {BEYOND}"
)


def step_error_figure(joint: str, tests: Sequence[AnyTest]) -> Figure | None:
    """Return the step errors of one joint, a panel a position, or of one Cartesian axis, a panel a pose.

    Args:
        joint: name of the joint or axis.
        tests: of this joint; those without step errors are passed over.
    """
    shown = [test for test in tests if test.joint == joint and test.test in {"decaying", "cartesian"}]
    panels = [
        error_panel(name, members[0].unit, members, [mark for test in members for mark in _marks(test)])
        for name, members in _by_place(joint, shown)
    ]
    if not panels:
        return None
    rows = in_rows(panels)
    return Figure(
        f"errors-{joint}", f"Step errors of {joint}", f"{joint}. {_CAPTION}", rows, aspect=aspect_of(rows)
    )


def _by_place(joint: str, tests: Sequence[AnyTest]) -> list[tuple[str, list[AnyTest]]]:
    if tests and tests[0].test == "cartesian":
        poses = dict.fromkeys(test.pose or "" for test in tests)
        return [(pose, [test for test in tests if (test.pose or "") == pose]) for pose in poses]
    return by_position(joint, tests)


def _marks(test: AnyTest) -> list[Mark]:
    ink, label = _INKS[test.direction]
    marks: list[Mark] = [measured_points(test, ink)]
    smooth = [move for move in test.moves if move.judged and move.mean_percent is not None]
    if smooth:
        x = np.log10([abs(move.command) for move in smooth])
        mean = np.array([move.mean_percent for move in smooth], dtype=np.float64)
        std = np.array([move.std_percent or 0.0 for move in smooth])
        marks += [Band(x, mean - std, mean + std, ink), Line(x, mean, ink, label, width=1.6)]
    if test.lis is not None and test.lis.value > 0.0:
        marks.append(least_step_mark(test.lis.value, ink))
    return marks
