"""A run that loses its disk, in short; `make campaign-disk` tries every procedure and every kind of fault."""

from collections.abc import Iterator

import pytest

from tests.system.command import Emulated
from tests.system.disk_losses import STRIKES, Losses, with_a_lost_folder
from tests.system.interruptions import Moment
from tests.system.procedure_kills import Reference
from tests.system.test_every_procedure_killed import trial_of
from tests.system.trials import bench_of

TRIAL = trial_of("tracker-validation")


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    with bench_of(TRIAL.system, tmp_path_factory.mktemp("disk")) as running:
        yield running


@pytest.fixture(scope="module")
def reference(bench: Emulated) -> Reference:
    return Reference.of(TRIAL, bench)


@pytest.mark.parametrize("name", STRIKES)
def test_a_lost_folder_stops_a_run_that_resumes(bench: Emulated, reference: Reference, name: str) -> None:
    losses = Losses()
    with_a_lost_folder(TRIAL, bench, reference, Moment(reference.events // 3, 0.0), losses, name)
    assert (losses.struck[name], losses.resumed) == (1, 1)
