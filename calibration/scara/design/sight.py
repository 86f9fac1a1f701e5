"""What a reflector at a place sees of the measurement: commands, breaks of the beam, wind-up of J4."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from catseye.calibration.core.arguments import (
    require_below,
    require_finite,
    require_not_negative,
    require_positive,
    require_range,
    require_shape,
)
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.pointing import beam_direction, column_clearance, unwrap, visible

Reason = Literal[
    "",
    "inside the keep-out radius",
    "in the arm's way",
    "seen from too few commands",
    "J4 winds up",
    "beam breaks too often",
]
"""Why no reflector may stand at a place; empty when one may."""

_FEWEST_IN_SEGMENT = 3
"""A segment with fewer distances is dropped by the identification, so it brings nothing."""


@dataclass(frozen=True)
class Way:
    """The way of the arm through a measurement.

    Attributes:
        theta_rad: J1 and J2 along the way, dense enough to see breaks of the beam, rad, shape (s, 2).
        xy_mm: position of the J4 axis there, mm, shape (s, 2).
        command: sample at which each command is measured, shape (n,).
    """

    theta_rad: Floats
    xy_mm: Floats
    command: Ints

    def __post_init__(self) -> None:
        for name in ("theta_rad", "xy_mm"):
            require_shape(getattr(self, name), (len(self.theta_rad), 2), name)
            require_finite(getattr(self, name), name)
        require_below(self.command, len(self.theta_rad), "command")


@dataclass(frozen=True)
class Rules:
    """What a place has to meet.

    Attributes:
        column_radius_mm: radius about the J1 axis that the beam has to stay out of.
        field_half_angle_rad: half angle of the reflector's field.
        beam_range_mm: shortest and longest beam.
        j4_limits_rad: smallest and largest J4, cables included.
        theta40_rad: direction of the beam at J4 = 0 on the straight arm.
        keep_out_mm: radius about the J1 axis inside which no reflector stands.
        apart_mm: smallest distance between two reflectors.
        fewest_seen: smallest share of the commands that has to see a reflector.
        most_breaks: how often the beam to a reflector may be given up.
    """

    column_radius_mm: float
    field_half_angle_rad: float
    beam_range_mm: tuple[float, float]
    j4_limits_rad: tuple[float, float]
    theta40_rad: float
    keep_out_mm: float
    apart_mm: float
    fewest_seen: float
    most_breaks: int

    def __post_init__(self) -> None:
        for name in ("column_radius_mm", "keep_out_mm", "apart_mm", "fewest_seen", "most_breaks"):
            require_not_negative(getattr(self, name), name)
        require_positive(self.field_half_angle_rad, "field_half_angle_rad")
        require_range(self.beam_range_mm, "beam_range_mm")
        require_range(self.j4_limits_rad, "j4_limits_rad")


@dataclass(frozen=True)
class Sight:
    """How a measurement sees a reflector.

    Attributes:
        xy_mm: place, mm, shape (2,).
        facing_rad: direction of its axis in which it sees most.
        seen: commands that bring a distance, shape (n,).
        segment: unbroken stretch of the beam of each command, from 0, shape (n,); -1 where it brings none.
        breaks: how often the beam is given up, also to begin a stretch too short to be of use.
        reason: why no reflector may stand there.
    """

    xy_mm: Floats
    facing_rad: float
    seen: Bools
    segment: Ints
    breaks: int
    reason: Reason

    @property
    def segments(self) -> int:
        """How many dead paths there are."""
        return int(self.segment.max(initial=-1)) + 1


def sight_of(xy_mm: Floats, way: Way, rules: Rules, facing_rad: float | None = None) -> Sight:
    """Look at a measurement from a place.

    Args:
        xy_mm: place, mm, shape (2,).
        facing_rad: direction of the reflector's axis; None for the one in which it sees most.

    Raises:
        ArgumentError: the place is not a pair of finite numbers.
    """
    require_shape(xy_mm, (2,), "xy_mm")
    require_finite(xy_mm, "xy_mm")
    facing = _facing(xy_mm, way, rules) if facing_rad is None else facing_rad
    along = visible(
        way.xy_mm, xy_mm, facing, rules.column_radius_mm, rules.field_half_angle_rad, rules.beam_range_mm
    )
    segment, breaks = _segments(along, way.command)
    seen = segment >= 0
    return Sight(xy_mm, facing, seen, segment, breaks, _reason(xy_mm, seen, breaks, way, rules))


def best_facing(directions_rad: Floats, half_angle_rad: float) -> float:
    """Return the direction about which a field of a half angle holds most directions.

    Args:
        directions_rad: where the beam comes from, rad, shape (m,).
    """
    sorted_rad = np.sort(np.mod(directions_rad, 2.0 * np.pi))
    twice = np.concatenate([sorted_rad, sorted_rad + 2.0 * np.pi])
    ends = np.searchsorted(twice, sorted_rad + 2.0 * half_angle_rad, side="right")
    count = np.minimum(ends - np.arange(sorted_rad.size), sorted_rad.size)
    first = int(np.argmax(count))
    middle = 0.5 * (twice[first] + twice[first + count[first] - 1])
    return float(np.mod(middle, 2.0 * np.pi))


def _facing(xy_mm: Floats, way: Way, rules: Rules) -> float:
    length = np.hypot(*(way.xy_mm - xy_mm).T)
    free = (column_clearance(way.xy_mm, xy_mm) > rules.column_radius_mm) & (
        length <= max(rules.beam_range_mm)
    )
    towards = beam_direction(way.xy_mm, xy_mm)[free] + np.pi
    if not towards.size:
        return float(np.arctan2(-xy_mm[1], -xy_mm[0]))
    return best_facing(towards, rules.field_half_angle_rad)


def _segments(along: Bools, command: Ints) -> tuple[Ints, int]:
    """Return the unbroken stretch that each command belongs to, -1 where it brings nothing, and the breaks."""
    blind_before = np.cumsum(~along)[command]
    seen = along[command]
    # Commands with as many blind samples before them are joined by an unbroken beam.
    _, stretch = np.unique(blind_before[seen], return_inverse=True)
    long_enough = np.bincount(stretch, minlength=1) >= _FEWEST_IN_SEGMENT
    segment = np.full(command.size, -1, dtype=np.int64)
    number = np.cumsum(long_enough) - 1
    segment[seen] = np.where(long_enough[stretch], number[stretch], -1)
    return segment, max(0, int(np.unique(stretch).size) - 1)


def _reason(xy_mm: Floats, seen: Bools, breaks: int, way: Way, rules: Rules) -> Reason:
    if np.hypot(*xy_mm) < rules.keep_out_mm:
        return "inside the keep-out radius"
    if np.hypot(*(way.xy_mm - xy_mm).T).min() < rules.beam_range_mm[0]:
        return "in the arm's way"
    if seen.mean() < rules.fewest_seen:
        return "seen from too few commands"
    if breaks > rules.most_breaks:
        return "beam breaks too often"
    return "J4 winds up" if _winds_up(xy_mm, way, rules) else ""


def _winds_up(xy_mm: Floats, way: Way, rules: Rules) -> bool:
    """Return whether J4, turning without a jump along the way, leaves its limits on every branch."""
    world = beam_direction(way.xy_mm, xy_mm)
    j4 = unwrap(world - way.theta_rad.sum(axis=1) - rules.theta40_rad)
    low, high = rules.j4_limits_rad
    turns = np.ceil((low - j4.min()) / (2.0 * np.pi))
    return bool(j4.max() + 2.0 * np.pi * turns > high)
