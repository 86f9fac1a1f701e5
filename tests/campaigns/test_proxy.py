"""Every fault on each way of every link, run after run: healed, or a clean stop with a message; no number is wrong.

`CATSEYE_PROXY_SEEDS` sets the seeds of each fault [1,2], `CATSEYE_PROXY_PLANS` which benches, `CATSEYE_PROXY_LOG` a
file that takes each run as a line of JSON, and `CATSEYE_PROXY_WORKERS` how many runs go at a time [2].
"""

import os
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from tests.system.proxied import PLANS, Case, Outcome, cases, line, spent, table

SEEDS = [int(seed) for seed in os.environ.get("CATSEYE_PROXY_SEEDS", "1,2").split(",")]
CHOSEN = os.environ.get("CATSEYE_PROXY_PLANS", ",".join(PLANS)).split(",")
WORKERS = int(os.environ.get("CATSEYE_PROXY_WORKERS", "2"))
LOG = os.environ.get("CATSEYE_PROXY_LOG", "")


def carried_out(case: Case, folder: Path) -> Outcome:
    own = folder / str(case).replace("/", "-").replace(" ", "-")
    own.mkdir()
    outcome = spent(case, own)
    report(line(outcome))
    if outcome.fine:
        shutil.rmtree(own)
    return outcome


def report(text: str) -> None:
    print(text, flush=True)  # noqa: T201  # the figures
    if LOG:
        with open(LOG, "a", encoding="utf-8") as log:
            log.write(text + "\n")


@pytest.mark.timeout(40_000)
def test_every_fault_is_healed_or_stops_cleanly(tmp_path: Path) -> None:
    chosen = [case for case in cases(SEEDS) if case.plan in CHOSEN]
    with ThreadPoolExecutor(WORKERS) as pool:
        outcomes = list(pool.map(lambda case: carried_out(case, tmp_path), chosen))
    report("\n".join(table(outcomes)))
    assert [line(outcome) for outcome in outcomes if not outcome.fine] == []
