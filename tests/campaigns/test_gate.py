"""The gate before a result: no sound measurement is refused, every classic mistake is refused and named.

`CATSEYE_GATE_SETS` sets how many sound sets there are [500]; each mistake is made in a twelfth as many.
"""

import os
from collections import Counter

import pytest

from catseye.calibration.scara.layout import ModelName
from tests.unit.calibration.scara.plausibility.tables import MISTAKES, SOUND_BENCHES, measured, table_2
from tests.unit.calibration.scara.plausibility.test_judgement import named, verdict
from tests.unit.calibration.scara.plausibility.test_two_mountings import accused

SETS = int(os.environ.get("CATSEYE_GATE_SETS", "500"))


@pytest.mark.timeout(60 + 2 * SETS)
def test_no_sound_set_is_refused() -> None:
    refused = {}
    for seed in range(SETS):
        bench = SOUND_BENCHES[seed % len(SOUND_BENCHES)]
        model: ModelName = "conventional" if seed % 5 == 4 else "error-map"
        found = verdict(measured(seed, bench), table_2() if seed % 2 else None, model)
        if found.implausible:
            refused[seed] = found
    print(f"\n{len(refused)} of {SETS} sound sets refused")  # noqa: T201  # the figure
    assert refused == {}


@pytest.mark.timeout(60 + 2 * SETS)
def test_no_sound_mounting_is_accused() -> None:
    found = accused(range(SETS))
    print(f"\n{len(found)} of {SETS} sound tables of two passes accused of another mounting")  # noqa: T201  # the figure
    assert found == {}


@pytest.mark.timeout(60 + 2 * SETS)
@pytest.mark.parametrize("name", MISTAKES)
def test_every_mistake_is_refused_and_named(name: str) -> None:
    benches = [bench for bench in SOUND_BENCHES if bench.reflectors > 1]
    counts: Counter[str] = Counter()
    for seed in range(1 + SETS // 12):
        table = MISTAKES[name](measured(10_000 + seed, benches[seed % len(benches)]))
        found = verdict(table, table_2() if seed % 2 else None)
        counts["refused"] += found.implausible
        counts["named"] += any(named(mistake, name) for mistake in found.mistakes)
        counts["sets"] += 1
    print(f"\n{name}: {dict(counts)}")  # noqa: T201  # the figure
    assert counts["refused"] == counts["named"] == counts["sets"]
