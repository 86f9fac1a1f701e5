"""What changes with time: drifts and jumps of the distances within a segment, in measuring order.

A drift of one segment bends the maps and so leaves traces in the others. The clearest change is therefore taken into
the model before the next one is looked for, until none is significant.
"""

from dataclasses import dataclass

import numpy as np
from scipy import special

from catseye.calibration.core.projection import addition
from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.diagnostics.projection import DistanceProjection

_FEWEST = 8
"""Distances that a segment needs before its drift is judged."""

_LEFT = 1e-6
"""A step of which the model leaves less than this share of its square cannot be separated from a dead path."""

_MOST_CHANGES = 12
"""More significant changes than this are no list of events but a wrong model."""


@dataclass(frozen=True)
class Change:
    """A drift or a jump of the measured distance within a segment.

    Attributes:
        kind: "drift" (steady from the first to the last distance) or "jump" (a step, as a slip of the counter makes).
        reflector: name.
        segment: its number.
        row: the first distance after a jump, or the first of the segment; from 1, among those that were fitted.
        within: its place in the segment, from 1.
        rows: distances of the segment.
        size_um: growth of the measured distance, µm: from the first to the last, or at the step.
        u_um: its standard uncertainty, stated contributors included.
        probability: of a change this clear when there is none, stated contributors included, corrected for the
            number of segments or places looked at.
    """

    kind: str
    reflector: str
    segment: int
    row: int
    within: int
    rows: int
    size_um: float
    u_um: float
    probability: float

    @property
    def significant(self) -> bool:
        """Neither white errors nor stated contributors explain it."""
        return self.probability < SIGNIFICANCE


@dataclass(frozen=True)
class _Candidate:
    change: Change
    column: Floats

    @property
    def clearness(self) -> float:
        return abs(self.change.size_um) / self.change.u_um


def changes(projection: DistanceProjection) -> list[Change]:
    """Return what changed with time, the significant changes first, then the drift of each other segment.

    A segment that is too short, or one whose drift the model takes up, is left out.
    """
    found: list[_Candidate] = []
    while len(found) < _MOST_CHANGES:
        rest = _candidates(_beside(projection, found))
        best = max(rest, key=lambda one: one.clearness, default=None)
        if best is None or not best.change.significant:
            break
        found.append(best)
    done = {(one.change.reflector, one.change.segment) for one in found}
    calm = [one.change for one in _candidates(_beside(projection, found)) if one.change.kind == "drift"]
    return [
        *sorted((one.change for one in found), key=lambda one: one.probability),
        *(one for one in calm if (one.reflector, one.segment) not in done),
    ]


def _beside(projection: DistanceProjection, found: list[_Candidate]) -> DistanceProjection:
    return projection.extended(np.column_stack([one.column for one in found])) if found else projection


def _candidates(projection: DistanceProjection) -> list[_Candidate]:
    """Return the drift and the likeliest jump of each segment."""
    if projection.square <= 0.0:
        return []
    points = projection.points
    members = [points.dead_path == i for i in range(len(points.dead_paths))]
    places = sum(max(int(member.sum()) - 1, 0) for member in members)
    long = [member for member in members if int(member.sum()) >= _FEWEST]
    found = [_drift(projection, member, len(long)) for member in long]
    found += [_jump(projection, member, places) for member in long]
    return [one for one in found if one is not None]


def _drift(projection: DistanceProjection, member: Bools, tests: int) -> _Candidate | None:
    points, rows = projection.points, np.flatnonzero(member)
    passed = points.elapsed_share[rows]
    if np.ptp(passed) == 0.0:
        return None
    share = np.zeros(member.size)
    share[rows] = (passed - passed.min()) / np.ptp(passed) - 0.5
    found = addition(projection, share[:, None])
    if found is None:
        return None
    size, u = float(found.coefficients[0]), float(np.sqrt(found.covariance[0, 0]))
    return _Candidate(_change("drift", projection, rows, 0, (size, u), tests), share)


def _jump(projection: DistanceProjection, member: Bools, places: int) -> _Candidate | None:
    """Return the likeliest step of a segment.

    All places are looked at in one pass: sums over the rows after the step give its coefficient and what model and
    stated contributors leave of it.
    """
    rows = np.flatnonzero(member)
    weights = projection.weights[rows]
    along = _after(weights * projection.pulls[rows])
    shadow = _after(weights[:, None] * projection.reach[rows])
    whole = _after(weights**2)
    left = whole - np.einsum("ij,ij->i", shadow, shadow)
    seen = left > _LEFT * whole
    if not seen.any():
        return None
    place = int(np.argmax(np.where(seen, along**2 / np.where(seen, left, 1.0), 0.0)))
    # What the step itself takes off the sum of squares is no scatter.
    rest = max(projection.square - along[place] ** 2 / left[place], 0.0)
    u = float(np.sqrt(rest / (projection.dof - 1) / left[place]))
    step = np.zeros(member.size)
    step[rows[place + 1 :]] = 1.0
    size = -float(along[place] / left[place])
    return _Candidate(_change("jump", projection, rows, place + 1, (size, u), places), step)


def _change(
    kind: str,
    projection: DistanceProjection,
    rows: Ints,
    first: int,
    estimate_mm: tuple[float, float],
    tests: int,
) -> Change:
    size, u = estimate_mm
    name, segment = projection.points.dead_paths[int(projection.points.dead_path[rows[0]])]
    once = 2.0 * float(special.stdtr(projection.dof - 1, -abs(size) / u)) if u > 0.0 else 1.0
    return Change(
        kind=kind,
        reflector=name,
        segment=segment,
        row=int(rows[first]) + 1,
        within=first + 1,
        rows=int(rows.size),
        size_um=1e3 * size,
        u_um=max(1e3 * u, 1e-12),
        probability=min(1.0, tests * once),
    )


def _after(values: Floats) -> Floats:
    """Return the sums over all rows after each row but the last, shape (rows − 1, …)."""
    return np.asarray(np.cumsum(values[::-1], axis=0)[::-1][1:], dtype=np.float64)
