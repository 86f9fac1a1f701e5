"""Who keeps a walk going through the engine's socket, and what becomes of it when that client is lost."""

from typing import cast

import pytest

from catseye.app.protocol.requests import WalkFeed
from catseye.app.service.errors import RefusedError
from catseye.app.service.running import PlannedRun
from tests.unit.app.service.benches import ServiceBench


async def test_a_client_in_control_feeds_and_lets_go() -> None:
    fed: list[bool] = []
    async with ServiceBench().running() as bench, bench.client() as ada:
        bench.handle.feed = fed.append
        await ada.take_control()
        await ada.request(WalkFeed())
        await ada.request(WalkFeed(on=False))
    assert fed == [True, False]


async def test_nobody_feeds_without_control() -> None:
    fed: list[bool] = []
    async with ServiceBench().running() as bench, bench.client() as ada:
        bench.handle.feed = fed.append
        with pytest.raises(RefusedError, match="needs control"):
            await ada.request(WalkFeed())
    assert fed == []


async def test_a_run_that_is_no_walk_is_not_fed() -> None:
    async with ServiceBench().running() as bench, bench.client() as ada:
        await ada.take_control()
        with pytest.raises(RefusedError, match="not a walk"):
            await ada.request(WalkFeed())


async def test_a_walk_whose_client_is_lost_is_stopped() -> None:
    class Walked:
        """A run that is a walk, in a cell whose runs go on alone."""

        walk = object()

    # The property needs nothing else of a planned run.
    policy = cast(property, PlannedRun.on_client_lost).fget
    assert policy is not None
    assert policy(cast(PlannedRun, Walked())) == "stop"
