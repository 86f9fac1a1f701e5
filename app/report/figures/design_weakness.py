"""Where the map is weak: uncertainty of its nodes, and of positions over the workspace."""

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

from catseye.app.analysis.design_layouts import Layout
from catseye.app.analysis.design_problem import workspace
from catseye.app.analysis.designing import Design, node_uncertainties, position_covariances
from catseye.app.report.figures.canvas import NEGATIVE, POSITIVE, STYLE, WIDTH_IN
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.points import Commands

_PARTS = 4
"""Grid steps from node to node."""

_ELLIPSE_MM = 70.0
"""Half axis of the largest ellipse drawn."""


@rc_context(STYLE)
def node_figure(found: Design) -> Figure:
    """Draw the standard uncertainties of both maps at their nodes, designed and first known layout."""
    figure = Figure(figsize=(WIDTH_IN, 3.4))
    row = figure.subplots(1, 2, sharey=True)
    for joint, axes in enumerate(row, 1):
        for layout, width, size in ((found.layout, 1.4, 4.5), (found.known[0], 0.7, 0.0)):
            for direction, colour, marker in ((1, POSITIVE, "^"), (-1, NEGATIVE, "v")):
                own = [
                    one
                    for one in node_uncertainties(layout)
                    if one.joint == joint and one.direction == direction
                ]
                axes.plot(
                    [one.node_deg for one in own],
                    [one.u_mdeg for one in own],
                    color=colour,
                    linewidth=width,
                    linestyle="-" if size else "--",
                    marker=marker,
                    markersize=size,
                    label=f"{layout.name}, {'+' if direction > 0 else '−'}",
                )
        axes.set_title(f"{'ab'[joint - 1]}) J{joint}")
        axes.set_xlabel(f"command θ{joint} / °")
    row[0].set_ylim(bottom=0.0)
    row[0].set_ylabel("u(Δθ) / mdeg")
    figure.legend(*row[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


@rc_context(STYLE)
def position_figure(found: Design) -> Figure:
    """Draw the standard uncertainty of predicted positions in its worst direction, with ellipses at the nodes."""
    layouts = (found.layout, found.known[0])
    maps = [_largest_um(layout) for layout in layouts]
    figure = Figure(figsize=(WIDTH_IN, 4.6))
    row = figure.subplots(1, 2, sharey=True)
    top = max(float(worst.max()) for _, worst in maps)
    for letter, axes, layout, (xy, worst) in zip("ab", row, layouts, maps, strict=True):
        axes.set_aspect("equal")
        shown = axes.pcolormesh(
            xy[..., 0],
            xy[..., 1],
            worst,
            shading="gouraud",
            cmap="magma_r",
            vmin=0.0,
            vmax=1.4 * top,
            rasterized=True,
        )
        _ellipses(axes, layout, top)
        axes.set_title(f"{letter}) {layout.name}")
        axes.set_xlabel("X / mm")
    row[0].set_ylabel("Y / mm")
    figure.colorbar(shown, ax=row, shrink=0.75, label="u in the worst direction / µm")
    return figure


def _largest_um(layout: Layout) -> tuple[Floats, Floats]:
    """Return positions, mm, shape (a, b, 2), and the largest u over directions of approach, µm, shape (a, b)."""
    problem = layout.problem
    grid = workspace(problem.bench, _PARTS)
    covariance = position_covariances(layout, grid, systematic=problem.systematic)
    u = 1e3 * np.sqrt(np.linalg.eigvalsh(covariance)[:, -1])
    shape = (
        (len(problem.bench.nodes1_deg) - 1) * _PARTS + 1,
        (len(problem.bench.nodes2_deg) - 1) * _PARTS + 1,
    )
    study = problem.study
    xy = forward(grid.theta1_rad, grid.theta2_rad, study.link1_mm, study.link2_mm)
    return xy.reshape(*shape, 4, 2)[:, :, 0], u.reshape(*shape, 4).max(axis=2)


def _ellipses(axes: Axes, layout: Layout, top_um: float) -> None:
    """Draw ellipses of k = 1, all magnified alike, approached upwards by both joints."""
    study, bench = layout.problem.study, layout.problem.bench
    one, two = (
        grid.ravel()
        for grid in np.meshgrid(np.deg2rad(bench.nodes1_deg), np.deg2rad(bench.nodes2_deg), indexing="ij")
    )
    upwards = np.ones(one.size, dtype=np.int64)
    commands = Commands(one, two, upwards, upwards)
    covariance = position_covariances(layout, commands, systematic=layout.problem.systematic)
    values, vectors = np.linalg.eigh(covariance)
    half = 1e3 * np.sqrt(np.maximum(values, 0.0)) * _ELLIPSE_MM / top_um
    for xy, axis, side in zip(
        forward(one, two, study.link1_mm, study.link2_mm), half, vectors[:, :, 1], strict=True
    ):
        axes.add_patch(
            Ellipse(
                (float(xy[0]), float(xy[1])),
                2.0 * float(axis[1]),
                2.0 * float(axis[0]),
                angle=float(np.rad2deg(np.arctan2(side[1], side[0]))),
                fill=False,
                edgecolor="#0a3d91",
                linewidth=0.8,
            )
        )
