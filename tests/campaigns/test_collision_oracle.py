"""Generated ways against an oracle of its own: no collision is accepted, hardly any way is refused needlessly.

CATSEYE_WAYS sets how many ways (default 2000), CATSEYE_SEED the seed; both are printed.
"""

import os
import time

from catseye.procedures.kit.motion.clear_way import legs_refusal
from tests.unit.procedures.collision_trial import tried


def test_no_collision_is_accepted_and_hardly_any_way_refused() -> None:
    count = int(os.environ.get("CATSEYE_WAYS", "2000"))
    seed = int(os.environ.get("CATSEYE_SEED", str(time.time_ns() % 1_000_000)))
    print(f"\n{count} ways, CATSEYE_SEED={seed}")  # noqa: T201  # the seed, to try again
    outcome = tried(seed, count, legs_refusal)
    print(outcome)  # noqa: T201  # the figures
    assert outcome.collisions == []
    assert outcome.misnamed == []
    assert len(outcome.needless) <= 0.02 * count
    assert outcome.accepted > 0.2 * count
    assert outcome.refused > 0.2 * count
