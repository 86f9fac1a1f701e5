"""What an emulated bench really is, and how far estimates are from it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from catseye.app.results.model import Sign, Statement
from catseye.app.results.numbers import EXPANDED, SHARE_EXPECTED, fixed, number
from catseye.app.results.scara.names import node_name
from catseye.app.results.scara.result import Estimate, MapTable, Result
from catseye.app.results.scara.truth import gauge_turn_rad, turned_places
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.identification import Identification


@dataclass(frozen=True)
class TruthMap:
    """The true bidirectional map of one joint; its nodes may be finer than those of a result.

    Attributes:
        node_deg: command angles, strictly increasing.
        positive_mdeg: deviation when approached upwards.
        negative_mdeg: deviation when approached downwards.
    """

    node_deg: Sequence[float]
    positive_mdeg: Sequence[float]
    negative_mdeg: Sequence[float]

    def at(self, node_deg: Sequence[float], direction: int) -> Floats:
        """Return the deviation at command angles, mdeg; NaN beyond the nodes. The direction is 1 or -1."""
        table = self.positive_mdeg if direction > 0 else self.negative_mdeg
        return np.interp(node_deg, self.node_deg, table, left=np.nan, right=np.nan)


@dataclass(frozen=True)
class TruthTables:
    """What an emulated bench really is, in the gauge of the error map.

    Attributes:
        link1_mm: length of link 1.
        link2_mm: length of link 2.
        theta1_map: map of J1.
        theta2_map: map of J2.
        reflectors_mm: x and y by name.
    """

    link1_mm: float
    link2_mm: float
    theta1_map: TruthMap
    theta2_map: TruthMap
    reflectors_mm: Mapping[str, tuple[float, float]]


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
        NormalisedError(node_name(joint, node, direction), normalised(value, float(true), u))
        for direction, values, us in table.by_direction
        for node, value, true, u in zip(
            table.node_deg, values, true_map.at(table.node_deg, direction), us, strict=True
        )
    ]


def truth_statement(result: Result, truth: TruthTables) -> Statement:
    """Return whether the stated uncertainties cover the distance to the truth."""
    errors = normalised_errors(result, truth)
    if not errors:
        return Statement(Sign.NEUTRAL, "No parameter could be compared with the truth.")
    values = np.array([error.value for error in errors])
    within = int(np.sum(np.abs(values) <= EXPANDED))
    worst = errors[int(np.argmax(np.abs(values)))]
    share = within / len(errors)
    largest = number(worst.value, fixed(2, signed=True))
    return Statement(
        Sign.GOOD if share >= SHARE_EXPECTED else Sign.BAD,
        f"Against the truth of the emulated bench {within} of {len(errors)} parameters lie within ±2 u "
        f"({100.0 * share:.0f} %, 95 % expected); rms of the normalised errors {np.sqrt(np.mean(values**2)):.2f}, "
        f"the largest {largest} at {worst.name}.",
    )


def truth_tables(identified: Identification, document: dict[str, Any]) -> TruthTables:
    """Return a truth document in the gauge of an identification."""
    turn = gauge_turn_rad(identified, document)
    return TruthTables(
        link1_mm=document["link1_mm"]["value"],
        link2_mm=document["link2_mm"]["value"],
        theta1_map=_truth_map(document["theta1_map"], 1e3 * float(np.rad2deg(turn))),
        theta2_map=_truth_map(document["theta2_map"], 0.0),
        reflectors_mm=turned_places(document, turn),
    )


def _truth_map(table: Mapping[str, Any], shift_mdeg: float) -> TruthMap:
    return TruthMap(
        table["node_deg"],
        [value - shift_mdeg for value in table["positive_mdeg"]],
        [value - shift_mdeg for value in table["negative_mdeg"]],
    )
