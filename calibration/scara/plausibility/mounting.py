"""How the interferometer was turned on J4's flange, where the table does not state it, or states another angle.

Odd orders of what J4 does change sign in the distance when the interferometer is turned by half a turn. A wrong angle
therefore makes distances unlikely that the right one explains. Angles are compared by the evidence that the distances
give for each, the sizes of J4's harmonics averaged over what the budget allows. Of distances whose angle is as stated
the ratio of evidences has a mean of 1 for each other angle, so that it exceeds many times the number of angles tried
in one of as many tables at most (Markov's inequality).
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from catseye.calibration.core.amplitudes import Compressed, log_evidence
from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.distance_model import distance_model
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.plausibility.findings import (
    MountingForgotten,
    MountingInRadians,
    MountingOff,
)
from catseye.calibration.scara.points import Points

FALSE_ALARM: Final = 1e-3
"""Largest probability with which a table that states its mountings is accused of stating others."""

_STEP: Final = math.radians(10.0)
"""Angles are tried in steps of so much; one that is off by half of it costs little."""

_TRIED: Final = 36
"""Angles that are tried, with the stated one read as radians."""

_MOST_ROWS: Final = 4000

_SEED: Final = 1

MountingMistake = MountingForgotten | MountingInRadians | MountingOff


def mounting_mistake(problem: Problem, found: Identification) -> MountingMistake | None:
    """Return what the table should state of the interferometer's mounting; None where nothing speaks against it.

    Args:
        problem: that the identification solves.
    """
    if not _shows_j4(problem):
        return None
    try:
        mountings = _Mountings.of(problem, found)
        return None if mountings is None else mountings.mistake()
    except CalibrationError:
        return None


@dataclass(frozen=True)
class _Mountings:
    """Distances of two mountings, or of what may be two.

    Attributes:
        found: what was identified, no function of J4 among its terms.
        problem: that it solves.
        later: distances of another mounting than the first one's, or those that may be, shape (n,).
    """

    found: Identification
    problem: Problem
    later: Bools

    @classmethod
    def of(cls, problem: Problem, found: Identification) -> "_Mountings | None":
        later = _other_mounting(found.points)
        if later is None:
            return None
        if any(term.source == "theta4" for term in problem.terms):
            plain = replace(problem, terms=tuple(term for term in problem.terms if term.source != "theta4"))
            return cls(plain.solve(), plain, later)
        return cls(found, problem, later)

    def mistake(self) -> MountingMistake | None:
        """Return what the distances make likelier than what is stated, beyond doubt."""
        points = self.found.points
        row = int(np.argmax(self.later))
        where = points.dead_paths[int(points.dead_path[row])]
        number = row if self.found.rows is None else int(self.found.rows[row])
        as_stated = self._evidence(0.0)
        if points.mount_rad is None or not points.mount_rad.any():
            turned = self._evidence(math.pi) - as_stated > -math.log(FALSE_ALARM)
            return MountingForgotten(*where, number) if turned else None
        stated = float(points.mount_rad[row])
        turn, evidence = self._likeliest(stated, as_stated)
        if evidence - as_stated <= math.log(_TRIED / FALSE_ALARM):
            return None
        in_radians = _reread(stated)
        if in_radians is not None and abs(_wrapped(in_radians - stated - turn)) < 1.5 * _STEP:
            return MountingInRadians(*where, number, in_radians)
        return MountingOff(*where, number, stated, stated + turn)

    def _likeliest(self, stated: float, as_stated: float) -> tuple[float, float]:
        """Return by how much more than stated the distances suggest it was turned, rad, and their evidence for it."""
        in_radians = _reread(stated)
        turns = [_STEP * k for k in range(-17, 19) if k] + (
            [] if in_radians is None else [in_radians - stated]
        )
        evidence, turn = max((as_stated, 0.0), *((self._evidence(turn), turn) for turn in turns))
        return _wrapped(turn), evidence

    @cached_property
    def _meanwhile(self) -> Floats:
        """What links and distances do that grow from the first mounting to the others, and steadily, of asked rows.

        Shape (rows, 6).
        """
        points = self.found.points
        grown = np.column_stack(
            [self.found.model.jacobian(self.found.parameters)[:, :2], points.displacement_mm]
        )
        return np.hstack([grown * self.later[:, None], grown * points.elapsed_share[:, None]])[self._asked]

    @cached_property
    def _asked(self) -> Ints:
        """Rows that are asked: further ones cost time."""
        size = self.later.size
        # At random: every k-th row may be one and the same node of a grid.
        return np.sort(np.random.default_rng(_SEED).choice(size, min(size, _MOST_ROWS), replace=False))

    def _evidence(self, turn_rad: float) -> float:
        """Return the logarithm of how likely the distances are if the later ones were turned further."""
        points, found = self.found.points, self.found
        mount = np.zeros(len(points)) if points.mount_rad is None else points.mount_rad
        turned = replace(points, theta4_rad=None, mount_rad=mount + turn_rad * self.later)
        model = distance_model(found.layout, turned.rows(self._asked), self.problem.asked)
        shared = model.shared(found.parameters)
        rows = Compressed.of(model, found.parameters, shared, self._meanwhile)
        # Errors beyond the stated ones make no angle more certain.
        widened = math.sqrt(max(found.fit.chi2_reduced or 1.0, 1.0))
        return log_evidence(replace(rows, vector=rows.vector / widened))


def _reread(stated_rad: float) -> float | None:
    """Return a stated angle if its number was in rad; None where it is 0 or too large for that."""
    number = math.degrees(stated_rad)
    return number if 0.0 < abs(number) <= 2.0 * math.pi else None


def _wrapped(angle_rad: float) -> float:
    return math.remainder(angle_rad, 2.0 * math.pi)


def _shows_j4(problem: Problem) -> bool:
    return problem.model == "error-map" and problem.budget is not None and problem.budget.follows_j4


def _other_mounting(points: Points) -> Bools | None:
    """Return the rows of another mounting than the first one's; where none is stated, those of a second pass."""
    mount = points.mount_rad
    if mount is not None and mount.any():
        other = mount != mount[0]
        return other if other.any() else None
    row = _second_pass(points)
    return None if row is None else np.arange(len(points)) >= row


def _second_pass(points: Points) -> int | None:
    """Return the row, next to the middle, where a new segment measures what was measured before."""
    again = replace(points, dead_path=0 * points.dead_path).repeats(bidirectional=False)
    firsts = np.unique(again, return_index=True)[1][again]
    starts = np.unique(points.dead_path, return_index=True)[1]
    possible = [int(row) for row in starts if firsts[row] < row]
    return min(possible, key=lambda row: abs(2 * row - len(points)), default=None)
