"""Joint models over the measured step errors that they were fitted to (Fig. 9 of the resolution paper)."""

from collections.abc import Sequence

import numpy as np

from catseye.app.results.figures import Band, Figure, Line, Mark, Panel, Role
from catseye.app.results.resolution.figures.panels import (
    BEYOND,
    aspect_of,
    by_position,
    error_panel,
    in_rows,
    measured_points,
)
from catseye.app.results.resolution.result import AnyTest, Direction
from catseye.calibration.resolution.tables import Curve, ResolutionTables

_INKS: dict[Direction, tuple[Role, str]] = {
    1: (Role.POSITIVE, "model, positive direction"),
    -1: (Role.NEGATIVE, "model, negative direction"),
}
_CAPTION = (
    "Model of the step error over the commanded step at the positions that were tested, one for each direction. "
    "Lines: expected error; bands: ± one standard deviation of a single step, its "
    f"expectation's uncertainty included; points: the steps measured there; dashed: threshold. {BEYOND}"
)


def joint_model_figure(joint: str, tables: ResolutionTables, tests: Sequence[AnyTest]) -> Figure | None:
    """Return the models of a joint with what was measured, a panel a position.

    Args:
        joint: its name.
        tables: of the arm.
        tests: of any joint; the positions are those of the decaying ones.
    """
    own = [test for test in tests if test.joint == joint and test.test == "decaying"]
    panels = [
        panel for name, members in by_position(joint, own) if (panel := _panel(name, joint, members, tables))
    ]
    if not panels:
        return None
    rows = in_rows(panels)
    label = f"Model of the step errors of {joint}"
    return Figure(f"model-{joint}", label, f"{joint}. {_CAPTION}", rows, aspect=aspect_of(rows))


def _panel(name: str, joint: str, tests: Sequence[AnyTest], tables: ResolutionTables) -> Panel | None:
    marks: list[Mark] = []
    for test in tests:
        table = None if test.direction is None else tables.of(joint, test.direction)
        curve = None if table is None or test.position is None else table.curve(test.position)
        if curve is not None and test.direction is not None:
            ink, label = _INKS[test.direction]
            marks += [measured_points(test, ink), *_model_marks(curve, ink, label)]
    return error_panel(name, tests[0].unit, tests, marks) if marks else None


def _model_marks(curve: Curve, ink: Role, label: str) -> tuple[Mark, Mark]:
    sizes = np.geomspace(curve.smallest, curve.largest, 100)
    errors, x = curve.at(sizes), np.log10(sizes)
    spread = np.hypot(errors.scatter_percent, errors.u_mean_percent)
    mean = errors.mean_percent
    return Band(x, mean - spread, mean + spread, ink), Line(x, mean, ink, label, width=1.6)
