"""Figures of calibrated serial arms: histograms of errors, lengths along a path, parameters, poses in space."""

from collections.abc import Sequence

import numpy as np

from catseye.app.results.figures import Axis, Bars, Figure, Level, Panel, Points, Role
from catseye.calibration.core.types import Floats

_BARS = 40


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
    return Panel(state, Axis("error / mm", low=0.0), Axis("rows"), marks)


def deviations(names: Sequence[str], values: Floats, u: Floats, unit: str) -> Figure:
    """Return identified minus nominal parameters of one unit with their standard uncertainties."""
    marks = (
        Points(np.arange(len(names), dtype=np.float64), values, Role.CHANGE, "identified − nominal", u),
        Level(0.0, Role.AXIS),
    )
    panel = Panel("", Axis("", names=tuple(names)), Axis(f"deviation / {unit}"), marks)
    caption = f"Deviations from the drawing in {unit}; bars: standard uncertainty (k = 1)."
    return Figure(f"deviations-{unit}", f"Deviations in {unit}", caption, ((panel,),))


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
    return Figure("places", "Measured places", "Measured places in the frame of the instrument.", (panels,))


def length_errors(states: Sequence[tuple[str, Floats]], targets: Sequence[str]) -> Figure:
    """Return errors of measured lengths in measuring order, a panel for each target and both states in it."""
    names, roles = np.array(targets), (Role.CONVENTIONAL, Role.POSITIVE)
    panels = []
    for target in dict.fromkeys(targets):
        of_it = np.flatnonzero(names == target)
        order = np.arange(1, len(of_it) + 1, dtype=np.float64)
        marks = tuple(
            Points(order, signed_mm[of_it], role, state, joined=True, size=3.0)
            for (state, signed_mm), role in zip(states, roles, strict=False)
        )
        zero = Level(0.0, Role.AXIS)
        panels.append(
            (Panel(target, Axis("measurement"), Axis("predicted − measured / mm"), (*marks, zero)),)
        )
    caption = "Error of each measured length, predicted minus measured."
    return Figure(
        "length-errors", "Length errors by measurement", caption, tuple(panels), aspect=0.4 * len(panels)
    )
