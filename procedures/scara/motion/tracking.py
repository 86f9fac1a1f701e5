"""Open-loop tracking: moves split so that the beam stays on the reflector between the points too."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.pointing import beam_direction, unwrap, visible
from catseye.procedures.kit.errors import PlanError, PlanLimitError
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.motion.approach import Waypoint

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]

_SIGHT_SAMPLES = 64
"""Samples of a leg for the line of sight: at most 0.35° apart on a 20° leg, well below the column's margin."""

_MISS_SAMPLES = 16
"""Samples of a sub-step for the beam's miss, which is a smooth bow between its zeros at the ends."""

_MOST_SUB_STEPS = 128

_STREAMED_MISS_MM = 0.005
"""Streamed set points carry the aim of every cycle, so their targets are so dense that lines between them will do."""


@dataclass(frozen=True)
class Legs:
    """Straight joint moves between stops, one a row, in rad.

    Attributes:
        start_rad: J1 and J2 at the start, shape (m, 2).
        end_rad: J1 and J2 at the end, shape (m, 2).
    """

    start_rad: Floats
    end_rad: Floats

    def at(self, share: Floats) -> Floats:
        """Return J1 and J2 at shares 0...1 of every leg, rad, shape (m, shares, 2)."""
        return self.start_rad[:, None, :] + share[None, :, None] * (self.end_rad - self.start_rad)[:, None, :]

    def select(self, rows: Bools | Ints) -> "Legs":
        """Return the chosen legs."""
        return Legs(self.start_rad[rows], self.end_rad[rows])


@dataclass(frozen=True)
class Track:
    """How the legs between stops are driven for one reflector.

    Attributes:
        stop_seen: the reflector can be seen from the stop, shape (stops,).
        leg_seen: the reflector can be seen all along the leg that ends at the stop, shape (stops,); False first.
        sub_steps: equal parts of that leg, shape (stops,); 1 where the beam is not kept.
        j4_rad: J4 at the stop, on its branch, shape (stops,).
        rewound: J4 changes its branch on the leg that ends at the stop, shape (stops,).
        miss_mm: largest miss along that leg, shape (stops,); NaN where the beam is not kept.
        beam_mm: length of the beam at the stop, shape (stops,).
    """

    stop_seen: Bools
    leg_seen: Bools
    sub_steps: Ints
    j4_rad: Floats
    rewound: Bools
    miss_mm: Floats
    beam_mm: Floats


def plan_track(
    stops: tuple[Waypoint, ...], bench: ScaraBench, reflector: Reflector, subdivide: bool
) -> Track:
    """Plan how the beam follows a reflector over the stops.

    Args:
        subdivide: split legs to keep the miss within the plan's limit; False states the miss of whole legs.

    Raises:
        PlanError: a leg cannot be split finely enough; the reflector is too near.
        PlanLimitError: J4 has no branch inside its limits.
    """
    theta = np.deg2rad([[stop.theta1_deg, stop.theta2_deg] for stop in stops])
    legs = Legs(theta[:-1], theta[1:])
    stop_seen = _seen(theta, bench, reflector)
    leg_seen = np.all(_seen(legs.at(np.linspace(0.0, 1.0, _SIGHT_SAMPLES + 1)), bench, reflector), axis=1)
    j4, rewound = _branches(_continuous_j4(theta, legs, bench, reflector), bench)
    kept = leg_seen & ~rewound[1:]
    if subdivide:
        sub_steps, miss = _subdivide(legs, kept, bench, reflector)
    else:
        sub_steps = np.ones(kept.size, dtype=np.int64)
        miss = np.where(kept, leg_miss_mm(legs, 1, bench, reflector), np.nan)
    positions = _positions(theta, bench)
    return Track(
        stop_seen=stop_seen,
        leg_seen=np.append(False, kept),
        sub_steps=np.append(1, sub_steps),
        j4_rad=j4,
        rewound=rewound,
        miss_mm=np.append(np.nan, miss),
        beam_mm=np.hypot(*(reflector.xy_mm - positions).T),
    )


def aimed_j4(theta_rad: Floats, bench: ScaraBench, reflector: Reflector) -> Floats:
    """Return the J4 angles that aim at a reflector, rad, on no particular branch, shape (...).

    Args:
        theta_rad: J1 and J2, rad, shape (..., 2).
    """
    world = beam_direction(_positions(theta_rad, bench), reflector.xy_mm)
    j4 = world - theta_rad[..., 0] - theta_rad[..., 1] - np.deg2rad(bench.optics.theta40_deg)
    return np.asarray(j4, dtype=np.float64)


def aimed_along(theta_rad: Floats, j4_last_rad: float, bench: ScaraBench, reflector: Reflector) -> Floats:
    """Return the J4 angles that aim along a way that ends on a known branch, rad, shape (n,).

    Args:
        theta_rad: J1 and J2 along the way, rad, shape (n, 2).
        j4_last_rad: J4 at the last row, on its branch, rad.
    """
    j4 = unwrap(aimed_j4(theta_rad, bench, reflector))
    return np.asarray(j4 + (j4_last_rad - j4[-1]), dtype=np.float64)


def leg_miss_mm(legs: Legs, parts: int, bench: ScaraBench, reflector: Reflector) -> Floats:
    """Return the largest miss on each leg when it is driven in equal parts, mm, shape (m,).

    J1, J2 and J4 are interpolated linearly over each part; the beam is exactly aimed at the ends of the parts.

    Args:
        legs: m legs.
        parts: equal parts of each.
    """
    share = np.linspace(0.0, 1.0, parts * _MISS_SAMPLES + 1)
    positions = _positions(legs.at(share), bench)
    world = unwrap(beam_direction(positions, reflector.xy_mm))
    ends = world[:, ::_MISS_SAMPLES]
    within = np.tile(np.arange(_MISS_SAMPLES) / _MISS_SAMPLES, parts)
    part = np.repeat(np.arange(parts), _MISS_SAMPLES)
    straight = ends[:, part] + within * (ends[:, part + 1] - ends[:, part])
    beam = reflector.xy_mm - positions[:, :-1]
    length = np.hypot(beam[..., 0], beam[..., 1])
    off = np.abs(straight - world[:, :-1])
    return np.asarray(np.where(off < np.pi / 2, length * np.sin(off), np.inf).max(axis=1), dtype=np.float64)


def _positions(theta_rad: Floats, bench: ScaraBench) -> Floats:
    return forward(theta_rad[..., 0], theta_rad[..., 1], bench.link1_mm, bench.link2_mm)


def _seen(theta_rad: Floats, bench: ScaraBench, reflector: Reflector) -> Bools:
    optics = bench.optics
    return visible(
        _positions(theta_rad, bench),
        reflector.xy_mm,
        float(np.deg2rad(reflector.facing_deg)),
        optics.column_radius_mm + optics.column_margin_mm,
        float(np.deg2rad(optics.field_half_angle_deg)),
        (optics.beam_min_mm, optics.beam_max_mm),
    )


@dataclass(frozen=True)
class _Turning:
    """J4 as it turns along the whole way without jumping, rad, each of shape (stops,).

    Attributes:
        at_stop: at the stop.
        lowest: smallest on the leg that ends at the stop.
        highest: largest on the leg that ends at the stop.
    """

    at_stop: Floats
    lowest: Floats
    highest: Floats


def _continuous_j4(theta: Floats, legs: Legs, bench: ScaraBench, reflector: Reflector) -> _Turning:
    along = legs.at(np.linspace(0.0, 1.0, _SIGHT_SAMPLES + 1)[:-1]).reshape(-1, 2)
    turning = unwrap(aimed_j4(np.vstack([along, theta[-1:]]), bench, reflector))
    at_stop = turning[::_SIGHT_SAMPLES]
    on_leg = np.column_stack([turning[:-1].reshape(-1, _SIGHT_SAMPLES), at_stop[1:]])
    return _Turning(
        at_stop, np.append(at_stop[0], on_leg.min(axis=1)), np.append(at_stop[0], on_leg.max(axis=1))
    )


def _branches(turning: _Turning, bench: ScaraBench) -> tuple[Floats, Bools]:
    """Bring J4 inside its limits, changing the branch as seldom as possible.

    Returns:
        J4 at the stops, rad, and flags of the stops before which J4 rewinds by whole turns.
    """
    low, high = np.deg2rad(bench.j4_limits_deg)
    j4 = turning.at_stop
    placed, rewound = np.empty_like(j4), np.zeros(j4.size, dtype=np.bool_)
    start = 0
    while start < j4.size:
        # The leg to the first stop of a branch is a rewind, or the free approach to the first stop of all.
        lowest, highest = turning.lowest[start:].copy(), turning.highest[start:].copy()
        lowest[0] = highest[0] = j4[start]
        end, shift = _longest_branch(lowest, highest, low, high)
        if end == 0:
            raise PlanLimitError(
                f"J4 = {np.rad2deg(j4[start]):.1f}° plus any whole turn is outside its limits "
                f"{np.rad2deg(low):g}°…{np.rad2deg(high):g}°: widen [robot.limits_deg] j4 or move the reflector"
            )
        placed[start : start + end] = j4[start : start + end] + shift
        rewound[start] = start > 0
        start += end
    return placed, rewound


def _longest_branch(lowest: Floats, highest: Floats, low: float, high: float) -> tuple[int, float]:
    """Return how many stops the best branch serves and its shift; of equals, the one with the widest margin."""
    turns = np.arange(
        np.floor((low - lowest[0]) / (2 * np.pi)), np.ceil((high - lowest[0]) / (2 * np.pi)) + 1
    )
    best, best_margin, best_shift = 0, -np.inf, 0.0
    for shift in 2.0 * np.pi * turns:
        inside = (lowest + shift >= low) & (highest + shift <= high)
        served = int(np.argmin(inside)) if not inside.all() else int(inside.size)
        if served == 0:
            continue
        margin = float(min((lowest[:served] + shift).min() - low, high - (highest[:served] + shift).max()))
        if (served, margin) > (best, best_margin):
            best, best_margin, best_shift = served, margin, float(shift)
    return best, best_shift


def _miss_limit_mm(bench: ScaraBench) -> float:
    """Return how far the straight parts of a leg may miss the reflector, mm."""
    limit_mm = bench.optics.max_miss_mm
    match bench.arm.following:
        case "stops":
            return limit_mm
        case "blended":
            # A controller rounds the corners inwards, at most by as much again as the parts bow outwards.
            return 0.5 * limit_mm
        case "streamed":
            return min(limit_mm, _STREAMED_MISS_MM)


def _subdivide(legs: Legs, kept: Bools, bench: ScaraBench, reflector: Reflector) -> tuple[Ints, Floats]:
    """Return the fewest equal parts that keep the miss of each kept leg within the plan's limit, and that miss."""
    limit_mm = _miss_limit_mm(bench)
    parts = np.ones(kept.size, dtype=np.int64)
    miss = np.full(kept.size, np.nan)
    open_legs = np.flatnonzero(kept)
    for count in range(1, _MOST_SUB_STEPS + 1):
        if not open_legs.size:
            return parts, miss
        trial = leg_miss_mm(legs.select(open_legs), count, bench, reflector)
        good = trial <= limit_mm
        parts[open_legs[good]] = count
        miss[open_legs[good]] = trial[good]
        open_legs = open_legs[~good]
    raise PlanError(
        f"the beam to reflector {reflector.name} cannot be kept within {limit_mm:g} mm even in "
        f"{_MOST_SUB_STEPS} sub-steps: the reflector is too near to the arm's way; move it or raise max_miss_mm"
    )
