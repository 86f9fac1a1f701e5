"""Where the map is weak: uncertainty of its nodes, and of positions over the workspace."""

import numpy as np

from catseye.app.results.figures import Axis, Figure, Heat, Line, Mark, Panel, Points, Role, Shape
from catseye.app.results.numbers import EXPANDED
from catseye.app.results.scara.design.design import Design, node_uncertainties, position_covariances
from catseye.app.results.scara.design.layouts import Layout
from catseye.app.results.scara.design.problem import workspace
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.points import Commands

_PARTS = 4
"""Grid steps from node to node."""

_ELLIPSE_MM = 70.0
"""Half axis of the largest ellipse drawn."""


def node_figure(design: Design) -> Figure:
    """Return the expanded uncertainties of both maps at their nodes, of the designed and the first known layout."""
    return Figure(
        "nodes",
        "Uncertainty of the nodes of both maps",
        "Expanded uncertainty U of each value of the maps (k = 2), in the gauge that the J1 map has zero mean.",
        (tuple(_nodes(design, joint) for joint in (1, 2)),),
        aspect=0.43,
        legend_columns=2,
    )


def _nodes(design: Design, joint: int) -> Panel:
    marks: list[Mark] = []
    for layout, designed in ((design.layout, True), (design.known[0], False)):
        for direction, ink in ((1, Role.POSITIVE), (-1, Role.NEGATIVE)):
            own = [
                one for one in node_uncertainties(layout) if one.joint == joint and one.direction == direction
            ]
            node, expanded = (
                np.array([one.node_deg for one in own]),
                EXPANDED * np.array([one.u_mdeg for one in own]),
            )
            label = f"{layout.name}, {'+' if direction > 0 else '−'}"
            line = Line(node, expanded, ink, label, "dashed", 0.7)
            marks.append(Points(node, expanded, ink, label, joined=True) if designed else line)
    upwards = Axis("U(Δθ) / mdeg", low=0.0) if joint == 1 else Axis(shared=True)
    return Panel(f"{'ab'[joint - 1]}) J{joint}", Axis(f"command θ{joint} / °"), upwards, tuple(marks))


def position_figure(design: Design) -> Figure:
    """Return the expanded uncertainty of predicted positions in its worst direction, with ellipses at the nodes."""
    layouts = (design.layout, design.known[0])
    maps = [_largest_um(layout) for layout in layouts]
    top = max(float(worst.max()) for _, worst in maps)
    return Figure(
        "positions",
        "Uncertainty of predicted positions over the workspace",
        "Expanded uncertainty U of predicted positions in the worst direction (k = 2), for the worst directions of "
        "approach. Ellipses: k = 2 at the nodes approached upwards, magnified alike in both pictures.",
        (
            tuple(
                _positions(letter, layout, xy, worst, top)
                for letter, layout, (xy, worst) in zip("ab", layouts, maps, strict=True)
            ),
        ),
        aspect=0.575,
    )


def _positions(letter: str, layout: Layout, xy: Floats, worst: Floats, top: float) -> Panel:
    heat = Heat(xy[..., 0], xy[..., 1], worst, "U in the worst direction / µm", 1.4 * top)
    upwards = Axis("Y / mm") if letter == "a" else Axis(shared=True)
    marks = (heat, *_ellipses(layout, top))
    return Panel(f"{letter}) {layout.name}", Axis("X / mm"), upwards, marks, equal=True)


def _largest_um(layout: Layout) -> tuple[Floats, Floats]:
    """Return positions, mm, shape (a, b, 2), and the largest U over directions of approach, µm, shape (a, b)."""
    problem = layout.problem
    grid = workspace(problem.bench, _PARTS)
    covariance = position_covariances(layout, grid, systematic=problem.systematic)
    expanded = 1e3 * EXPANDED * np.sqrt(np.linalg.eigvalsh(covariance)[:, -1])
    shape = (
        (len(problem.bench.nodes1_deg) - 1) * _PARTS + 1,
        (len(problem.bench.nodes2_deg) - 1) * _PARTS + 1,
    )
    study = problem.study
    xy = forward(grid.theta1_rad, grid.theta2_rad, study.link1_mm, study.link2_mm)
    return xy.reshape(*shape, 4, 2)[:, :, 0], expanded.reshape(*shape, 4).max(axis=2)


def _ellipses(layout: Layout, top_um: float) -> list[Mark]:
    """Return ellipses of k = 2, all magnified alike, approached upwards by both joints."""
    study, bench = layout.problem.study, layout.problem.bench
    one, two = (
        grid.ravel()
        for grid in np.meshgrid(np.deg2rad(bench.nodes1_deg), np.deg2rad(bench.nodes2_deg), indexing="ij")
    )
    upwards = np.ones(one.size, dtype=np.int64)
    commands = Commands(one, two, upwards, upwards)
    covariance = position_covariances(layout, commands, systematic=layout.problem.systematic)
    values, vectors = np.linalg.eigh(covariance)
    half = 1e3 * EXPANDED * np.sqrt(np.maximum(values, 0.0)) * _ELLIPSE_MM / top_um
    places = forward(one, two, study.link1_mm, study.link2_mm)
    return [
        Shape(
            (float(xy[0]), float(xy[1])),
            (float(axis[1]), float(axis[0])),
            Role.REGION,
            turn_deg=float(np.rad2deg(np.arctan2(side[1], side[0]))),
        )
        for xy, axis, side in zip(places, half, vectors[:, :, 1], strict=True)
    ]
