"""Figures of calibrated serial arms: histograms of errors, lengths along a path, parameters, poses in space."""

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from catseye.app.results.figures import Axis, Bars, Figure, Level, Panel, Points, Role
from catseye.calibration.core.types import Floats

_BARS = 40
_NAMES = 12
"""Parameters in a panel."""
_ROW_ASPECT = 0.35

_SYMBOLS = {
    "alpha_deg": "α",
    "beta_deg": "β",
    "a_mm": "a",
    "theta_offset_deg": "θ",
    "d_mm": "d",
    "compliance_rad_per_nmm": "c",
}


def histograms(key: str, title: str, states: Sequence[tuple[str, Floats]]) -> Figure:
    """Return a histogram of errors for each state, the first on its own scale."""
    panels = tuple(_histogram(state, error_mm) for state, error_mm in states)
    means = "; ".join(f"{state}: mean {error_mm.mean():.3f} mm" for state, error_mm in states)
    return Figure(key, title, f"{title} ({means}). The line is the mean.", (panels,))


def _histogram(state: str, error_mm: Floats) -> Panel:
    height, edges = np.histogram(error_mm, _BARS, (0.0, max(float(error_mm.max()), 1e-6)))
    marks = (
        Bars(edges, height.astype(np.float64), Role.SCATTER),
        Level(float(error_mm.mean()), Role.EXPECTED, vertical=True, dash="dashed"),
    )
    return Panel(state, Axis("error / mm", low=0.0), Axis("measurements"), marks)


def deviations(names: Sequence[str], values: Floats, u: Floats, unit: str) -> Figure:
    """Return identified minus nominal parameters of one unit with their uncertainties."""
    panels = by_name(
        names,
        Points(np.arange(len(names), dtype=np.float64), values, Role.CHANGE, "", u),
        f"deviation / {unit}",
    )
    caption = f"Identified minus nominal parameters in {unit}; error bars: U (k = 2)."
    aspect = _ROW_ASPECT * len(panels)
    # The key begins the names of marks in the picture, and these stand in addresses.
    key = re.sub(r"[^a-z]+", "-", f"deviations-{unit}".lower()).strip("-")
    return Figure(key, f"Deviations in {unit}", caption, panels, aspect=aspect)


def by_name(
    names: Sequence[str], points: Points, label: str, levels: Sequence[Level] = (Level(0.0, Role.AXIS),)
) -> tuple[tuple[Panel], ...]:
    """Return a value a parameter, in as many panels below one another as their names need.

    Args:
        points: in the order of the names.
    """
    panels = []
    for first in range(0, len(names), _NAMES):
        part = slice(first, first + _NAMES)
        shown = replace(
            points,
            x=np.arange(len(names[part]), dtype=np.float64),
            y=points.y[part],
            u=None if points.u is None else points.u[part],
        )
        panels.append(
            (Panel("", Axis("", names=tuple(map(_short, names[part]))), Axis(label), (shown, *levels)),)
        )
    return tuple(panels)


def _short(name: str) -> str:
    owner, _, part = name.rpartition(".")
    return f"{owner} {_SYMBOLS.get(part, part.removesuffix('_deg').removesuffix('_mm'))}"


def places(place_mm: Floats, error_mm: Floats) -> Figure:
    """Return where targets were measured, from above and from the side, coloured by their errors left out."""
    views = (("from above", 0, 1), ("from the side", 0, 2))
    panels = tuple(
        Panel(
            title,
            Axis(f"{'xyz'[i]} / mm"),
            Axis(f"{'xyz'[j]} / mm"),
            (
                Points(
                    place_mm[:, i],
                    place_mm[:, j],
                    Role.SCATTER,
                    value=error_mm,
                    value_label="error left out / mm",
                ),
            ),
            equal=True,
        )
        for title, i, j in views
    )
    return Figure(
        "places", "Measured places", "Measured places, in the frame in which base is stated.", (panels,)
    )


def length_errors(states: Sequence[tuple[str, Floats]], targets: Sequence[str]) -> Figure:
    """Return measured minus predicted lengths in measuring order, a panel for each target and both states in it."""
    return signed_by_target(
        "length-errors", "Length errors by measurement", states, targets, "measured − predicted / mm"
    )


def signed_by_target(
    key: str, title: str, states: Sequence[tuple[str, Floats]], targets: Sequence[str], label: str
) -> Figure:
    """Return signed errors in measuring order, a panel for each target and all states in it.

    Args:
        states: name and errors, mm, of each, the reference first where there are two.
        targets: of the errors.
        label: of the errors' axis.
    """
    names = np.array(targets)
    roles = (Role.CONVENTIONAL, Role.POSITIVE) if len(states) > 1 else (Role.POSITIVE,)
    panels = []
    for target in dict.fromkeys(targets):
        of_it = np.flatnonzero(names == target)
        order = np.arange(1, len(of_it) + 1, dtype=np.float64)
        marks = tuple(
            Points(order, signed_mm[of_it], role, state, joined=True, size=3.0)
            for (state, signed_mm), role in zip(states, roles, strict=True)
        )
        zero = Level(0.0, Role.AXIS)
        panels.append((Panel(target, Axis("measurement", counts=True), Axis(label), (*marks, zero)),))
    caption = f"{title}: {label.removesuffix(' / mm')} of each, in measuring order."
    return Figure(key, title, caption, tuple(panels), aspect=0.4 * len(panels))
