"""Leaving out distances that cannot belong to the others, one reason each, and never too many."""

from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.arguments import require_positive, require_share
from catseye.calibration.core.errors import RejectionError
from catseye.calibration.core.residuals import robustly_studentised
from catseye.calibration.core.types import Bools, Ints
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.diagnostics.projection import DistanceProjection, projection_of
from catseye.calibration.scara.diagnostics.robust import robust_fit
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.points import Points, rows_of_long_segments

MOST_REJECTED = 0.05
"""Largest share of the distances that may go; beyond it the model is in doubt, not the distances."""

_ROUNDS = 50


@dataclass(frozen=True)
class Rejected:
    """One distance that was left out.

    Attributes:
        row: number of the distance among those given, from 1.
        reflector: name of its reflector.
        segment: its segment.
        theta1_deg: J1 command, °.
        theta2_deg: J2 command, °.
        direction1: state of approach of J1.
        direction2: state of approach of J2.
        residual_um: predicted without it minus measured, µm.
        studentised: that in robust standard deviations.
    """

    row: int
    reflector: str
    segment: int
    theta1_deg: float
    theta2_deg: float
    direction1: int
    direction2: int
    residual_um: float
    studentised: float

    def sentence(self, limit: float) -> str:
        """Return which distance it is and why it went."""
        signs = "".join("+" if one > 0 else "−" for one in (self.direction1, self.direction2))
        return (
            f"row {self.row}, reflector {self.reflector}, segment {self.segment}, θ1 {self.theta1_deg:g}°, "
            f"θ2 {self.theta2_deg:g}°, approach {signs}: misses the prediction of the others by "
            f"{-self.residual_um:+.1f} µm, {abs(self.studentised):.1f} robust standard deviations (limit {limit:g})"
        )


@dataclass(frozen=True)
class Cleaned:
    """An identification without the distances that were left out.

    Attributes:
        identified: from the others; `rejected` lists each one.
        rejected: what was left out, in measuring order.
    """

    identified: Identification
    rejected: tuple[Rejected, ...]


def reject(problem: Problem, limit: float, most: float = MOST_REJECTED) -> Cleaned:
    """Leave out distances beyond a limit, the farthest first, until none is left.

    A distance is judged by its externally studentised residual: what the others predict of it minus what was
    measured, over the standard deviation of that. The first round judges the residuals of a Huber fit, so that a
    gross error does not lean on its neighbours. A round leaves out only what exceeds half of the largest.

    Args:
        limit: in robust standard deviations.
        most: largest share of the distances that may go.

    Raises:
        RejectionError: more would have to go; the model or the measurement is in doubt.
        CalibrationError: as `identify` does.
        ArgumentError: the limit is not positive, or the share lies outside of 0...1.
    """
    require_positive(limit, "limit")
    require_share(most, "most")
    kept = np.flatnonzero(rows_of_long_segments(problem.points))
    gone: dict[int, Rejected] = {}
    total = kept.size
    identified = problem.of_rows(kept).solve()
    # Outliers hardly bend a Huber fit: there the residual itself is what the others predict.
    judged, leans = robust_fit(identified, "huber").identified, False
    for _ in range(_ROUNDS):
        projection = projection_of(judged)
        deleted = robustly_studentised(projection)
        size = np.abs(np.nan_to_num(deleted))
        far = size > max(limit, 0.5 * float(size.max()))
        if not far.any():
            return _cleaned(replace(identified, rows=kept), gone, limit)
        for i in np.flatnonzero(far).tolist():
            row = int(kept[i])
            gone[row] = _of_row(projection, row, i, float(deleted[i]), leans)
        _require_few(len(gone), int(most * total), total, limit)
        kept = _without(problem.points, kept[~far])
        identified = problem.of_rows(kept).solve()
        judged, leans = identified, True
    raise RejectionError(
        f"after {_ROUNDS} rounds there are still distances beyond {limit:g}: raise the limit"
    )


def _of_row(projection: DistanceProjection, row: int, i: int, studentised: float, leans: bool) -> Rejected:
    points, commands = projection.points, projection.points.commands
    # At parameters that do not lean on the row, only what it shares with the others is left to be predicted by them.
    shares = projection.reach[i] if leans else projection.whitening.reach[i]
    own = 1.0 - float(shares @ shares)
    name, segment = points.dead_paths[int(points.dead_path[i])]
    return Rejected(
        row=row + 1,
        reflector=name,
        segment=segment,
        theta1_deg=round(float(np.rad2deg(commands.theta1_rad[i])), 6),
        theta2_deg=round(float(np.rad2deg(commands.theta2_rad[i])), 6),
        direction1=int(commands.direction1[i]),
        direction2=int(commands.direction2[i]),
        residual_um=1e3 * float(projection.pulls[i] / projection.weights[i]) / own,
        studentised=studentised,
    )


def _without(points: Points, kept: Ints) -> Ints:
    """Return the rows that keep a segment of their own."""
    long: Bools = rows_of_long_segments(points.select(kept))
    return kept[long]


def _require_few(gone: int, allowed: int, total: int, limit: float) -> None:
    if gone <= allowed:
        return
    raise RejectionError(
        f"{gone} of {total} distances lie beyond {limit:g} robust standard deviations, more than the "
        f"{allowed} that may be left out: the model is in doubt, not the points. Run catseye diagnose (richer model, "
        "drift, a jump of the counter, a moved reflector), or raise the limit"
    )


def _cleaned(identified: Identification, gone: dict[int, Rejected], limit: float) -> Cleaned:
    rejected = tuple(gone[row] for row in sorted(gone))
    sentences = [one.sentence(limit) for one in rejected]
    return Cleaned(replace(identified, rejected=[*identified.rejected, *sentences]), rejected)
