"""A table against the run that it comes from: 20 seeds, values and u equal to 1e-6 on every way into identify.

`CATSEYE_BUDGET_SEEDS` sets how many [20].
"""

import os
from pathlib import Path

import numpy as np
import pytest

from catseye.app.results.scara.result import Result
from tests.unit.app.cli.budget_routes import EQUAL, differences, figures, of_every_route
from tests.unit.app.cli.measured_runs import measured_run
from tests.unit.calibration.scara.paper import random_truth

SEEDS = int(os.environ.get("CATSEYE_BUDGET_SEEDS", "20"))


async def test_tables_agree_with_their_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    worst: dict[str, tuple[float, float]] = {}
    normalised = []
    for seed in range(1, SEEDS + 1):
        (tmp_path / str(seed)).mkdir()
        run = await measured_run(tmp_path / str(seed), seed)
        found = of_every_route(tmp_path / str(seed), run, monkeypatch)
        for route, result in found.items():
            before = worst.get(route, (0.0, 0.0))
            now = differences(result, found["run"])
            worst[route] = max(before[0], now[0]), max(before[1], now[1])
        normalised.append(_normalised(found["points.csv"], seed))
    rms = float(np.sqrt(np.mean(np.square(normalised))))
    print(f"\n{SEEDS} seeds, largest difference of values / u and of u: {worst}; errors / u {rms:.2f} rms")  # noqa: T201  # the figure
    assert max(max(pair) for pair in worst.values()) < EQUAL
    # About 3.6 independent errors an arm: the rms over 20 arms lies within 0.8 and 1.2 in 98 of 100 cases, by
    # chi-square.
    assert 0.8 < rms < 1.2


def _normalised(result: Result, seed: int) -> list[float]:
    """Return the errors of links and maps in u."""
    values, u = figures(result)
    truth = random_truth(seed).table_vector()
    truth[2:] = 1e3 * np.degrees(truth[2:])
    return list((values[:40] - truth) / u[:40])
