"""Procedures that are killed and go on, in short; `make campaign-kill` does it with all of them, and often."""

import random
from collections.abc import Iterator

import pytest

from catseye.app.protocol.procedures import procedures
from tests.system.command import Emulated
from tests.system.procedure_kills import Reference, killed_at_random
from tests.system.trials import TRIALS, Trial, bench_of

SEED = 20261128
SHORT = ("instrument-check", "tracker-validation")
"""The quickest, one that moves and one that does not; others have system tests of their own."""


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    with bench_of("six-axis", tmp_path_factory.mktemp("killed")) as running:
        yield running


def trial_of(procedure: str) -> Trial:
    (trial,) = [trial for trial in TRIALS if trial.procedure == procedure]
    return trial


def test_every_procedure_is_killed_by_the_campaign() -> None:
    assert sorted(trial.procedure for trial in TRIALS) == sorted(each.name for each in procedures())


@pytest.mark.parametrize("procedure", SHORT)
def test_a_killed_procedure_goes_on_to_its_end(bench: Emulated, procedure: str) -> None:
    trial = trial_of(procedure)
    reference = Reference.of(trial, bench)
    kills = killed_at_random(trial, bench, reference, random.Random(SEED), 2)
    assert kills.count == 2
