"""Every fault on each way of every link, run after run: healed, or a clean stop with a message; no number is wrong.

`CATSEYE_PROXY_SEEDS` sets the seeds of each fault [1,2], `CATSEYE_PROXY_PLANS` which benches, `CATSEYE_PROXY_LOG` a
file that takes each run as a line of JSON, with which a campaign that is called again goes on, and
`CATSEYE_PROXY_WORKERS` how many runs go at a time [2].
"""

import os
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from tests.system.proxied import PLANS, cases, spent
from tests.system.proxied_outcomes import Case, Outcome, line, outcome_of, table

SEEDS = [int(seed) for seed in os.environ.get("CATSEYE_PROXY_SEEDS", "1,2").split(",")]
CHOSEN = os.environ.get("CATSEYE_PROXY_PLANS", ",".join(PLANS)).split(",")
WORKERS = int(os.environ.get("CATSEYE_PROXY_WORKERS", "2"))
LOG = os.environ.get("CATSEYE_PROXY_LOG", "")


def carried_out(case: Case, folder: Path) -> Outcome:
    own = folder / str(case).replace("/", "-").replace(" ", "-")
    own.mkdir()
    outcome = spent(case, own)
    report(line(outcome))
    if LOG:
        with open(LOG, "a", encoding="utf-8") as log:
            log.write(line(outcome) + "\n")
    if outcome.fine:
        shutil.rmtree(own)
    return outcome


def recorded() -> list[Outcome]:
    """Return the runs of earlier calls."""
    log = Path(LOG)
    return [outcome_of(text) for text in log.read_text("utf-8").splitlines()] if LOG and log.exists() else []


def report(text: str) -> None:
    print(text, flush=True)  # noqa: T201  # the figures


@pytest.mark.timeout(40_000)
def test_every_fault_is_healed_or_stops_cleanly(tmp_path: Path) -> None:
    outcomes = recorded()
    done = {outcome.case for outcome in outcomes}
    due = [case for case in cases(SEEDS) if case.plan in CHOSEN and case not in done]
    with ThreadPoolExecutor(WORKERS) as pool:
        outcomes += pool.map(lambda case: carried_out(case, tmp_path), due)
    report("\n".join(table(outcomes)))
    assert [line(outcome) for outcome in outcomes if not outcome.fine] == []
