"""Step errors over the commanded step, with moving mean, band, threshold and least step (Fig. 7 of the paper)."""

from collections.abc import Sequence

import numpy as np

from catseye.app.results.figures import Axis, Band, Figure, Ink, Level, Line, Mark, Panel, Points, Role
from catseye.app.results.resolution.naming import UNIT_SIGNS, named_positions
from catseye.app.results.resolution.result import AnyTest, Direction

_ACROSS = 3
_INKS: dict[Direction | None, tuple[Ink, str]] = {
    1: (Role.POSITIVE, "positive direction"),
    -1: (Role.NEGATIVE, "negative direction"),
    None: (Role.COMMAND, "both directions"),
}
_SHOWN_PERCENT = 60.0
_CAPTION = (
    "Step error over the commanded step. Points: single steps; lines: mean of 11 neighbours; bands: ± one standard "
    "deviation about it; dashed: threshold; upright: least increment step."
)


def step_error_figure(joint: str, tests: Sequence[AnyTest]) -> Figure | None:
    """Return the step errors of one joint, a panel a position, or of one Cartesian axis, a panel a pose.

    Args:
        joint: name of the joint or axis.
        tests: of this joint; those without step errors are passed over.
    """
    shown = [test for test in tests if test.joint == joint and test.test in {"decaying", "cartesian"}]
    panels = [_panel(name, members) for name, members in _by_place(joint, shown)]
    if not panels:
        return None
    across = min(_ACROSS, len(panels))
    places: list[Panel | None] = [*panels, *[None] * (-len(panels) % across)]
    rows = tuple(tuple(places[first : first + across]) for first in range(0, len(places), across))
    return Figure(
        f"errors-{joint}",
        f"Step errors of {joint}",
        f"{joint}. {_CAPTION}",
        rows,
        aspect=0.1 + 0.38 * len(rows),
    )


def _by_place(joint: str, tests: Sequence[AnyTest]) -> list[tuple[str, list[AnyTest]]]:
    if tests and tests[0].test == "cartesian":
        poses = dict.fromkeys(test.pose or "" for test in tests)
        return [(pose, [test for test in tests if (test.pose or "") == pose]) for pose in poses]
    return [
        (name, [test for test in tests if test.position == position])
        for name, position in named_positions(tests, joint)
    ]


def _panel(name: str, tests: Sequence[AnyTest]) -> Panel:
    marks: list[Mark] = [Level(0.0, Role.AXIS, width=0.6)]
    for percent in sorted({test.threshold_percent for test in tests}):
        marks += [Level(sign * percent, Role.CHANGE, dash="dashed") for sign in (1.0, -1.0)]
    for test in tests:
        marks += _marks(test)
    return Panel(
        name,
        Axis(f"commanded step / {UNIT_SIGNS[tests[0].unit]}", decades=True),
        Axis("step error / %", low=-_SHOWN_PERCENT, high=_SHOWN_PERCENT),
        tuple(marks),
    )


def _marks(test: AnyTest) -> list[Mark]:
    ink, label = _INKS[test.direction]
    judged = [move for move in test.moves if move.judged and move.error_percent is not None]
    step = np.log10([abs(move.command) for move in judged])
    error = np.array([move.error_percent for move in judged], dtype=np.float64)
    marks: list[Mark] = [Points(step, error, ink, size=2.5, faint=True)]
    smooth = [move for move in judged if move.mean_percent is not None]
    if smooth:
        x = np.log10([abs(move.command) for move in smooth])
        mean = np.array([move.mean_percent for move in smooth], dtype=np.float64)
        std = np.array([move.std_percent or 0.0 for move in smooth])
        marks += [Band(x, mean - std, mean + std, ink), Line(x, mean, ink, label, width=1.6)]
    if test.lis is not None and test.lis.value > 0.0:
        marks.append(Level(float(np.log10(test.lis.value)), ink, vertical=True, dash="dotted", width=1.2))
    return marks
