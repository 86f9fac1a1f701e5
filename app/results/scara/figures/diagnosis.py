"""Figures of a diagnosis: residuals in measuring order, against the joints, and the harmonics that are left."""

import numpy as np

from catseye.app.results.figures import (
    Axis,
    Band,
    Figure,
    Level,
    Mark,
    Panel,
    Points,
    Role,
    Stems,
    Text,
)
from catseye.app.results.residual_sign import measured_minus_predicted
from catseye.app.results.scara.diagnosis import outlying
from catseye.app.results.scara.names import ANGLES, VARYING
from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis
from catseye.calibration.scara.diagnostics.harmonics import HarmonicSeries
from catseye.calibration.scara.diagnostics.joint_angles import AnglePattern

_NUMBERED = 9
"""Outliers that are numbered."""


def diagnosis_figures(diagnosis: Diagnosis) -> list[Figure]:
    """Return all figures; without harmonics that the maps leave there is none of them."""
    figures = [order_figure(diagnosis), pattern_figure(diagnosis)]
    shown = [harmonic for harmonic in diagnosis.harmonics if harmonic.harmonics]
    return [*figures, harmonic_figure(shown)] if shown else figures


def order_figure(diagnosis: Diagnosis) -> Figure:
    """Return studentised residuals in measuring order, with the limit for a single one and what changed."""
    points = diagnosis.identified.points
    external = measured_minus_predicted(diagnosis.residuals.external)
    row, limit = np.arange(1, external.size + 1, dtype=np.float64), diagnosis.outlier_limit
    marks: list[Mark] = []
    for place, name in enumerate(points.reflector_names):
        own = points.reflector == place
        marks.append(Points(row[own], external[own], place, f"reflector {name}", size=2.4, faint=True))
    for start in np.flatnonzero(np.diff(points.dead_path) != 0).tolist():
        marks.append(Level(start + 1.5, Role.MUTED, vertical=True, dash="dotted", width=0.6))
    marks += [Level(sign * limit, Role.CHANGE, dash="dashed") for sign in (-1.0, 1.0)]
    marks += [
        Level(change.row - 0.5, Role.CHANGE, vertical=True, width=1.4)
        for change in diagnosis.changes
        if change.significant and change.kind == "jump"
    ]
    marks += [
        Text(str(place), (float(row[at]), float(external[at])), Role.CHANGE)
        for place, at in enumerate(outlying(diagnosis)[:_NUMBERED], 1)
    ]
    return Figure(
        "diagnosis-order",
        "Studentised residuals in measuring order",
        "Externally studentised residuals (measured minus predicted). Dashed: beyond it a distance stands out; "
        "chance alone exceeds it in fewer than 1 % of measurements. Dotted: a new segment; solid: a jump. Numbers: "
        "outliers, the farthest first.",
        ((Panel("", Axis("distance in measuring order"), Axis("studentised residual"), tuple(marks)),),),
        aspect=0.43,
        legend_columns=6,
    )


def pattern_figure(diagnosis: Diagnosis) -> Figure:
    """Return mean residuals against the angles of J1, J2 and the beam."""
    sigma_um = diagnosis.identified.fit.sigma0_um
    panels = tuple(
        _pattern(letter, pattern, sigma_um) for letter, pattern in zip("abc", diagnosis.patterns, strict=True)
    )
    return Figure(
        "diagnosis-angles",
        "Mean residuals against the joints' angles",
        "Mean residuals (measured minus predicted), less what stated shared errors explain, against J1, "
        "J2 and the angle of the beam against link 2 (θ4). Band: twice the standard deviation that scatter alone "
        "gives them.",
        (panels,),
        aspect=0.33,
    )


def _pattern(letter: str, pattern: AnglePattern, sigma_um: float) -> Panel:
    order = np.argsort(pattern.angle_deg)
    angle, mean = pattern.angle_deg[order], measured_minus_predicted(pattern.mean_um[order])
    scatter = 2.0 * sigma_um / np.sqrt(pattern.count[order])
    marks = (
        Band(angle, -scatter, scatter, Role.MUTED),
        Level(0.0, Role.AXIS, width=0.6),
        Points(angle, mean, Role.NEGATIVE, marker="o", size=3.2, joined=True),
    )
    upwards = Axis("mean residual / µm") if letter == "a" else Axis(shared=True)
    return Panel(f"{letter}) against θ{pattern.joint}", Axis(f"θ{pattern.joint} / °"), upwards, marks)


def harmonic_figure(shown: list[HarmonicSeries]) -> Figure:
    """Return what each order would explain; series that the maps absorb are left out."""
    rows = tuple(
        (_spectrum(letter, one, last=one is shown[-1]),) for letter, one in zip("abcde", shown, strict=False)
    )
    return Figure(
        "diagnosis-harmonics",
        "Harmonics that the fit leaves",
        "Standard deviation of a distance that each order would explain beyond the error map. Orders that the maps "
        "take up at these commands are not shown; of orders that are one at these commands the lowest is.",
        rows,
        aspect=0.125 + 0.19 * len(shown),
    )


def _spectrum(letter: str, series: HarmonicSeries, *, last: bool) -> Panel:
    order = np.array([harmonic.order for harmonic in series.harmonics], dtype=np.float64)
    explained = np.array([harmonic.explained_um for harmonic in series.harmonics])
    flags = np.array([harmonic.significant for harmonic in series.harmonics])
    marks: list[Mark] = [Stems(order, explained, Role.MUTED)]
    marks += [
        Points(order[rows], explained[rows], ink, label if flags.any() else "", size=3.0)
        for rows, ink, label in (
            (~flags, Role.MUTED, "chance"),
            (flags, Role.CHANGE, "clearer than chance"),
        )
        if rows.any()
    ]
    return Panel(
        f"{letter}) {VARYING[series.target]} against {ANGLES[series.source]}",
        Axis("order (periods in a turn)" if last else "", low=0.0, high=float(order.max()) + 1.0),
        Axis("µm", low=0.0),
        tuple(marks),
    )
