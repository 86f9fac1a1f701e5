"""Estimates against the truth of an emulated bench: normalised errors."""

import math
from dataclasses import dataclass

from catseye.app.files.result_json import Estimate, MapTable, Result
from catseye.app.results.numbers import plain
from catseye.app.results.scara.content import TruthMap, TruthTables

LIMIT = 2.0
"""A normalised error within ±2 is expected of 95 in 100 estimates."""


@dataclass(frozen=True)
class NormalisedError:
    """(estimate − truth) / u of one parameter."""

    name: str
    value: float


def normalised(estimate: float, true: float, u: float) -> float:
    """Return the normalised error, NaN where there is no uncertainty or no truth."""
    return (estimate - true) / u if u > 0.0 else math.nan


def normalised_errors(result: Result, truth: TruthTables) -> list[NormalisedError]:
    """Return the normalised errors of links, maps and reflectors of an error map."""
    found = [
        NormalisedError("L1", _of(result.link1_mm, truth.link1_mm)),
        NormalisedError("L2", _of(result.link2_mm, truth.link2_mm)),
    ]
    for joint, table, true_map in (
        (1, result.theta1_map, truth.theta1_map),
        (2, result.theta2_map, truth.theta2_map),
    ):
        found += [] if table is None else _of_map(joint, table, true_map)
    for place in result.reflectors:
        true_place = truth.reflectors_mm.get(place.name, (math.nan, math.nan))
        found.append(NormalisedError(f"{place.name} x", _of(place.x_mm, true_place[0])))
        found.append(NormalisedError(f"{place.name} y", _of(place.y_mm, true_place[1])))
    return [one for one in found if math.isfinite(one.value)]


def _of(estimate: Estimate, true: float) -> float:
    return normalised(estimate.value, true, estimate.u)


def _of_map(joint: int, table: MapTable, true_map: TruthMap) -> list[NormalisedError]:
    return [
        NormalisedError(f"Δθ{joint}({plain(node)}°, {sign})", normalised(value, float(true), u))
        for direction, sign, values, us in (
            (1, "+", table.positive_mdeg, table.u_positive_mdeg),
            (-1, "−", table.negative_mdeg, table.u_negative_mdeg),
        )
        for node, value, true, u in zip(
            table.node_deg, values, true_map.at(table.node_deg, direction), us, strict=True
        )
    ]
