"""Ctrl-C means the same at every front end: the run takes the rung that the table has for its state."""

import asyncio
import os
import signal
from collections.abc import Awaitable, Callable, Iterator

import pytest

from catseye.app.cli.attached import People
from catseye.app.protocol.answers import Climbed
from catseye.app.protocol.ladder import Rung, rung_of
from catseye.app.protocol.requests import Plain
from catseye.app.protocol.state import ControlState
from catseye.app.service.errors import RefusedError
from tests.patience import HANG_S
from tests.unit.app.service.benches import ServiceBench, settled

Press = Callable[[ServiceBench], Awaitable[None]]


async def at_the_terminal(bench: ServiceBench) -> None:
    """Press Ctrl-C at the terminal of the run's own process."""
    bench.control.on_signal(signal.SIGINT)


async def at_a_client(bench: ServiceBench) -> None:
    """Send the request `ladder`, as the terminal UI does."""
    async with bench.client() as client:
        rung = rung_of(bench.control.state)
        if rung is None:
            with pytest.raises(RefusedError, match=r"emergency stop|has ended"):
                await client.request(Plain(op="ladder"))
        else:
            assert (await client.ask(Plain(op="ladder"), Climbed)).rung == rung


async def at_an_attached_terminal(bench: ServiceBench) -> None:
    """Press Ctrl-C at `catseye attach --control`."""
    async with bench.client() as client:
        await client.take_control()
        task = asyncio.create_task(People(client, control=True).follow())
        await settled()
        os.kill(os.getpid(), signal.SIGINT)
        await settled()
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


FRONT_ENDS = [at_the_terminal, at_a_client, at_an_attached_terminal]


@pytest.fixture
def stdin(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    reading, writing = os.pipe()
    with os.fdopen(reading) as silent:
        monkeypatch.setattr("sys.stdin", silent)
        yield
        os.close(writing)


@pytest.mark.usefixtures("stdin")
@pytest.mark.parametrize("press", FRONT_ENDS)
@pytest.mark.parametrize("state", ControlState)
async def test_every_front_end_takes_the_rung_of_the_state(
    press: Press, state: ControlState, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken: list[Rung] = []
    async with ServiceBench().running() as bench:
        for rung in Rung:
            monkeypatch.setattr(bench.control, rung, lambda _reason, rung=rung: taken.append(rung))
        bench.control.state = state
        async with asyncio.timeout(HANG_S):
            await press(bench)
        bench.control.state = ControlState.EXECUTE
        monkeypatch.undo()
    expected = rung_of(state)
    assert taken == ([] if expected is None else [expected])


async def test_two_presses_without_an_event_between_hold_and_stop() -> None:
    async with ServiceBench().running() as bench, bench.client() as client:
        first, second = (asyncio.create_task(client.ask(Plain(op="ladder"), Climbed)) for _ in range(2))
        assert [(await first).rung, (await second).rung] == [Rung.HOLD, Rung.STOP]
        assert bench.robot.calls == ["stop"]


async def test_between_runs_nothing_is_left_to_climb() -> None:
    bench = ServiceBench()
    async with bench.client() as client:
        with pytest.raises(RefusedError, match="no run is under way"):
            await client.request(Plain(op="ladder"))
        await bench.server.end()
