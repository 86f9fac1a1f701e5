"""Cartesian resolution over places, predicted by the workers of a Dask cluster."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import pytest

from catseye.app.cell.arm import shipped_arm
from catseye.app.cell.serial_arm import chain_of
from catseye.app.cluster.share import InThisProcess, Share
from catseye.app.cluster.sharing import sharing
from catseye.app.results.resolution.cartesian_prediction import Place, Predictor, predict_places
from catseye.calibration.resolution.cartesian_steps import StepSeries
from catseye.calibration.resolution.predictor import PredictionMethod
from tests.system.test_sharing import scheduler, wait_for_workers, workers
from tests.unit.calibration.resolution.invented_tables import of_the_invented_arm
from tests.unit.calibration.resolution.test_predictor import POSES

__all__ = ["scheduler", "workers"]

A = TypeVar("A")
B = TypeVar("B")


@dataclass
class AtOnce:
    """Hands work over after the first item, however quick it is here, and counts what it handed over."""

    share: Share
    handed_over: int = 0
    begins_after_s: float = 0.0

    def map(
        self, function: Callable[[A], B], items: Sequence[A], done: Callable[[int], None] | None = None
    ) -> list[B]:
        """Carry out a function on each item; see Share."""
        self.handed_over += len(items)
        return self.share.map(function, items, done)


@pytest.mark.slow
@pytest.mark.usefixtures("workers")
def test_a_cluster_predicts_the_same_steps(scheduler: str) -> None:
    wait_for_workers(scheduler)
    predictor = Predictor(
        chain_of(shipped_arm("kr210-r2700")),
        of_the_invented_arm(),
        PredictionMethod(draws=40, series=StepSeries(count=60)),
        None,
    )
    places = [Place(f"P{number}", POSES[number % len(POSES)]) for number in range(9)]
    with sharing(1, scheduler) as share:
        cluster = AtOnce(share)
        shared = predict_places(predictor, places, cluster)
    # Of three chunks of places this process keeps the first.
    assert cluster.handed_over == 2
    assert shared == predict_places(predictor, places, InThisProcess())
    assert any(one.lis for one in shared)
