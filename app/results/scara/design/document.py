"""A design as JSON."""

import math

import numpy as np

from catseye.app.results.scara.design.design import Design, node_uncertainties
from catseye.app.results.scara.design.layouts import Layout
from catseye.app.results.scara.design.report import CRITERIA
from catseye.app.results.scara.design.reversal import Reversal
from catseye.procedures.kit.records import Json


def design_document(design: Design) -> dict[str, Json]:
    """Return a design as plain values; what is not a number is null."""
    problem, places = design.problem, design.places
    return {
        "criterion": problem.criterion.name,
        "unit": problem.criterion.unit,
        "systematic": problem.systematic,
        "path": problem.path_text,
        "reflectors": _reflectors(design),
        "layouts": [_layout(layout) for layout in design.layouts],
        "nodes": _nodes(design),
        "places": {
            "allowed": len(places.allowed),
            "excluded": {str(reason): count for reason, count in places.reasons.items()},
        },
        "pareto": _pareto(design),
        "j4_reversal": [_reversal(one) for one in design.reversals],
        **_choice(design),
    }


def _choice(design: Design) -> dict[str, Json]:
    """Return the chosen commands in measuring order; nothing where none were chosen."""
    choice, problem = design.choice, design.problem
    if choice is None:
        return {}
    commands = (problem.sequence[k] for k in np.flatnonzero(choice.kept))
    return {
        "commands": [
            [command.theta1_deg, command.theta2_deg, command.direction1, command.direction2]
            for command in commands
        ],
        "commands_bench_s": _finite(choice.cost.duration_s),
        "commands_value": _finite(choice.shown(problem.criterion.name, systematic=problem.systematic)),
    }


def _reflectors(design: Design) -> list[Json]:
    return [
        {
            "name": f"P{k}",
            "x_mm": float(sight.xy_mm[0]),
            "y_mm": float(sight.xy_mm[1]),
            "facing_deg": round(float(np.rad2deg(sight.facing_rad)), 1),
            "commands_seen": int(sight.seen.sum()),
            "breaks": sight.breaks,
        }
        for k, sight in enumerate(design.layout.sights, 1)
    ]


def _nodes(design: Design) -> list[Json]:
    return [
        {
            "joint": node.joint,
            "node_deg": node.node_deg,
            "direction": node.direction,
            "u_random_mdeg": node.white_mdeg,
            "u_mdeg": node.total_mdeg,
        }
        for node in node_uncertainties(design.layout)
    ]


def _pareto(design: Design) -> list[Json]:
    return [
        {
            "reflectors": row.reflectors,
            "commands": row.commands,
            "repeats": row.repeats,
            "bench_s": _finite(row.time_s),
            "u_random": _finite(row.u_white),
            "u": _finite(row.u_total),
            "front": row.front,
        }
        for row in design.compromises
    ]


def _reversal(reversal: Reversal) -> dict[str, Json]:
    """Return what a layout gives measured once, twice, and twice with the interferometer turned between."""
    ways = (("once", reversal.once), ("twice", reversal.again), ("turned", reversal.turned))
    return {"name": reversal.once.name, **{key: _arm(layout) for key, layout in ways}}


def _arm(layout: Layout) -> dict[str, Json]:
    keys = ("u_link1_um", "u_link2_um", "u_theta1_mdeg", "u_theta2_mdeg")
    return {key: _finite(u) for key, u in zip(keys, layout.u_of_arm(systematic=True), strict=True)}


def _layout(layout: Layout) -> dict[str, Json]:
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
