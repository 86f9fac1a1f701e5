"""Error maps while they are being measured: as far as they are determined, and how well they are known."""

import numpy as np

from catseye.app.results.figures import Axis, Figure, Level, Mark, Panel, Points, Role
from catseye.app.results.numbers import EXPANDED
from catseye.app.results.scara.commands_so_far import MeasurementSoFar
from catseye.calibration.core.types import Bools, Floats

_SHOWN_MDEG = 100.0
"""A node that is known worse would flatten all others."""


def growing_map_figure(so_far: MeasurementSoFar) -> Figure | None:
    """Return the maps with their error bars, and below their largest uncertainty with its target.

    Returns:
        None before anything is determined.
    """
    maps, bench = so_far.maps, so_far.bench
    first = _map(1, bench.nodes1_deg, maps.map1_rad, maps.u1_rad)
    second = _map(2, bench.nodes2_deg, maps.map2_rad, maps.u2_rad)
    if first is None and second is None:
        return None
    caption = (
        "Angular positioning deviations from the distances so far; error bars: U (k = 2). Their mean over the "
        "measured nodes of J1 is zero. Below: the largest U of each map."
    )
    rows = ((first or _empty(1), second or _empty(2)), (_known(so_far),))
    return Figure("maps-so-far", "Error maps so far", caption, rows, heights=(2.0, 1.3), aspect=0.7)


def _map(joint: int, nodes_deg: tuple[float, ...], values_rad: Floats, u_rad: Floats) -> Panel | None:
    values, u = 1e3 * np.rad2deg(values_rad), 1e3 * np.rad2deg(u_rad)
    shown = u <= _SHOWN_MDEG
    if not shown.any():
        return None
    node = np.array(nodes_deg)
    looks = ((0, Role.POSITIVE, "approached upwards"), (1, Role.NEGATIVE, "approached downwards"))
    marks: list[Mark] = [Level(0.0, Role.AXIS, width=0.6)]
    for way, ink, label in looks:
        own = shown[way]
        if own.any():
            marks.append(Points(node[own], values[way, own], ink, label, u[way, own], joined=True))
    axis = _axis(joint, nodes_deg)
    return Panel(f"J{joint}: {_count(shown)}", axis, Axis(f"Δθ{joint} / mdeg"), tuple(marks))


def _empty(joint: int) -> Panel:
    return Panel(f"J{joint}: no node yet", Axis(f"command θ{joint} / °"), Axis(f"Δθ{joint} / mdeg"), ())


def _axis(joint: int, nodes_deg: tuple[float, ...]) -> Axis:
    """Return the axis of all nodes, so that what is missing is seen."""
    edge = 0.04 * (nodes_deg[-1] - nodes_deg[0])
    return Axis(f"command θ{joint} / °", low=nodes_deg[0] - edge, high=nodes_deg[-1] + edge)


def _count(shown: Bools) -> str:
    return f"{int(shown.sum())} of {shown.size} values"


def _known(so_far: MeasurementSoFar) -> Panel:
    """Return how the largest uncertainties have shrunk, and what they are to become."""
    known, marks = so_far.known, list[Mark]()
    for joint in (0, 1):
        expanded_mdeg = EXPANDED * known.u_mdeg[:, joint]
        there = expanded_mdeg > 0.0
        if there.any():
            label = f"J{joint + 1}, now {expanded_mdeg[there][-1]:.1f} mdeg"
            marks.append(
                Points(
                    known.distances[there],
                    np.log10(expanded_mdeg[there]),
                    joint,
                    label,
                    size=3.5,
                    joined=True,
                )
            )
    if so_far.stop_at_mdeg:
        stop_mdeg = EXPANDED * so_far.stop_at_mdeg
        text = f"stop at u {so_far.stop_at_mdeg:g} mdeg = U {stop_mdeg:g} mdeg"
        marks.append(Level(float(np.log10(stop_mdeg)), Role.EXPECTED, dash="dashed", label=text))
    else:
        marks += [
            Level(
                float(np.log10(EXPANDED * u_mdeg)),
                joint,
                dash="dashed",
                label=f"J{joint + 1}, whole plan {EXPANDED * u_mdeg:.1f} mdeg",
            )
            for joint, u_mdeg in enumerate(so_far.foreseen_mdeg)
            if u_mdeg is not None
        ]
    planned = sum(int((~part.are("hidden")).sum()) for part in so_far.parts)
    across = Axis("distances measured", low=0.0, high=float(planned))
    return Panel("", across, Axis("largest U / mdeg", decades=True), tuple(marks))
