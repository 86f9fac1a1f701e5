"""Two results of one arm against one another: links, error maps, reflectors."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.linalg import block_diag

from catseye.app.cell.scara.uncertainty import WAVELENGTH
from catseye.app.errors import UsageError
from catseye.app.results.difference import Difference
from catseye.app.results.numbers import EXPANDED, MDEG_PER_RAD
from catseye.app.results.scara.changes import Change, Compared, Pattern, changes_of, largest
from catseye.app.results.scara.identified_arm import arm_of, unverified_texts
from catseye.app.results.scara.names import node_name
from catseye.app.results.scara.result import Estimate, MapTable, Result
from catseye.app.results.scara.shared_errors import NOTHING_SHARED, SharedErrors
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.error_map import interpolate
from catseye.calibration.scara.identification import IdentifiedArm

_RANGE_DEG = 1e-6
"""Nodes that rounding puts beyond the end of a map belong to it."""


@dataclass(frozen=True)
class MapDifference:
    """One joint's maps in both results, as columns over the nodes.

    Attributes:
        joint: 1 or 2.
        node_deg: command angles that both results know, deg, shape (m,).
        first_mdeg: of the first result, upwards then downwards, shape (2, m).
        second_mdeg: of the second result, shape (2, m).
        first_u_mdeg: standard uncertainty of the first, in the gauge of these nodes, shape (2, m).
        second_u_mdeg: likewise of the second, shape (2, m).
        common_mdeg2: covariance of both by what they share, which is none of their difference, shape (2, m).
    """

    joint: int
    node_deg: Floats
    first_mdeg: Floats
    second_mdeg: Floats
    first_u_mdeg: Floats
    second_u_mdeg: Floats
    common_mdeg2: Floats

    @property
    def u_mdeg(self) -> Floats:
        """Standard uncertainty of the difference, shape (2, m)."""
        variance = self.first_u_mdeg**2 + self.second_u_mdeg**2 - 2.0 * self.common_mdeg2
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)), dtype=np.float64)

    @property
    def difference_mdeg(self) -> Floats:
        """Second minus first, shape (2, m)."""
        return self.second_mdeg - self.first_mdeg

    @property
    def normalised(self) -> Floats:
        """Difference in combined standard uncertainties, shape (2, m); NaN where none is stated."""
        u = np.where(self.u_mdeg > 0.0, self.u_mdeg, np.nan)
        return np.asarray(self.difference_mdeg / u, dtype=np.float64)


@dataclass(frozen=True)
class ResultComparison:
    """Two results in one frame.

    Attributes:
        values: links, and θ20 of two conventional models.
        maps: of both joints; none of two conventional models.
        reflectors: coordinates of the reflectors that both know.
        changes: of links and maps, one value at a time.
        turn_mdeg: by how much the second result was turned about J1, counter-clockwise, mdeg.
        remarks: what a reader has to know.
    """

    values: tuple[Difference, ...]
    maps: tuple[MapDifference, ...]
    reflectors: tuple[Difference, ...]
    changes: tuple[Change, ...]
    turn_mdeg: float
    remarks: tuple[str, ...]

    @property
    def normalised(self) -> Floats:
        """Every difference that has an uncertainty, in combined standard uncertainties."""
        single = [one.normalised for one in (*self.values, *self.reflectors)]
        columns = [joint_map.normalised.ravel() for joint_map in self.maps]
        found = np.concatenate([np.array([value for value in single if value is not None]), *columns])
        return np.asarray(found[np.isfinite(found)], dtype=np.float64)

    @property
    def largest(self) -> tuple[str, float] | None:
        """What of the arm has changed most, and by how many standard uncertainties; None where nothing is known.

        Reflectors are no part of the arm: somebody may have placed them anew.
        """
        if (change := largest(self.changes)) is not None:
            return change.name, change.normalised
        stated = [(one.name, one.normalised) for one in self.values if one.normalised is not None]
        return max(stated, key=lambda item: abs(item[1]), default=None)

    @property
    def within(self) -> tuple[int, int]:
        """How many differences lie within two combined standard uncertainties, of how many."""
        return int(np.sum(np.abs(self.normalised) <= EXPANDED)), self.normalised.size


def compare_results(first: Result, second: Result) -> ResultComparison:
    """Compare two results of one arm.

    Distances do not fix the rotation about J1: the nodes of each result fix its own. So the second is turned, its
    reflectors with it, until both Δθ1 maps have one mean over the nodes that are compared. The conventional model is
    the error map with Δθ1 = 0 and Δθ2 = θ20 everywhere.

    Raises:
        UsageError: a result is incomplete, or the maps have no angle in common.
    """
    arms = arm_of(first), arm_of(second)
    shared = _shared(first, second, arms)
    maps = [_map(joint, first, second, arms, shared) for joint in (1, 2) if _has_map(first, second)]
    turn_mdeg = -float(np.mean(maps[0].difference_mdeg)) if maps else 0.0
    if maps:
        maps[0] = replace(maps[0], second_mdeg=maps[0].second_mdeg + turn_mdeg)
    values = _values(first, second, arms, shared, maps=bool(maps))
    return ResultComparison(
        values=values,
        maps=tuple(maps),
        changes=tuple(_changes(values[:2], maps, arms, shared)) if maps else (),
        reflectors=_reflectors(first, second, turn_mdeg / MDEG_PER_RAD),
        turn_mdeg=turn_mdeg,
        remarks=tuple(_remarks(first, second, shared)),
    )


def _changes(
    links: Sequence[Difference],
    maps: Sequence[MapDifference],
    arms: tuple[IdentifiedArm, IdentifiedArm],
    shared: SharedErrors,
) -> list[Change]:
    """Return the changes of links and nodes, one at a time."""
    gauges = [_gauge(one) for one in maps]
    weights = [
        np.vstack(
            [
                np.eye(len(links), arm.parameters.size),
                *(
                    MDEG_PER_RAD * gauge @ _map_weights(arm, one.joint, one.node_deg).reshape(len(gauge), -1)
                    for one, gauge in zip(maps, gauges, strict=True)
                ),
            ]
        )
        for arm in arms
    ]
    difference = [np.array([one.difference for one in links]), *(one.difference_mdeg.ravel() for one in maps)]
    compared = Compared(np.concatenate(difference), (weights[0], weights[1]))
    patterns = _patterns(links, maps, np.asarray(block_diag(np.eye(len(links)), *gauges), dtype=np.float64))
    return changes_of(compared, patterns, (arms[0].covariance, arms[1].covariance), shared)


def _gauge(difference: MapDifference) -> Floats:
    """Return what takes a joint's maps into the gauge of the comparison: those of J1 have the mean 0."""
    count = difference.difference_mdeg.size
    return np.asarray(np.eye(count) - (1.0 / count if difference.joint == 1 else 0.0), dtype=np.float64)


def _patterns(links: Sequence[Difference], maps: Sequence[MapDifference], gauge: Floats) -> Iterator[Pattern]:
    """Yield a link, a node from one side, and a node from both sides, each alone."""
    for place, one in enumerate(links):
        yield Pattern(one.name, one.unit, gauge[:, place])
    place = len(links)
    for table in maps:
        nodes = table.node_deg.tolist()
        for number, node in enumerate(nodes):
            sides = gauge[:, place + number], gauge[:, place + len(nodes) + number]
            for direction, side in zip((1, -1), sides, strict=True):
                yield Pattern(node_name(table.joint, node, direction), "mdeg", side)
            yield Pattern(node_name(table.joint, node), "mdeg", sides[0] + sides[1])
        place += 2 * len(nodes)


def _has_map(first: Result, second: Result) -> bool:
    return "error-map" in (first.model, second.model)


def _shared(first: Result, second: Result, arms: tuple[IdentifiedArm, IdentifiedArm]) -> SharedErrors:
    """Return what both measurements share; of the same distances nobody takes it apart."""
    if set(first.provenance.runs) & set(second.provenance.runs):
        return NOTHING_SHARED
    lasers = first.provenance.interferometer, second.provenance.interferometer
    return SharedErrors.of(arms, same_laser=lasers[0] is not None and lasers[0] == lasers[1])


def _values(
    first: Result,
    second: Result,
    arms: tuple[IdentifiedArm, IdentifiedArm],
    shared: SharedErrors,
    *,
    maps: bool,
) -> tuple[Difference, ...]:
    found = []
    for place, (name, one, other) in enumerate(
        (("L1", first.link1_mm, second.link1_mm), ("L2", first.link2_mm, second.link2_mm))
    ):
        parts = (np.eye(arm.parameters.size)[place] for arm in arms)
        found.append(_difference(name, "mm", one, other, float(shared.covariance(*parts))))
    if not maps and first.theta20_mdeg is not None and second.theta20_mdeg is not None:
        found.append(_difference("θ20", "mdeg", first.theta20_mdeg, second.theta20_mdeg))
    return tuple(found)


def _difference(
    name: str, unit: Literal["mm", "mdeg"], first: Estimate, second: Estimate, common: float = 0.0
) -> Difference:
    return Difference(name, unit, first.value, second.value, first.u, second.u, common)


def _map(
    joint: int,
    first: Result,
    second: Result,
    arms: tuple[IdentifiedArm, IdentifiedArm],
    shared: SharedErrors,
) -> MapDifference:
    nodes_deg = _common_nodes_deg(joint, _table(first, joint), _table(second, joint))
    weights = [_map_weights(arm, joint, nodes_deg) for arm in arms]
    values = [MDEG_PER_RAD * (one @ arm.parameters) for one, arm in zip(weights, arms, strict=True)]
    if joint == 1:
        # Uncertainties in the gauge in which both are compared: the mean over these nodes is zero.
        weights = [one - one.mean(axis=(0, 1)) for one in weights]
    u_mdeg = [MDEG_PER_RAD * _u(one, arm) for one, arm in zip(weights, arms, strict=True)]
    common_mdeg2 = MDEG_PER_RAD**2 * shared.covariance(weights[0], weights[1])
    return MapDifference(joint, nodes_deg, values[0], values[1], u_mdeg[0], u_mdeg[1], common_mdeg2)


def _table(result: Result, joint: int) -> MapTable | None:
    return result.theta1_map if joint == 1 else result.theta2_map


def _common_nodes_deg(joint: int, first: MapTable | None, second: MapTable | None) -> Floats:
    """Return the nodes of the coarser map that lie within the other's range: a fine map is known there too.

    Raises:
        UsageError: there are none.
    """
    tables = sorted((one for one in (first, second) if one is not None), key=lambda one: len(one.node_deg))
    nodes = np.array(tables[0].node_deg, dtype=np.float64)
    other = np.array(tables[-1].node_deg, dtype=np.float64)
    common = nodes[(nodes >= other[0] - _RANGE_DEG) & (nodes <= other[-1] + _RANGE_DEG)]
    if not common.size:
        raise UsageError(
            f"the maps of J{joint} have no angle in common: {nodes[0]:g}°…{nodes[-1]:g}° and "
            f"{other[0]:g}°…{other[-1]:g}°; compare results whose nodes overlap"
        )
    return np.asarray(common, dtype=np.float64)


def _map_weights(arm: IdentifiedArm, joint: int, nodes_deg: Floats) -> Floats:
    """Return what each parameter contributes to a map at angles, upwards then downwards, shape (2, m, p)."""
    return np.stack([_weights(arm, joint, direction, nodes_deg) for direction in (0, 1)])


def _u(weights: Floats, arm: IdentifiedArm) -> Floats:
    variance = np.einsum("dmp,pq,dmq->dm", weights, arm.covariance, weights)
    return np.asarray(np.sqrt(np.maximum(variance, 0.0)), dtype=np.float64)


def _weights(arm: IdentifiedArm, joint: int, direction: int, nodes_deg: Floats) -> Floats:
    """Return what each parameter contributes to a map at angles, shape (m, p)."""
    layout, rows = arm.layout, np.arange(nodes_deg.size)
    weights = np.zeros((nodes_deg.size, arm.parameters.size))
    if layout.model == "conventional":
        weights[:, 2] = 1.0 if joint == 2 else 0.0
        return weights
    nodes_rad, part = (layout.nodes1_rad, layout.map1) if joint == 1 else (layout.nodes2_rad, layout.map2)
    place = interpolate(nodes_rad, np.clip(np.deg2rad(nodes_deg), nodes_rad[0], nodes_rad[-1]))
    begin = part.start + direction * nodes_rad.size
    weights[rows, begin + place.lower] += 1.0 - place.alpha
    weights[rows, begin + np.minimum(place.lower + 1, nodes_rad.size - 1)] += place.alpha
    return weights


def _reflectors(first: Result, second: Result, turn_rad: float) -> tuple[Difference, ...]:
    cosine, sine = math.cos(turn_rad), math.sin(turn_rad)
    others = {place.name: place for place in second.reflectors}
    found: list[Difference] = []
    for place in first.reflectors:
        if (other := others.get(place.name)) is None:
            continue
        x_mm = cosine * other.x_mm.value - sine * other.y_mm.value
        y_mm = sine * other.x_mm.value + cosine * other.y_mm.value
        turned = Estimate(value=x_mm, u=other.x_mm.u), Estimate(value=y_mm, u=other.y_mm.u)
        found += [
            _difference(f"{place.name} x", "mm", place.x_mm, turned[0]),
            _difference(f"{place.name} y", "mm", place.y_mm, turned[1]),
        ]
    return tuple(found)


def _remarks(first: Result, second: Result, errors: SharedErrors) -> list[str]:
    shared = [name for name in first.provenance.runs if name in second.provenance.runs]
    remarks = list(dict.fromkeys([*unverified_texts(first), *unverified_texts(second)]))
    if shared:
        remarks.append(
            f"both were identified from {', '.join(shared)}: their errors are shared, and the combined standard "
            "uncertainties are usually too large"
        )
    elif errors.names:
        remarks.append(
            f"what comes again with arm or laser is none of the difference: {', '.join(errors.names)}, as both "
            f"budgets state it; {'' if WAVELENGTH in errors.names else 'laser, '}air and set-up count as independent"
        )
    else:
        remarks.append(
            "both count as independent; what the two measurements share (laser, air sensor, reflector set-up) makes "
            "the combined standard uncertainties too large as a rule"
        )
    if first.model != second.model:
        remarks.append("the conventional model counts as the map Δθ1 = 0, Δθ2 = θ20 everywhere")
    # What the distances have shown of it is each measurement's own affair.
    stated = [
        [entry.model_dump(exclude={"spectrum"}) for entry in one.budget.contributor]
        for one in (first, second)
        if one.budget is not None
    ]
    if len(stated) == 2 and stated[0] != stated[1]:
        remarks.append("their uncertainties stand on different error budgets")
    if first.extension or second.extension:
        remarks.append("terms beyond the model are not compared")
    return remarks
