"""A design as JSON."""

import math

import numpy as np

from catseye.app.results.scara.design.design import Design, node_uncertainties
from catseye.app.results.scara.design.layouts import Layout
from catseye.app.results.scara.design.report import CRITERIA
from catseye.procedures.kit.records import Json


def design_document(found: Design) -> dict[str, Json]:
    """Return a design as plain values; what is not a number is null."""
    problem, places = found.problem, found.places
    chosen: dict[str, Json] = {}
    if found.choice is not None:
        rows = np.flatnonzero(found.choice.kept)
        chosen = {
            "commands": [
                [one.theta1_deg, one.theta2_deg, one.direction1, one.direction2]
                for one in (problem.sequence[k] for k in rows)
            ],
            "commands_bench_s": _finite(found.choice.cost.duration_s),
            "commands_value": _finite(
                found.choice.shown(problem.criterion.name, systematic=problem.systematic)
            ),
        }
    return {
        "criterion": problem.criterion.name,
        "unit": problem.criterion.unit,
        "systematic": problem.systematic,
        "path": problem.path_text,
        "reflectors": [
            {
                "name": f"P{k}",
                "x_mm": float(sight.xy_mm[0]),
                "y_mm": float(sight.xy_mm[1]),
                "facing_deg": round(float(np.rad2deg(sight.facing_rad)), 1),
                "commands_seen": int(sight.seen.sum()),
                "breaks": sight.breaks,
            }
            for k, sight in enumerate(found.layout.sights, 1)
        ],
        "layouts": [_layout_json(layout) for layout in found.layouts],
        "nodes": [
            {
                "joint": one.joint,
                "node_deg": one.node_deg,
                "direction": one.direction,
                "u_random_mdeg": one.white_mdeg,
                "u_mdeg": one.total_mdeg,
            }
            for one in node_uncertainties(found.layout)
        ],
        "places": {
            "allowed": len(places.allowed),
            "excluded": {str(reason): count for reason, count in places.reasons.items()},
        },
        "pareto": [
            {
                "reflectors": row.reflectors,
                "commands": row.commands,
                "repeats": row.repeats,
                "bench_s": _finite(row.time_s),
                "u_random": _finite(row.u_white),
                "u": _finite(row.u_total),
                "front": row.front,
            }
            for row in found.compromises
        ],
        **chosen,
    }


def _layout_json(layout: Layout) -> dict[str, Json]:
    values: dict[str, Json] = {}
    for name in CRITERIA:
        unit = "um" if name == "path" else "mdeg"
        values[f"{name}_{unit}"] = _finite(layout.shown(name, systematic=True))
        values[f"{name}_random_{unit}"] = _finite(layout.shown(name, systematic=False))
    return {
        "name": layout.name,
        "places_mm": [[float(x), float(y)] for x, y in layout.places_mm],
        **values,
        "bench_s": _finite(layout.cost.duration_s),
        "points": layout.cost.points,
        "planned_breaks": layout.cost.breaks,
        "blind": layout.cost.blind,
        "refused": layout.cost.refused,
    }


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
