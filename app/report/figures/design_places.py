"""The floor from above: what each place would bring, where none is allowed, where the reflectors stand."""

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Wedge

from catseye.app.analysis.designing import Design, exchanged_values
from catseye.app.report.figures.canvas import MUTED, STYLE, WIDTH_IN
from catseye.app.report.numbers import counted
from catseye.calibration.core.types import Floats

_MARKERS = {
    "inside the keep-out radius": ".",
    "in the arm's way": "+",
    "seen from too few commands": "x",
    "J4 winds up": "1",
    "beam breaks too often": "_",
}

_CHOSEN = "#c62828"
_FIELD_MM = 150.0


@rc_context(STYLE)
def places_figure(found: Design) -> Figure:
    """Draw candidates coloured by the criterion, excluded places by reason, and the layouts."""
    figure = Figure(figsize=(WIDTH_IN, 5.9))
    axes = figure.subplots()
    axes.set_aspect("equal")
    _arm(axes, found)
    _excluded(axes, found)
    _allowed(figure, axes, found)
    for layout, marker in zip(found.known, "sD", strict=False):
        axes.plot(
            *layout.places_mm.T,
            marker,
            markersize=8.0,
            markerfacecolor="none",
            markeredgecolor="black",
            label=layout.name,
        )
    _chosen(axes, found)
    axes.set_xlabel("X / mm")
    axes.set_ylabel("Y / mm")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _arm(axes: Axes, found: Design) -> None:
    rules, study = found.problem.rules, found.problem.study
    axes.add_patch(Circle((0.0, 0.0), rules.column_radius_mm, facecolor="#d7dbe0", edgecolor=MUTED))
    axes.add_patch(
        Circle((0.0, 0.0), study.reach_mm, fill=False, linestyle=(0, (5, 4)), color=MUTED, label="reach")
    )
    way = found.problem.way
    axes.plot(*way.xy_mm[way.command].T, ".", color="#3c4148", markersize=1.5, label="commands")


def _excluded(axes: Axes, found: Design) -> None:
    for reason, count in found.places.reasons.items():
        places = np.array([sight.xy_mm for sight in found.places.excluded if sight.reason == reason])
        axes.plot(
            *places.T,
            _MARKERS[reason],
            color=MUTED,
            markersize=4.0,
            linestyle="none",
            label=f"{reason}: {counted(count, 'place')}",
        )


def _allowed(figure: Figure, axes: Axes, found: Design) -> None:
    least, values = exchanged_values(found)
    known = np.isfinite(values)
    xy = np.array([sight.xy_mm for sight in found.places.allowed])[known]
    if not len(xy):
        return
    # A few bad places would take all the colours.
    low, high = float(values[known].min()), float(np.quantile(values[known], 0.9))
    shown = axes.scatter(
        xy[:, 0], xy[:, 1], c=values[known], s=26, cmap="viridis", vmin=low, vmax=max(high, low * 1.001)
    )
    criterion = found.problem.criterion
    bar = figure.colorbar(shown, ax=axes, shrink=0.8, extend="max")
    bar.set_label(f"criterion {criterion.name} with P{least + 1} there / {criterion.unit}")


def _chosen(axes: Axes, found: Design) -> None:
    half = float(np.rad2deg(found.problem.rules.field_half_angle_rad))
    for number, sight in enumerate(found.layout.sights, 1):
        facing = float(np.rad2deg(sight.facing_rad))
        where = (float(sight.xy_mm[0]), float(sight.xy_mm[1]))
        axes.add_patch(Wedge(where, _FIELD_MM, facing - half, facing + half, facecolor=_CHOSEN, alpha=0.15))
        axes.plot(
            *_line(sight.xy_mm, facing).T, color=_CHOSEN, linewidth=1.0, label="facing" if number == 1 else ""
        )
        axes.plot(
            *where,
            "o",
            color=_CHOSEN,
            markersize=8.0,
            label="designed, with its field" if number == 1 else "",
        )
        axes.annotate(
            f"P{number}",
            where,
            xytext=(7, 5),
            textcoords="offset points",
            color=_CHOSEN,
            fontweight="bold",
        )


def _line(xy_mm: Floats, facing_deg: float) -> Floats:
    turned = np.deg2rad(facing_deg)
    return np.array([xy_mm, xy_mm + _FIELD_MM * np.array([np.cos(turned), np.sin(turned)])])
