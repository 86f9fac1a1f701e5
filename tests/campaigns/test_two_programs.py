"""Two programs that start on the same arm: one of them moves it, never both. `CATSEYE_RACES` shortens it."""

import os
import random
from collections import Counter
from pathlib import Path

import pytest

from tests.system.command import emulated
from tests.system.races import Race, race

SEED = 20261122
RACES = int(os.environ.get("CATSEYE_RACES", "50"))


@pytest.mark.timeout(7200)
def test_one_of_two_programs_moves_the_arm(tmp_path: Path) -> None:
    moments = random.Random(SEED)
    with emulated(tmp_path, "--speed", "1") as bench:
        ends = Counter(race(bench, moments) for _ in range(RACES))
    print(f"\n{RACES} races (seed {SEED}): {dict(ends)}", flush=True)  # noqa: T201  # the figure
    assert ends == {Race(refused=1, switched_on=1, took_right=1): RACES}
