"""The paper's plan with one answer in twenty lost, doubled or garbled on every link: no person, no wrong point."""

import os
from pathlib import Path

import pytest

from tests.system.lossy import measured

_SPEED = "100"
_SHARE = 0.05
_POINTS = 1048
SEEDS = [int(seed) for seed in os.environ.get("CATSEYE_SEEDS", "1,2,3").split(",")]


@pytest.mark.timeout(7200)
@pytest.mark.parametrize("seed", SEEDS)
def test_the_plan_completes_without_a_person(seed: int, tmp_path: Path) -> None:
    run = measured(tmp_path, _SPEED, _SHARE, seed, limit_s=7000.0)
    points = run.record.rows("points")
    events = run.record.events()
    kinds = {event.kind: sum(other.kind == event.kind for other in events) for event in events}
    print(  # noqa: T201  # the figure
        f"\nseed {seed}: {len(points)} points, largest misfit {run.misfit_um:.3f} µm, {run.motions} motions, {kinds}"
    )
    assert len(points) == _POINTS
    assert run.misfit_um < 0.3
