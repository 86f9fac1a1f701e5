"""A run that loses its disk, in short; `make campaign-disk` tries every procedure and every kind of fault."""

import random
from collections.abc import Iterator

import pytest

from tests.system.command import Emulated
from tests.system.disk_losses import STRIKES, Losses, with_a_lost_folder
from tests.system.procedure_kills import Reference
from tests.system.test_every_procedure_killed import trial_of
from tests.system.trials import bench_of

SEED = 20261128


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    with bench_of("six-axis", tmp_path_factory.mktemp("disk")) as running:
        yield running


@pytest.mark.parametrize("name", STRIKES)
def test_a_lost_folder_stops_a_run_that_resumes(bench: Emulated, name: str) -> None:
    trial, losses = trial_of("tracker-validation"), Losses()
    reference = Reference(37, frozenset(), {})
    with_a_lost_folder(trial, bench, reference, random.Random(SEED), losses, name)
    assert (losses.struck[name], losses.resumed) == (1, 1)
