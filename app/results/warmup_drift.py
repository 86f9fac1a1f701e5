"""Verdict and picture of a warm-up: how far the measured place or distance has moved, its drift and the limit."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from catseye.app.results.figures import Axis, Figure, Level, Panel, Points, Role
from catseye.app.results.model import Sign, Statement
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import number_of

if TYPE_CHECKING:
    from catseye.calibration.core.types import Floats


@dataclass(frozen=True)
class DriftCurve:
    """Visits that share a zero.

    Attributes:
        minutes: since the first visit of the warm-up, shape (n,).
        moved_um: since the first of these visits, shape (n,).
        drift_um_per_10min: as it is compared with the limit; NaN while it is not known, shape (n,).
    """

    minutes: "Floats"
    moved_um: "Floats"
    drift_um_per_10min: "Floats"


def drift_figure(curves: Sequence[DriftCurve], limit_um_per_10min: float, what: str) -> Figure:
    """Return both curves.

    Args:
        limit_um_per_10min: largest accepted drift.
        what: has moved, with its article, at the beginning of a sentence.
    """
    # Both panels over the same time, though the drift is known only later.
    last = max(float(one.minutes[-1]) for one in curves)
    edge = 0.02 * max(last, 1.0)
    time = Axis("time / min", low=-edge, high=last + edge)
    moved = tuple(Points(one.minutes, one.moved_um, Role.POSITIVE, joined=True) for one in curves)
    known = [(one, np.isfinite(one.drift_um_per_10min)) for one in curves]
    drifts = tuple(
        Points(one.minutes[there], one.drift_um_per_10min[there], Role.CHANGE, joined=True)
        for one, there in known
        if there.any()
    )
    limit = Level(limit_um_per_10min, Role.EXPECTED, dash="dashed")
    panels = (
        (Panel("moved", time, Axis("moved / µm"), moved),),
        (Panel("drift", time, Axis("drift / (µm/10 min)", low=0.0), (*drifts, limit)),),
    )
    caption = f"{what} since its first visit, and the drift over the window; dashed: the limit."
    return Figure("warm-up", "Drift while warming up", caption, panels, aspect=0.7)


def drift_verdict(row: Row | None, drift: Callable[[Row], str]) -> Statement:
    """Return whether an arm is warm.

    Args:
        row: what the run kept at its end; None where it ended before.
        drift: says the drift of such a row, where it is known.
    """
    if row is None:
        return Statement(Sign.ATTENTION, "The run ended before the arm was warm.", "not warm")
    after = f"after {number_of(row, 'elapsed_min'):.0f} min"
    limit = f"the limit is {number_of(row, 'limit_um_per_10min'):g} µm in 10 min"
    if row["drift_um_per_10min"] is None:
        return Statement(Sign.BAD, f"Not warm: {after} the drift is not known, {limit}.", "not warm")
    sign, warm = (Sign.GOOD, "Warm") if row["warm"] else (Sign.BAD, "Not warm")
    return Statement(sign, f"{warm}: {after} {drift(row)}, {limit}.", f"{warm.lower()} {after}")
