"""Runs of every procedure whose disk fails under them: full, broken, read-only, over quota, or moved away.

`CATSEYE_FAULTS` says how many faults each procedure meets, `CATSEYE_SEED` repeats them.
"""

import os
import random
from pathlib import Path

import pytest

from tests.system.disk_losses import STRIKES, Losses, with_a_failing_disk, with_a_lost_folder
from tests.system.failing_disk import FailingDisk
from tests.system.interruptions import Moment
from tests.system.procedure_kills import Reference
from tests.system.trials import TRIALS, Trial, bench_of

FAULTS = int(os.environ.get("CATSEYE_FAULTS", "12"))
SEED = int(os.environ.get("CATSEYE_SEED", "20261128"))


@pytest.mark.timeout(7200)
@pytest.mark.parametrize("trial", TRIALS, ids=lambda trial: trial.procedure)
def test_a_disk_that_fails_stops_the_run(trial: Trial, tmp_path: Path) -> None:
    rng = random.Random(f"{SEED} {trial.procedure}")
    folder = tmp_path / "bench"
    folder.mkdir()
    disk = FailingDisk.built(tmp_path, folder / "catseye-runs")
    losses = Losses()
    with bench_of(trial.system, folder) as bench:
        reference = Reference.of(trial, bench)
        while losses.struck.total() < FAULTS:
            with_a_failing_disk(trial, bench, disk, reference, rng, losses)
            if rng.random() < 0.25:
                moment = Moment(rng.randint(3, max(3, reference.events - 3)), 0.0)
                with_a_lost_folder(trial, bench, reference, moment, losses, rng.choice(list(STRIKES)))
    met = ", ".join(f"{name} {count}" for name, count in losses.struck.items())
    report(
        f"{trial.procedure}: {met} (seed {SEED}; {losses.missed} more came too late); exit code 6 and an arm at rest "
        f"each time; {losses.points} points reported before, all stored; {losses.resumed} gone on with to their ends"
    )


def report(text: str) -> None:
    print(f"\n{text}, load {os.getloadavg()[0]:.1f}", flush=True)  # noqa: T201  # the figure
