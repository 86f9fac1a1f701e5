"""Residuals of the fit: against the joints, their distribution, and their means per pose."""

from collections.abc import Sequence
from statistics import NormalDist

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from catseye.app.files.result_json import Residuals
from catseye.app.report.figures.canvas import MUTED, STYLE, WIDTH_IN, series
from catseye.app.report.residual_groups import PoseMeans, Reference, pose_means
from catseye.calibration.core.types import Bools, Floats

_ABOVE, _BELOW = "#b35806", "#542788"


@rc_context(STYLE)
def residual_figure(residuals: Residuals, reference: Reference) -> Figure:
    """Draw the residuals.

    Args:
        residuals: of one model.
        reference: what they are compared with.
    """
    names = list(dict.fromkeys(residuals.reflector))
    figure = Figure(figsize=(WIDTH_IN, 8.6))
    upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=(2.0, 1.05))[:, 0]
    panels = upper.subplots(2, 2)
    value = np.array(residuals.residual_um)
    member = [np.array([name == one for name in residuals.reflector]) for one in names]
    for axes, joint, angles in (
        (panels[0, 0], 1, residuals.theta1_deg),
        (panels[0, 1], 2, residuals.theta2_deg),
    ):
        _against(axes, np.array(angles), value, member, names)
        axes.set_xlabel(f"command θ{joint} / °")
        axes.set_title(f"{'ab'[joint - 1]}) against θ{joint}, with means")
    panels[0, 0].set_ylabel("residual / µm")
    _histogram(panels[1, 0], value, reference)
    _quantiles(panels[1, 1], value, reference.sigma_um)
    upper.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=len(names))
    _poses(lower, [pose_means(residuals, name) for name in names], names, reference.scatter_um)
    return figure


def _against(
    axes: Axes, theta_deg: Floats, value: Floats, member: Sequence[Bools], names: Sequence[str]
) -> None:
    nodes = np.unique(theta_deg)
    step = float(np.min(np.diff(nodes))) if nodes.size > 1 else 1.0
    axes.axhline(0.0, color="#5f6670", linewidth=0.6)
    for index, (rows, name) in enumerate(zip(member, names, strict=True)):
        colour, marker = series(index)
        shift = 0.16 * step * (index - 0.5 * (len(names) - 1))
        axes.plot(theta_deg[rows] + shift, value[rows], ".", color=colour, markersize=2.0, alpha=0.55)
        own = np.unique(theta_deg[rows])
        means = [float(value[rows & (theta_deg == node)].mean()) for node in own]
        axes.plot(
            own + shift,
            means,
            color=colour,
            marker=marker,
            markersize=4.5,
            markeredgecolor="white",
            markeredgewidth=0.5,
            linewidth=0.8,
            label=f"reflector {name}",
        )


def _histogram(axes: Axes, value: Floats, reference: Reference) -> None:
    sigma_um, origin = reference.sigma_um, "stated" if reference.stated else "from the fit"
    bins = int(np.clip(np.sqrt(value.size), 8, 40))
    edges = np.linspace(value.min(), value.max(), bins + 1) if np.ptp(value) > 0.0 else np.array([-1.0, 1.0])
    axes.hist(value, list(edges), color="#b9c4d2", edgecolor="white", linewidth=0.4)
    if sigma_um > 0.0:
        x = np.linspace(-4.0 * sigma_um, 4.0 * sigma_um, 161)
        height = value.size * (edges[1] - edges[0]) / (sigma_um * np.sqrt(2.0 * np.pi))
        axes.plot(x, height * np.exp(-0.5 * (x / sigma_um) ** 2), color="black", linewidth=1.0)
    axes.set_title("c) distribution")
    axes.text(
        0.02,
        0.97,
        f"line: normal,\nσ = {sigma_um:.1f} µm\n({origin})",
        transform=axes.transAxes,
        va="top",
        fontsize=8,
    )
    axes.set_xlabel("residual / µm")
    axes.set_ylabel("number of distances")


def _quantiles(axes: Axes, value: Floats, sigma_um: float) -> None:
    normal = NormalDist()
    shares = (np.arange(value.size) + 0.5) / value.size
    expected = sigma_um * np.array([normal.inv_cdf(float(share)) for share in shares])
    axes.plot(expected, np.sort(value), ".", color="#35608f", markersize=2.5)
    ends = [float(expected[0]), float(expected[-1])]
    axes.plot(ends, ends, color="black", linewidth=0.9)
    axes.set_title("d) normal quantiles")
    axes.set_xlabel("expected of a normal distribution / µm")
    axes.set_ylabel("residual / µm")


def _poses(area: SubFigure, means: Sequence[PoseMeans], names: Sequence[str], scatter_um: float) -> None:
    row = area.subplots(1, len(names), sharex=True, sharey=True, squeeze=False)[0]
    largest = max(float(np.abs(one.mean_um).max()) for one in means)
    unit = largest or 1.0
    for letter, axes, one, name in zip("efghijklmn", row, means, names, strict=False):
        for rows, colour, marker in ((one.mean_um > 0.0, _ABOVE, "^"), (one.mean_um <= 0.0, _BELOW, "v")):
            axes.scatter(
                one.theta1_deg[rows],
                one.theta2_deg[rows],
                60.0 * np.abs(one.mean_um[rows]) / unit,
                c=colour,
                marker=marker,
                linewidths=0.0,
            )
        axes.set_title(f"{letter}) poses, {name}")
        axes.set_xlabel("command θ1 / °")
        axes.margins(0.08)
    row[0].set_ylabel("command θ2 / °")
    count = float(np.mean(np.concatenate([one.count for one in means])))
    text = (
        f"▲ above, ▼ below zero; area in proportion, the largest mean is {largest:.1f} µm; "
        f"the scatter of repeats alone gives {scatter_um / np.sqrt(count):.1f} µm (k = 1)"
    )
    area.text(0.5, 0.0, text, ha="center", va="bottom", fontsize=8, color="#33383e")
    area.supxlabel(" ", fontsize=8, color=MUTED)
