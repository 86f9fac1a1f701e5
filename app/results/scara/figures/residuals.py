"""Residuals of the fit: against the joints, their distribution, and their means per pose."""

from collections.abc import Sequence
from statistics import NormalDist

import numpy as np

from catseye.app.results.figures import (
    Axis,
    Bars,
    Figure,
    Level,
    Line,
    Mark,
    Panel,
    Point,
    Points,
    Role,
    Text,
)
from catseye.app.results.numbers import EXPANDED
from catseye.app.results.residual_sign import measured_minus_predicted
from catseye.app.results.scara.residuals import PoseMeans, Reference, pose_means
from catseye.app.results.scara.result import Residuals
from catseye.calibration.core.types import Floats

_LETTERS = "abcdefghij"
"""Of the panels of poses, one a reflector; more reflectors have none."""


def residual_figure(residuals: Residuals, reference: Reference, model: str) -> Figure:
    """Return the residuals of a fit against the joints, and their distribution."""
    names = list(dict.fromkeys(residuals.reflector))
    value = measured_minus_predicted(np.array(residuals.residual_um))
    return Figure(
        "residuals",
        "Residuals of the fit",
        f"Residuals (measured minus predicted) of the {model}. a), b): dots are distances, larger markers are means "
        "per node and reflector.",
        (
            (
                _against("a", 1, residuals, residuals.theta1_deg, names),
                _against("b", 2, residuals, residuals.theta2_deg, names),
            ),
            (_histogram(value, reference), _quantiles(value, reference.sigma_um)),
        ),
        aspect=0.68,
        legend_columns=max(len(names), 1),
    )


def pose_figure(residuals: Residuals, reference: Reference, model: str) -> Figure:
    """Return the mean residuals of each pose, a panel for each reflector."""
    names = list(dict.fromkeys(residuals.reflector))
    means = [pose_means(residuals, name) for name in names]
    return Figure(
        "residual-poses",
        "Mean residuals by pose",
        f"Mean residuals (measured minus predicted) of the {model} over the repeats of each pose. A pattern that "
        "exceeds the scatter is what the model lacks.",
        (_poses(means, names),),
        aspect=0.4,
        note=_pose_note(means, reference.scatter_um),
    )


def residual_order_figure(residuals: Residuals) -> Figure:
    """Return the residuals of a fit in measuring order."""
    value = measured_minus_predicted(np.array(residuals.residual_um))
    row, reflector = np.arange(1, value.size + 1, dtype=np.float64), np.array(residuals.reflector)
    marks: list[Mark] = [Level(0.0, Role.AXIS, width=0.6)]
    marks += [
        Level(start + 1.5, Role.MUTED, vertical=True, dash="dotted", width=0.6)
        for start in np.flatnonzero(reflector[1:] != reflector[:-1]).tolist()
    ]
    for place, name in enumerate(dict.fromkeys(residuals.reflector)):
        own = reflector == name
        marks.append(Points(row[own], value[own], place, f"reflector {name}", size=2.4, faint=True))
    return Figure(
        "residual-order",
        "Residuals in measuring order",
        "Residuals (measured minus predicted) in measuring order. Dotted: another reflector.",
        ((Panel("", Axis("distance in measuring order"), Axis("residual / µm"), tuple(marks)),),),
        aspect=0.36,
        legend_columns=6,
    )


def _against(
    letter: str, joint: int, residuals: Residuals, theta: Sequence[float], names: Sequence[str]
) -> Panel:
    theta_deg, value = np.array(theta), measured_minus_predicted(np.array(residuals.residual_um))
    nodes = np.unique(theta_deg)
    step = float(np.min(np.diff(nodes))) if nodes.size > 1 else 1.0
    marks: list[Mark] = [Level(0.0, Role.AXIS, width=0.6)]
    for place, name in enumerate(names):
        rows = np.array([one == name for one in residuals.reflector])
        shift = 0.16 * step * (place - 0.5 * (len(names) - 1))
        marks.append(Points(theta_deg[rows] + shift, value[rows], place, marker=".", size=2.0, faint=True))
        own = np.unique(theta_deg[rows])
        means = np.array([float(value[rows & (theta_deg == node)].mean()) for node in own])
        marks.append(Points(own + shift, means, place, f"reflector {name}", joined=True))
    upwards = Axis("residual / µm") if letter == "a" else Axis(shared=True)
    return Panel(
        f"{letter}) against θ{joint}, with means", Axis(f"command θ{joint} / °"), upwards, tuple(marks)
    )


_THINNEST_UM = 1e-6
"""Of a normal distribution that is drawn; no interferometer resolves as much."""


def _histogram(value: Floats, reference: Reference) -> Panel:
    sigma_um, origin = reference.sigma_um, "stated" if reference.stated else "from the fit"
    bins = int(np.clip(np.sqrt(value.size), 8, 40))
    edges = np.linspace(value.min(), value.max(), bins + 1) if np.ptp(value) > 0.0 else np.array([-1.0, 1.0])
    counts = np.histogram(value, edges)[0].astype(np.float64)
    marks: list[Mark] = [Bars(edges, counts, Role.SCATTER)]
    if sigma_um > _THINNEST_UM:
        x = np.linspace(-4.0 * sigma_um, 4.0 * sigma_um, 161)
        height = value.size * (edges[1] - edges[0]) / (sigma_um * np.sqrt(2.0 * np.pi))
        marks.append(Line(x, height * np.exp(-0.5 * (x / sigma_um) ** 2), Role.TRUTH, width=1.0))
    marks.append(Text(f"line: normal,\nσ = {sigma_um:.1f} µm\n({origin})"))
    return Panel("c) distribution", Axis("residual / µm"), Axis("number of distances"), tuple(marks))


def _quantiles(value: Floats, sigma_um: float) -> Panel:
    normal = NormalDist()
    shares = (np.arange(value.size) + 0.5) / value.size
    expected = sigma_um * np.array([normal.inv_cdf(float(share)) for share in shares])
    marks = (
        Points(expected, np.sort(value), Role.QUANTILE, size=2.5),
        Line(expected[[0, -1]], expected[[0, -1]], Role.TRUTH, width=0.9),
    )
    return Panel(
        "d) normal quantiles", Axis("expected of a normal distribution / µm"), Axis("residual / µm"), marks
    )


def _poses(means: Sequence[PoseMeans], names: Sequence[str]) -> tuple[Panel, ...]:
    unit = max(float(np.abs(mean.mean_um).max()) for mean in means) or 1.0
    theta1, theta2 = (
        _ends(np.concatenate(columns))
        for columns in ([mean.theta1_deg for mean in means], [mean.theta2_deg for mean in means])
    )
    return tuple(
        Panel(
            f"{letter}) poses, {name}",
            Axis("command θ1 / °", low=theta1[0], high=theta1[1]),
            Axis("" if place else "command θ2 / °", low=theta2[0], high=theta2[1], shared=bool(place)),
            tuple(
                Points(
                    one.theta1_deg[rows],
                    one.theta2_deg[rows],
                    ink,
                    area=60.0 * np.abs(one.mean_um[rows]) / unit,
                )
                for rows, ink in ((one.mean_um > 0.0, Role.ABOVE), (one.mean_um <= 0.0, Role.BELOW))
            ),
        )
        for place, (letter, one, name) in enumerate(zip(_LETTERS, means, names, strict=False))
    )


def _ends(values: Floats) -> Point:
    """Return both ends with a margin."""
    margin = 0.08 * float(np.ptp(values)) or 1.0
    return float(values.min()) - margin, float(values.max()) + margin


def _pose_note(means: Sequence[PoseMeans], scatter_um: float) -> str:
    largest = max(float(np.abs(mean.mean_um).max()) for mean in means)
    count = float(np.mean(np.concatenate([mean.count for mean in means])))
    return (
        f"▲ above, ▼ below zero; area in proportion, the largest mean is {largest:.1f} µm; "
        f"the scatter of repeats alone gives U = {EXPANDED * scatter_um / np.sqrt(count):.1f} µm (k = 2)"
    )
