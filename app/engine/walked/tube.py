"""Tubes around the motions that an arm was walked through, which motions they cover, and how fast an arm is walked.

A pose lies in the tube of a walked motion when some pose of that motion is within 1 deg of it in every revolute axis
and within 5 mm in every prismatic one. A motion is covered when each of its poses lies in some tube: exactly, not by
samples. Where the arm cuts corners, so much less is left of the tube.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from catseye.app.errors import SafetyError
from catseye.calibration.kinematics.sweep import cut_corners
from catseye.drivers.roles.pose import Axes, Pose, Unit, pose_text
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.motion.body_speed import fastest_mm_s

Floats = NDArray[np.float64]

TUBE_DEG: Final = 1.0
TUBE_MM: Final = 5.0

_TOLERANCES: Final[dict[Unit, float]] = {"deg": TUBE_DEG, "mm": TUBE_MM}

_RADIUS: Final = 1.0 - 1e-9
"""Of a tube in units of its tolerances; what is missing outweighs every rounding below."""

_STILL: Final = 1e-9
"""A walked motion that moves a joint by less, in those units, is taken for one that does not move it."""

_FIRST_ROOM: Final = 64

FASTEST_MM_S: Final = 250.0
"""Of anything on the arm while it is walked."""

MOST_PERCENT: Final = 10.0
"""Override of a walk."""

_LEAST_PERCENT: Final = 1.0


@dataclass(frozen=True)
class Leg:
    """A straight joint motion.

    Attributes:
        start: where it begins.
        end: where it ends.
        cut: how far the arm may be beside it where it cuts the corners at its ends, deg or mm; empty
            where it cuts none.
    """

    start: Pose
    end: Pose
    cut: Pose = ()


def legs_through(start: Pose, way: Sequence[Pose], *, blended: bool) -> list[Leg]:
    """Return the straight motions of a way, at whose end the arm stands still.

    Args:
        blended: the arm passes the targets before the last one without standing still.
    """
    places = (start, *way)
    passed = np.array([0 < number < len(way) and blended for number in range(len(places))])
    cuts = cut_corners(np.array(places), passed).tolist()
    return [
        Leg(*ends, tuple(cut) if any(cut) else ()) for ends, cut in zip(pairwise(places), cuts, strict=True)
    ]


class Tubes:
    """The union of the tubes around walked motions.

    Args:
        legs: that were driven to their end.
    """

    def __init__(self, axes: Axes, legs: Iterable[Leg] = ()) -> None:
        self._tolerances = np.array([_TOLERANCES[axis.unit] for axis in axes])
        self._ends = np.empty((_FIRST_ROOM, 2, len(axes)))
        self._count = 0
        for leg in legs:
            self.add(leg)

    def __len__(self) -> int:
        """Return how many motions were walked."""
        return self._count

    def add(self, leg: Leg) -> None:
        """Add the tube of a motion."""
        if self._count == len(self._ends):
            self._ends = np.concatenate([self._ends, np.empty_like(self._ends)])
        self._ends[self._count] = self._scaled(leg)
        self._count += 1

    def covers(self, leg: Leg) -> bool:
        """Return whether every pose of a motion lies in some tube."""
        motion = self._scaled(leg)
        if not np.isfinite(motion).all():
            return False
        walked = self._ends[: self._count]
        near = (walked.min(axis=1) - 1.0 <= motion.max(axis=0)) & (
            walked.max(axis=1) + 1.0 >= motion.min(axis=0)
        )
        candidates = walked[near.all(axis=1)]
        cut = np.array(leg.cut) if leg.cut else np.zeros_like(self._tolerances)
        radius = _RADIUS - cut / self._tolerances
        return len(candidates) > 0 and _cover_all(*_inside(motion, candidates, radius))

    def _scaled(self, leg: Leg) -> Floats:
        """Return both ends of a motion in units of the tolerances, shape (2, axes)."""
        scaled: Floats = np.array([leg.start, leg.end], dtype=np.float64) / self._tolerances
        return scaled


def uncovered(axes: Axes, legs: Sequence[Leg], walked: Iterable[Leg]) -> list[Leg]:
    """Return the motions that leave the tubes of walked ones; a plan that repeats a motion repeats it here."""
    tubes = Tubes(axes, walked)
    # Plans drive the same motions again and again.
    outside = {leg for leg in dict.fromkeys(legs) if not tubes.covers(leg)}
    return [leg for leg in legs if leg in outside]


def to_walk(axes: Axes, legs: Sequence[Leg], walked: Iterable[Leg]) -> list[Leg]:
    """Return the motions to walk so that all are covered, those of them included that cover one another."""
    tubes, chosen = Tubes(axes, walked), []
    for leg in dict.fromkeys(legs):
        if not tubes.covers(leg):
            tubes.add(leg)
            chosen.append(leg)
    return chosen


def _inside(motion: Floats, walked: Floats, radius: Floats) -> tuple[Floats, Floats]:
    """Return from which to which share of a motion it lies in the tube of each walked one, shape (n,) each.

    At share t of the motion and share s of the walked one the joints differ by g + t u - s v. All of them lie within
    the radius, and s within 0 ... 1, for an interval of s whose lower and upper bounds are linear in t. There is such
    an s where no lower bound exceeds an upper one: linear inequalities in t alone (Fourier and Motzkin).

    Args:
        motion: its ends in units of the tolerances, shape (2, axes).
        walked: those of the walked ones, shape (n, 2, axes).
        radius: of the tubes in each axis, shape (axes,).
    """
    g, u = motion[0] - walked[:, 0], np.broadcast_to(motion[1] - motion[0], walked[:, 0].shape)
    v = walked[:, 1] - walked[:, 0]
    still = np.abs(v) < _STILL
    # Dividing by a joint that does not move means nothing; its strip is a bound on t alone.
    size = np.where(still, 1.0, np.abs(v))
    side = np.sign(v)
    slope, middle = side * u / size, side * g / size
    half = np.where(still, np.inf, radius / size)
    zeros, ones = np.zeros((len(walked), 1)), np.ones((len(walked), 1))
    lower = np.hstack([middle - half, zeros]), np.hstack([slope, zeros])
    upper = np.hstack([middle + half, ones]), np.hstack([slope, zeros])
    offset = (lower[0][:, :, None] - upper[0][:, None, :]).reshape(len(walked), -1)
    gradient = (lower[1][:, :, None] - upper[1][:, None, :]).reshape(len(walked), -1)
    strip = np.where(still, radius - _STILL, np.inf)
    offsets = np.hstack([offset, g - strip, -g - strip])
    gradients = np.hstack([gradient, u, -u])
    return _satisfied(offsets, gradients)


def _satisfied(offsets: Floats, gradients: Floats) -> tuple[Floats, Floats]:
    """Return the interval of t in 0 ... 1 where every offset + gradient t <= 0; an empty one ends first."""
    flat = gradients == 0.0
    impossible = (flat & (offsets > 0.0)).any(axis=1)
    with np.errstate(over="ignore"):
        edge = -offsets / np.where(flat, 1.0, gradients)
    first = np.where(~flat & (gradients < 0.0), edge, 0.0).max(axis=1, initial=0.0)
    last = np.where(~flat & (gradients > 0.0), edge, 1.0).min(axis=1, initial=1.0)
    return np.where(impossible, 1.0, first), np.where(impossible, 0.0, last)


def _cover_all(first: Floats, last: Floats) -> bool:
    """Return whether intervals together cover 0 ... 1."""
    reached = 0.0
    kept = last >= first
    order = np.argsort(first[kept])
    begins, ends = first[kept][order], last[kept][order]
    if not len(begins):
        return False
    # What is reached before an interval begins is the furthest end of those that begin earlier.
    reaches = np.concatenate([[reached], np.maximum.accumulate(ends)])
    gaps = np.flatnonzero(begins > reaches[:-1])
    return bool(reaches[-1 if not len(gaps) else gaps[0]] >= 1.0)


def walking_percent(bench: Bench, leg: Leg, cap_percent: float) -> float:
    """Return the highest whole override with which a motion is walked.

    Raises:
        SafetyError: the motion is too fast with the lowest override that controllers take.
    """
    most = min(MOST_PERCENT, cap_percent)
    at_one = fastest_mm_s(bench, leg.start, leg.end, _LEAST_PERCENT)
    percent = most if at_one * most <= FASTEST_MM_S else float(math.floor(FASTEST_MM_S / at_one))
    if percent < _LEAST_PERCENT:
        raise SafetyError(
            f"the motion to {pose_text(bench.arm.axes, leg.end)} moves the outermost body at up to {at_one:.0f} mm/s "
            f"with an override of {_LEAST_PERCENT:g} %, and a walk at {FASTEST_MM_S:g} mm/s at most: it cannot be "
            "walked, no override is lower; check [robot] speed_deg_s and the bodies, or drive it by hand"
        )
    return percent
