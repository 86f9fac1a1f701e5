"""What a design found, as tables or as data."""

import math

import numpy as np

from catseye.app.analysis.design_commands import CommandChoice
from catseye.app.analysis.design_layouts import Layout
from catseye.app.analysis.designing import Design, NodeUncertainty, node_uncertainties, weakest
from catseye.app.cli.output import emit, emit_json, say, table
from catseye.app.results.numbers import duration_text
from catseye.calibration.core.design.criteria import CriterionName
from catseye.procedures.kit.context import Json

_CRITERIA: tuple[CriterionName, ...] = ("A", "D", "E", "path")


def tell_design(found: Design, *, as_json: bool) -> None:
    """Write a design to stdout, as tables or as one JSON object, and what there is to know about it to stderr."""
    if as_json:
        emit_json(_as_json(found))
    else:
        emit(_places_table(found))
        emit("")
        emit(_comparison(found))
        if found.compromises:
            emit("")
            emit(_front(found))
    for text in _remarks(found):
        say(text)


def _places_table(found: Design) -> str:
    rows = [
        [
            f"P{k}",
            f"{sight.xy_mm[0]:g}",
            f"{sight.xy_mm[1]:g}",
            f"{np.rad2deg(sight.facing_rad):.1f}",
            int(sight.seen.sum()),
            sight.breaks,
        ]
        for k, sight in enumerate(found.layout.sights, 1)
    ]
    return table(["reflector", "x mm", "y mm", "facing deg", "commands seen", "breaks"], rows)


def _comparison(found: Design) -> str:
    systematic = found.problem.systematic
    rows: list[list[object]] = []
    for layout in found.layouts:
        u = layout.u(systematic=systematic)
        arm = found.problem.study.layout
        rows.append(
            [
                layout.name,
                *(_number(layout.shown(name, systematic=systematic)) for name in _CRITERIA),
                _number(1e3 * float(u[0]), 1),
                _number(1e3 * float(u[1]), 1),
                _number(1e3 * float(np.rad2deg(u[arm.map1].max())), 2),
                _number(1e3 * float(np.rad2deg(u[arm.map2].max())), 2),
                layout.cost.points,
                layout.cost.breaks,
                _minutes(layout.cost.duration_s),
            ]
        )
    if found.choice is not None:
        choice = found.choice
        shown = (_number(choice.shown(name, systematic=systematic)) for name in _CRITERIA)
        name = f"{found.layout.name}, {int(choice.kept.sum())} commands"
        cost = choice.cost
        rows.append([name, *shown, "", "", "", "", cost.points, cost.breaks, _minutes(cost.duration_s)])
    head = ["layout", "A mdeg", "D mdeg", "E mdeg", "path µm", "u(L1) µm", "u(L2) µm", "u(Δθ1) mdeg"]
    return table([*head, "u(th2) mdeg", "points", "breaks", "bench min"], rows)


def _front(found: Design) -> str:
    unit = found.problem.criterion.unit
    rows = [
        [
            row.reflectors,
            row.commands,
            row.repeats,
            _minutes(row.time_s),
            _number(row.u_white),
            _number(row.u_total),
        ]
        for row in found.compromises
        if row.front
    ]
    return table(["reflectors", "commands", "repeats", "bench min", f"random {unit}", f"all {unit}"], rows)


def _remarks(found: Design) -> list[str]:
    problem, criterion = found.problem, found.problem.criterion
    places = found.places
    counts = ", ".join(f"{count} {reason}" for reason, count in places.reasons.items())
    texts = [
        f"criterion {criterion.name}: {criterion.meaning}, {criterion.unit}, k = 1; "
        + ("everything stated in [uncertainty]" if problem.systematic else "only what averages out"),
        f"path: {problem.path_text}",
        f"{len(places.allowed)} places allowed on a grid of {places.spacing_mm:.0f} mm; excluded: {counts or 'none'}",
        f"weakest: {', '.join(_weak_text(one) for one in weakest(found.layout))}",
    ]
    texts += [_plan_remark(layout) for layout in found.layouts[:1]]
    if found.compromises:
        beaten = sum(not row.front for row in found.compromises)
        texts.append(
            f"{beaten} further compromises are beaten in time and uncertainty; --json lists them too"
        )
    if found.choice is not None:
        texts.append(_choice_remark(found.choice))
        texts.append(
            "open-loop measures whole grids of nodes; a choice of commands is for programs of your own, or a hint "
            "which nodes may be left out"
        )
    return [text for text in texts if text]


def _choice_remark(choice: CommandChoice) -> str:
    kept = int(choice.kept.sum())
    if choice.asked is None or kept <= choice.asked:
        return ""
    return (
        f"warning: {choice.asked} commands leave parameters undetermined; the fewest that do not are {kept}"
    )


def _weak_text(one: NodeUncertainty) -> str:
    sign = "+" if one.direction > 0 else "−"
    return f"Δθ{one.joint}({one.node_deg:g}°, {sign}) {one.u_mdeg:.2f} mdeg"


def _plan_remark(layout: Layout) -> str:
    """Return what the plan of the measurement says of a layout; bench times are estimates of that plan."""
    cost = layout.cost
    if cost.refused:
        return f"warning: the plan of open-loop refuses this layout: {cost.refused}"
    return (
        f"planned: {cost.points} distances in about {duration_text(cost.duration_s, whole=True)} "
        f"(estimate of the plan, without search and set-up), {cost.breaks} planned breaks of the "
        f"beam, {cost.blind} blind commands"
    )


def _as_json(found: Design) -> dict[str, Json]:
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
    for name in _CRITERIA:
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


def _number(value: float, decimals: int = 3) -> str:
    return f"{value:.{decimals}f}" if math.isfinite(value) else "undetermined"


def _minutes(seconds: float) -> str:
    return f"{seconds / 60.0:.1f}" if math.isfinite(seconds) else "refused"


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
