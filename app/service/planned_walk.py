"""A walk made of a planned run."""

from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from pathlib import Path

from catseye.app.engine.walked.register import walked_legs
from catseye.app.engine.walked.tube import Leg
from catseye.app.service.running import PlannedRun, motions_from
from catseye.app.service.walk.feed import Feed
from catseye.app.service.walk.walk import Walk
from catseye.drivers.roles.clock import SystemClock


def as_walk(planned: PlannedRun, root: Path, walked: Iterable[Leg] = ()) -> PlannedRun:
    """Return the walk-through of a planned run.

    Args:
        walked: motions that this walk has driven before it was interrupted.
    """
    whole = replace(planned, resume=None)
    before = partial(walked_legs, root, planned.loaded.cell)
    walk = Walk(
        planned.procedure,
        planned.system,
        partial(motions_from, whole),
        walked,
        before,
        Feed(SystemClock()),
    )
    return replace(planned, procedure=walk, walk=walk)
