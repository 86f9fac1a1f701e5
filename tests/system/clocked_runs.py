"""A validation on a bench with an injected clock and a scripted tracker: what it stores can be told in advance.

Arguments: root of the runs, perhaps the run to go on with.
"""

import asyncio
import sys
from pathlib import Path

from catseye.app.store.mend import seal_late
from catseye.procedures.serial_arm.tracker_validation import TrackerValidation, ValidationParams
from tests.unit.app.engine.fakes import ManualClock
from tests.unit.procedures.serial_arm.benches import SIX, Room, carried_out

POSES = 6


async def carry_out(root: Path, run: Path | None) -> str:
    """Begin a run or go on with one; return how it ended."""
    if run is not None and seal_late(run, ManualClock().now_utc().isoformat()):
        return "complete"
    plan = TrackerValidation().plan(SIX, ValidationParams(count=POSES, nests_every=3, settle_s=0.2))
    outcome = await carried_out(Room(root), TrackerValidation(), plan, resume=run)
    return f"{outcome.status} {outcome.text}".strip()


if __name__ == "__main__":
    root, *rest = map(Path, sys.argv[1:])
    print(asyncio.run(carry_out(root, rest[0] if rest else None)))  # noqa: T201  # the parent reads it
