"""Every procedure of all systems, killed at random moments and at every named place, each time gone on with.

`CATSEYE_KILLS` says how often each is killed at random, `CATSEYE_SEED` repeats the moments.
"""

import os
import random
from pathlib import Path

import pytest

from catseye.app.files.crash_points import RUN_POINTS
from tests.system.procedure_kills import Kills, Reference, killed_at_every_place, killed_at_random
from tests.system.trials import TRIALS, Trial, bench_of

KILLS = int(os.environ.get("CATSEYE_KILLS", "24"))
SEED = int(os.environ.get("CATSEYE_SEED", "20261128"))

_done: list[Kills] = []


@pytest.mark.timeout(7200)
@pytest.mark.parametrize("trial", TRIALS, ids=lambda trial: trial.procedure)
def test_killed_at_random_moments_and_every_named_place(trial: Trial, tmp_path: Path) -> None:
    rng = random.Random(f"{SEED} {trial.procedure}")
    with bench_of(trial.system, tmp_path) as bench:
        reference = Reference.of(trial, bench)
        found = killed_at_random(trial, bench, reference, rng, KILLS)
        named = killed_at_every_place(trial, bench, reference, rng)
    _done.extend((found, named))
    passed = ", ".join(named.places)
    report(
        f"{trial.procedure}: {found.count} kills at random (seed {SEED}) and {named.count} at "
        f"{len(named.places)} named places ({passed}), {found.runs + named.runs} runs to their ends; "
        f"{found.points + named.points} points and {found.steps + named.steps} steps reported before them, all stored"
    )


def test_every_named_place_has_killed_something() -> None:
    places = {place for each in _done for place in each.places}
    report(f"{sum(each.count for each in _done)} kills, named places: {len(places)} of {len(RUN_POINTS)}")
    assert places == set(RUN_POINTS)


def report(text: str) -> None:
    print(f"\n{text}, load {os.getloadavg()[0]:.1f}", flush=True)  # noqa: T201  # the figure
