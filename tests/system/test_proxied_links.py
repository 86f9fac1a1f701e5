"""The proxy campaign in short: a small plan with a fault on one link, and how its runs are judged.

The long one is tests/campaigns/test_proxy.py.
"""

from pathlib import Path

import pytest

from tests.system.proxied import PLANS, cases, spent
from tests.system.proxied_outcomes import Case, Outcome, line, ordered, outcome_of, repeated, table

SHORT = (
    Case("scara", "motion", "rx", "duplicate", 1),
    Case("scara", "interferometer", "rx", "corrupt", 1),
)


@pytest.mark.parametrize("case", SHORT, ids=str)
def test_a_fault_is_healed_or_stops_the_run_cleanly(case: Case, tmp_path: Path) -> None:
    outcome = spent(case, tmp_path)
    assert outcome.struck > 0
    assert (outcome.wrong, outcome.broken) == ([], [])


def test_two_seeds_are_more_than_two_hundred_runs() -> None:
    assert len(cases([1, 2])) > 200
    assert {case.plan for case in cases([1])} == set(PLANS)


MOVE = b"1;1;EXECJCATSEY1=(%s)\r1;1;EXEC2=MOV JCATSEY1\r"


@pytest.mark.parametrize(
    ("said", "found"),
    [
        (MOVE % b"1" + MOVE % b"2", []),
        (MOVE % b"1" + MOVE % b"1", ["(1)"]),
        (MOVE % b"1" + b"1;1;STOP\r" + MOVE % b"1", []),
        (MOVE % b"1" + b"1;1;EXEC2=MOV JCATSEY1\r", ["the target that it was sent before"]),
    ],
)
def test_a_motion_that_is_sent_twice_is_noticed(said: bytes, found: list[str]) -> None:
    assert repeated(ordered(said)) == found


def test_the_table_counts_runs_by_link_and_fault() -> None:
    case = Case("scara", "air", "rx", "split", 1)
    outcomes = [Outcome(case, code=0), Outcome(case, code=3), Outcome(case, code=0, wrong=["a distance"])]
    head, rule, row = table(outcomes)
    assert row.startswith("| scara, air | 3: 1 + 1, 1 wrong | 0: 0 + 0 |")
    assert head.count("|") == rule.count("|") == row.count("|")


def test_a_run_is_read_back_from_its_line() -> None:
    outcome = Outcome(Case("abb", "tracker", "tx", "half-close", 2), struck=1, code=3, broken=["hangs"])
    assert outcome_of(line(outcome)) == outcome
