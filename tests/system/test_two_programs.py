"""Two programs that start on the same arm; 50 races: tests/campaigns."""

import random
from pathlib import Path

from tests.system.command import emulated
from tests.system.races import Race, race


def test_one_of_two_programs_moves_the_arm(tmp_path: Path) -> None:
    with emulated(tmp_path, "--speed", "1") as bench:
        ends = [race(bench, random.Random(seed)) for seed in (1, 2)]
    assert ends == [Race(refused=1, switched_on=1, took_right=1)] * 2
