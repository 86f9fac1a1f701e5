"""Figures of a diagnosis: residuals in measuring order, against the joints, and the harmonics that are left."""

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from catseye.app.analysis.diagnosis_words import ANGLES, VARYING, outlier_limit
from catseye.app.report.figures.canvas import MUTED, NEGATIVE, POSITIVE, STYLE, WIDTH_IN, series
from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis
from catseye.calibration.scara.diagnostics.harmonics import HarmonicSeries
from catseye.calibration.scara.diagnostics.joint_angles import AnglePattern


@rc_context(STYLE)
def order_figure(diagnosis: Diagnosis) -> Figure:
    """Draw studentised residuals in measuring order, with the limit for a single one and what changed."""
    figure = Figure(figsize=(WIDTH_IN, 3.4))
    axes = figure.subplots()
    points, external = diagnosis.identified.points, diagnosis.residuals.external
    row, limit = np.arange(1, external.size + 1), outlier_limit(diagnosis)
    for index, name in enumerate(points.reflector_names):
        colour, marker = series(index)
        own = points.reflector == index
        axes.plot(
            row[own],
            external[own],
            marker,
            color=colour,
            markersize=2.4,
            alpha=0.7,
            label=f"reflector {name}",
        )
    starts = 1 + np.flatnonzero(np.diff(points.dead_path) != 0)
    for start in starts:
        axes.axvline(start + 0.5, color=MUTED, linewidth=0.6, linestyle=":")
    for sign in (-1.0, 1.0):
        axes.axhline(sign * limit, color=POSITIVE, linewidth=0.8, linestyle="--")
    for one in diagnosis.changes:
        if one.significant and one.kind == "jump":
            axes.axvline(one.row - 0.5, color=POSITIVE, linewidth=1.4)
    axes.set_xlabel("distance in measuring order")
    axes.set_ylabel("studentised residual")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=6)
    return figure


@rc_context(STYLE)
def pattern_figure(diagnosis: Diagnosis) -> Figure:
    """Draw mean residuals against the angles of J1, J2 and the beam."""
    figure = Figure(figsize=(WIDTH_IN, 2.6))
    panels = figure.subplots(1, len(diagnosis.patterns), sharey=True, squeeze=False)[0]
    sigma_um = diagnosis.identified.fit.sigma0_um
    for letter, axes, one in zip("abc", panels, diagnosis.patterns, strict=True):
        _pattern(axes, one, sigma_um)
        axes.set_title(f"{letter}) against θ{one.joint}")
        axes.set_xlabel(f"θ{one.joint} / °")
    panels[0].set_ylabel("mean residual / µm")
    return figure


def _pattern(axes: Axes, one: AnglePattern, sigma_um: float) -> None:
    order = np.argsort(one.angle_deg)
    angle, mean = one.angle_deg[order], one.mean_um[order]
    scatter = 2.0 * sigma_um / np.sqrt(one.count[order])
    axes.fill_between(angle, -scatter, scatter, color="#e3e6ea", linewidth=0.0)
    axes.axhline(0.0, color="#5f6670", linewidth=0.6)
    axes.plot(angle, mean, "o-", color=NEGATIVE, markersize=3.2)


@rc_context(STYLE)
def harmonic_figure(diagnosis: Diagnosis) -> Figure:
    """Draw what each order would explain; series that the maps absorb are left out."""
    shown = [one for one in diagnosis.harmonics if one.harmonics]
    figure = Figure(figsize=(WIDTH_IN, 1.0 + 1.5 * max(len(shown), 1)))
    panels = figure.subplots(max(len(shown), 1), 1, squeeze=False)[:, 0]
    for letter, axes, one in zip("abcde", panels, shown, strict=False):
        _spectrum(axes, one)
        axes.set_title(f"{letter}) {VARYING[one.target]} against {ANGLES[one.source]}")
        axes.set_ylabel("µm")
    panels[-1].set_xlabel("order (periods in a turn)")
    return figure


def _spectrum(axes: Axes, one: HarmonicSeries) -> None:
    order = np.array([harmonic.order for harmonic in one.harmonics])
    explained = np.array([harmonic.explained_um for harmonic in one.harmonics])
    flags = np.array([harmonic.significant for harmonic in one.harmonics])
    axes.vlines(order, 0.0, explained, color=MUTED, linewidth=1.0)
    for rows, colour, marker, label in (
        (~flags, MUTED, "o", "chance"),
        (flags, POSITIVE, "D", "clearer than chance"),
    ):
        if rows.any():
            axes.plot(order[rows], explained[rows], marker, color=colour, markersize=3.0, label=label)
    axes.set_ylim(bottom=0.0)
    axes.set_xlim(0.0, float(order.max()) + 1.0)
    if flags.any():
        axes.legend(loc="upper right")
