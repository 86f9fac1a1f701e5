"""A run counts while nothing says that the bench is another one."""

from typing import Any

import pytest

from catseye.app.results.readiness.bench_seen import NOTHING_SEEN, BenchSeen, seen_by_run

ROBOT = {"model": "RV-1", "firmware": "A1", "serial": "R-77", "simulated": False}
META: dict[str, Any] = {
    "bench_started": "one",
    "simulated": True,
    "devices": {"robot": ROBOT, "environment": {**ROBOT, "serial": "E-1"}},
    "configuration": {"robot": {"arm": "kr210", "endpoint": "tcp://127.0.0.1:1"}},
}


def changed(**meta: Any) -> BenchSeen:
    return seen_by_run({**META, **meta})


@pytest.mark.parametrize(
    ("later", "why"),
    [
        (changed(), ""),
        (NOTHING_SEEN, ""),
        (changed(bench_started=""), ""),
        (changed(bench_started="two"), "bench restarted since"),
        (changed(simulated=False, bench_started=""), "made in simulation"),
        (changed(devices={"robot": {**ROBOT, "serial": "R-78"}}), "another robot since"),
        (changed(devices={"robot": {**ROBOT, "serial": ""}}), ""),
        (changed(devices={"robot": {**ROBOT, "firmware": "A2"}}), ""),
        # What only serves the surroundings may be exchanged.
        (changed(devices={"environment": {**ROBOT, "serial": "E-2"}}), ""),
        (changed(configuration={"robot": {"arm": "kr120"}}), "another arm in the cell file"),
        (changed(configuration={"robot": {"arm": "kr210", "endpoint": "tcp://10.0.0.1:1"}}), ""),
    ],
)
def test_what_was_seen_later_voids_a_run(later: BenchSeen, why: str) -> None:
    assert changed().why_no_longer(changed().updated(later)) == why


@pytest.mark.parametrize(
    ("later", "why"),
    [
        (changed(bench_started="two"), ""),
        (changed(devices={"robot": ROBOT, "interferometer": {**ROBOT, "serial": "L-2"}}), ""),
        (changed(devices={"robot": {**ROBOT, "serial": "R-78"}}), "another robot since"),
        (changed(configuration={"robot": {"arm": "kr120"}}), "another arm in the cell file"),
        (changed(simulated=False), "made in simulation"),
    ],
)
def test_an_arm_outlives_what_measures_it(later: BenchSeen, why: str) -> None:
    first = changed(devices={"robot": ROBOT, "interferometer": {**ROBOT, "serial": "L-1"}})
    assert first.why_another_arm(first.updated(later)) == why


@pytest.mark.parametrize("meta", [{}, {"devices": 7, "simulated": "no", "configuration": []}])
def test_a_run_of_an_older_program_has_seen_nothing(meta: dict[str, Any]) -> None:
    assert seen_by_run(meta) == NOTHING_SEEN
    assert not seen_by_run(meta).why_no_longer(changed())
