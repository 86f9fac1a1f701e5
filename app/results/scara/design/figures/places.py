"""The floor from above: what each place would bring, where none is allowed, where the reflectors stand."""

import numpy as np

from catseye.app.results.figures import Axis, Figure, Line, Mark, Panel, Points, Role, Shape, Text, columns
from catseye.app.results.numbers import counted
from catseye.app.results.scara.design.design import Design, exchanged_values
from catseye.calibration.core.types import Floats

_MARKERS = {
    "inside the keep-out radius": ".",
    "in the arm's way": "+",
    "seen from too few commands": "x",
    "J4 winds up": "1",
    "beam breaks too often": "_",
}

_FIELD_MM = 150.0
_ORIGIN = (0.0, 0.0)


def places_figure(design: Design) -> Figure:
    """Return candidates coloured by the criterion, excluded places by reason, and the layouts."""
    known: list[Mark] = [
        Points(*columns(layout.places_mm), Role.TRUTH, layout.name, marker=marker, size=8.0, hollow=True)
        for layout, marker in zip(design.known, "sD", strict=False)
    ]
    marks = (*_arm(design), *_excluded(design), *_allowed(design), *known, *_chosen(design))
    return Figure(
        "places",
        "Places for reflectors seen from above",
        "Candidates coloured by the criterion if the reflector that is missed least stood there instead; darker is "
        "better. Grey marks: no reflector may stand there, by reason. Wedges: fields of the chosen reflectors.",
        ((Panel("", Axis("X / mm"), Axis("Y / mm"), marks, equal=True),),),
        aspect=0.74,
        legend="below",
        legend_columns=3,
    )


def _arm(design: Design) -> list[Mark]:
    rules, study = design.problem.rules, design.problem.study
    way = design.problem.way
    return [
        Shape(_ORIGIN, (rules.column_radius_mm, rules.column_radius_mm), Role.COLUMN, filled=True),
        Shape(_ORIGIN, (study.reach_mm, study.reach_mm), Role.MUTED, "reach", dashed=True),
        Points(*columns(way.xy_mm[way.command]), Role.COMMAND, "commands", size=1.5),
    ]


def _excluded(design: Design) -> list[Mark]:
    marks: list[Mark] = []
    for reason, count in design.places.reasons.items():
        places = np.array([sight.xy_mm for sight in design.places.excluded if sight.reason == reason])
        label = f"{reason}: {counted(count, 'place')}"
        marks.append(Points(*columns(places), Role.MUTED, label, marker=_MARKERS[reason], size=4.0))
    return marks


def _allowed(design: Design) -> list[Mark]:
    least, values = exchanged_values(design)
    known = np.isfinite(values)
    xy = np.array([sight.xy_mm for sight in design.places.allowed])[known]
    if not len(xy):
        return []
    # A few bad places would take all the colours.
    low, high = float(values[known].min()), float(np.quantile(values[known], 0.9))
    criterion = design.problem.criterion
    return [
        Points(
            *columns(xy),
            Role.MUTED,
            value=values[known],
            value_label=f"criterion {criterion.name} with P{least + 1} there / {criterion.unit}",
            value_ends=(low, max(high, low * 1.001)),
            size=5.1,
        )
    ]


def _chosen(design: Design) -> list[Mark]:
    half = float(np.rad2deg(design.problem.rules.field_half_angle_rad))
    marks: list[Mark] = []
    for place, sight in enumerate(design.layout.sights, 1):
        facing = float(np.rad2deg(sight.facing_rad))
        where = (float(sight.xy_mm[0]), float(sight.xy_mm[1]))
        labels = ("facing", "designed, with its field") if place == 1 else ("", "")
        field = Shape(
            where,
            (_FIELD_MM, _FIELD_MM),
            Role.CHOSEN,
            filled=True,
            outlined=False,
            from_deg=facing - half,
            to_deg=facing + half,
        )
        marks += [
            field,
            Line(*columns(_towards(sight.xy_mm, facing)), Role.CHOSEN, labels[0], width=1.0),
            Points(np.array(where[:1]), np.array(where[1:]), Role.CHOSEN, labels[1], size=8.0),
            Text(f"P{place}", where, Role.CHOSEN),
        ]
    return marks


def _towards(xy_mm: Floats, facing_deg: float) -> Floats:
    turned = np.deg2rad(facing_deg)
    return np.array([xy_mm, xy_mm + _FIELD_MM * np.array([np.cos(turned), np.sin(turned)])])
