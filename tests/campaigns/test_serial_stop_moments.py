"""STOP of robots of two makes at random moments, each with a random fault on a random link: how soon the arm brakes.

CATSEYE_STOPS=500 make campaign-stop      # CATSEYE_SEED=1 repeats a campaign
"""

import os
import random
import statistics

import pytest

from catseye.app.testing.proxy import ProxyThread
from tests.system.arm_stops import Figures, one_stop
from tests.system.makes import MAKES

STOPS = int(os.environ.get("CATSEYE_STOPS", "500"))
SEED = int(os.environ.get("CATSEYE_SEED", str(random.SystemRandom().randrange(10_000))))


@pytest.mark.timeout(7200)
@pytest.mark.parametrize("name", MAKES)
async def test_an_arm_brakes_at_any_moment(name: str) -> None:
    make, source, found = MAKES[name], random.Random(SEED), Figures()
    with ProxyThread("proxies") as threads:
        async with make.bench() as bench:
            for _ in range(STOPS):
                await one_stop(make, bench, source, threads, found)
    brakes_ms = sorted(1e3 * value for value in found.brakes_s)
    p99_ms = statistics.quantiles(brakes_ms, n=100)[98]
    print(  # noqa: T201  # the figure
        f"\n{name}, seed {SEED}: {STOPS} stops, braked after {statistics.median(brakes_ms):.0f} ms (median), "
        f"p99 {p99_ms:.0f} ms, longest {brakes_ms[-1]:.0f} ms; confirmed after a median of "
        f"{statistics.median(found.confirmed_s):.2f} s; {found.unconfirmed} unconfirmed, {found.moving} moving "
        f"after a confirmed stop, {found.deaf} not stopped, {found.twice} orders written twice, "
        f"load {os.getloadavg()[0]:.1f}"
    )
    assert (found.moving, found.deaf, found.twice) == (0, 0, 0)
