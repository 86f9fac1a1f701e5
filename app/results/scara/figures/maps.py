"""Error maps of both joints with their reversal error (Fig. 6 of the SCARA paper)."""

import numpy as np

from catseye.app.results.figures import Axis, Band, Figure, Level, Line, Mark, Panel, Points, Role
from catseye.app.results.scara.result import MapTable, Result
from catseye.app.results.scara.reversal import reversal_mdeg, u_reversal_mdeg
from catseye.app.results.scara.truth_tables import TruthMap, TruthTables


def map_figure(result: Result, truth: TruthTables | None = None) -> Figure | None:
    """Return the maps at their nodes with error bars, the truth as thin lines where it is known.

    Args:
        result: an error map; another model has no figure.
        truth: in the same gauge.
    """
    first, second = result.theta1_map, result.theta2_map
    if first is None or second is None:
        return None
    caption = (
        "Angular positioning deviation (actual minus command) of both joints. ▲: approached upwards, ▼: "
        "approached downwards; error bars: U (k = 2), which the bands join. Below: reversal error (ISO 230-2), "
        "▲ minus ▼."
    )
    if truth is not None:
        caption += " Lines without markers: truth of the emulated bench, thin for ▲, grey and dashed for ▼."
    joints = (
        (1, first, None if truth is None else truth.theta1_map),
        (2, second, None if truth is None else truth.theta2_map),
    )
    return Figure(
        "maps",
        "Error maps of J1 and J2",
        caption,
        (
            tuple(_map(joint, table, true) for joint, table, true in joints),
            tuple(
                _reversal(joint, table, true, u_reversal_mdeg(result, joint)) for joint, table, true in joints
            ),
        ),
        heights=(3.0, 1.3),
        aspect=0.65,
    )


def _map(joint: int, table: MapTable, truth: TruthMap | None) -> Panel:
    marks: list[Mark] = [Level(0.0, Role.AXIS, width=0.6)]
    if truth is not None:
        node = np.array(truth.node_deg)
        marks += [
            Line(node, np.array(truth.positive_mdeg), Role.TRUTH, "truth, positive", width=0.7),
            Line(node, np.array(truth.negative_mdeg), Role.MUTED, "truth, negative", "dashed", 1.2),
        ]
    node = np.array(table.node_deg)
    for values, us, ink, label in (
        (table.positive_mdeg, table.u_positive_mdeg, Role.POSITIVE, "approached upwards (+)"),
        (table.negative_mdeg, table.u_negative_mdeg, Role.NEGATIVE, "approached downwards (−)"),
    ):
        marks += _with_band(Points(node, np.array(values), ink, label, np.array(us), joined=True))
    return Panel(f"{'ab'[joint - 1]}) J{joint}", Axis(shared=True), Axis(f"Δθ{joint} / mdeg"), tuple(marks))


def _reversal(joint: int, table: MapTable, truth: TruthMap | None, u_mdeg: list[float] | None) -> Panel:
    marks: list[Mark] = [Level(0.0, Role.AXIS, width=0.6)]
    if truth is not None:
        difference = np.subtract(truth.positive_mdeg, truth.negative_mdeg)
        marks.append(Line(np.array(truth.node_deg), difference, Role.TRUTH, width=0.7))
    u = None if u_mdeg is None else np.array(u_mdeg)
    node, values = np.array(table.node_deg), np.array(reversal_mdeg(table))
    marks += _with_band(Points(node, values, Role.REVERSAL, u=u, size=3.5, joined=True))
    return Panel("", Axis(f"command θ{joint} / °"), Axis("reversal / mdeg"), tuple(marks))


def _with_band(points: Points) -> list[Mark]:
    """Return points with the band that joins their error bars, where they have some."""
    return [points] if points.u is None else [Band.around(points.x, points.y, points.u, points.ink), points]
