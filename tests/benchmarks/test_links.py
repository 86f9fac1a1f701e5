"""What the link layer costs: a question over the loopback, and how soon STOP is on the wire."""

import asyncio
import contextlib
import statistics
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager

import pytest

from catseye.app.testing.faulty import FaultyTransport
from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.melfa import codec
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.melfa.session import Session
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import DeviceError
from catseye.simulators.config import EmulationConfig, ErrorBudget, ReflectorPlace
from catseye.simulators.emulated_bench import EmulatedBench

ROUNDS = 2000
BATCHES = 7
QUESTION = b"1;1;OVRD=10\r"
ANSWER = b"QoK"
OPENED = (
    b"QoK0F;0F;7,0;3,5,A,1E,32,46,64;MB5;PRM;RH-3FRH5515-D;CR75x;MELFA;17-10-06;Ver.S7e;ENG;EMULATOR;1;3;8;"
)


class Fixed(asyncio.Protocol):
    """Answers every segment by the same bytes."""

    def __init__(self, connections: list[asyncio.Transport]) -> None:
        self._connections = connections

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        self._connections.append(transport)

    def data_received(self, data: bytes) -> None:
        self._transport.write(OPENED if b"OPEN" in data else ANSWER)


@asynccontextmanager
async def answering() -> AsyncIterator[int]:
    connections: list[asyncio.Transport] = []
    loop = asyncio.get_running_loop()
    server = await loop.create_server(lambda: Fixed(connections), "127.0.0.1", 0)
    try:
        yield server.sockets[0].getsockname()[1]
    finally:
        server.close()
        for connection in connections:
            connection.abort()
        await asyncio.sleep(0)
        await server.wait_closed()


async def microseconds(ask: Callable[[], Awaitable[object]]) -> float:
    start_s = time.perf_counter()
    for _ in range(ROUNDS):
        await ask()
    return 1e6 * (time.perf_counter() - start_s) / ROUNDS


async def test_a_question_costs_at_most_three_echoes_in_time() -> None:
    async with answering() as port:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        session = Session(
            open_transport(f"tcp://127.0.0.1:{port}", sink=lambda _direction, _data: None),
            MelfaSettings(),
            name="robot",
        )
        await session.link.open()

        async def bare() -> bytes:
            writer.write(QUESTION)
            return await reader.read(4096)

        async def in_time() -> bytes:
            async with asyncio.timeout(1.0):
                return await bare()

        async def ours() -> object:
            return await session.ask("OVRD=10", codec.bare)

        asked = (bare, in_time, ours)
        rounds = [[await microseconds(one) for one in asked] for _ in range(BATCHES)]
        await session.close()
        writer.close()
        await writer.wait_closed()
    bare_us, limited_us, ours_us = (statistics.median(column) for column in zip(*rounds, strict=True))
    figure = (
        f"R-protocol question {ours_us:.0f} µs, {ours_us / limited_us:.2f} asyncio echoes with a time limit"
    )
    print(f"\n{figure} ({limited_us:.0f} µs), {ours_us / bare_us:.2f} without ({bare_us:.0f} µs; target 2)")  # noqa: T201  # the figure
    assert ours_us / limited_us <= 3.0


CONFIG = EmulationConfig(reflectors=(ReflectorPlace("P1", 650.0, -400.0),), budget=ErrorBudget.none())
TRIALS = 120
MOST_BARE = 50.0
"""Of the time after which the controller has a STOP that a bare asyncio stream writes in the same trial; medians.

The bare one is written when nothing else is under way. A STOP that waited for an answer would take hundreds of times
as long, and one that waited for the motion's end thousands of times.
"""
FAR = 150.0


class Watch:
    """A bench whose robot notes when the STOP of each trial comes in.

    Args:
        bench: the emulated bench.
    """

    def __init__(self, bench: EmulatedBench) -> None:
        self.heard_s: list[float] = []
        self._add = bench.journal.add
        bench.journal.add = self._noted  # type: ignore[method-assign]  # the bench's own witness, with a finer clock

    def _noted(self, device: str, kind: str, text: str) -> None:
        if kind == "request" and text.endswith(";STOP"):
            self.heard_s.append(time.perf_counter())
        self._add(device, kind, text)


@asynccontextmanager
async def waiting_motion(bench: EmulatedBench, robot: MelfaR3, target_deg: float) -> AsyncIterator[None]:
    """A motion is under way and EXEC2 waits for its end."""
    motion = asyncio.create_task(robot.move_joints((target_deg, 0.0, 0.0, 0.0)))
    while not bench.bench.moving:  # noqa: ASYNC110  # the bench notifies nobody
        await asyncio.sleep(0)
    yield
    with contextlib.suppress(DeviceError):
        await motion


@asynccontextmanager
async def questions_in_flight(bench: EmulatedBench, robot: MelfaR3, target_deg: float) -> AsyncIterator[None]:
    """Five askers keep the queue of the first connection full."""
    del bench, target_deg

    async def ask_on() -> None:
        while True:
            with contextlib.suppress(DeviceError):
                await robot.status()

    askers = [asyncio.create_task(ask_on()) for _ in range(5)]
    await asyncio.sleep(0.001)
    yield
    for asker in askers:
        asker.cancel()
    await asyncio.wait(askers)


@asynccontextmanager
async def other_connection_stalls(
    bench: EmulatedBench, robot: MelfaR3, target_deg: float
) -> AsyncIterator[None]:
    """The first connection waits for an answer that does not come."""
    del bench, target_deg
    with contextlib.suppress(DeviceError):
        # Heals the connection that stalled in the trial before.
        await robot.reset_alarm()
    hanging = asyncio.create_task(robot.joint_limits())
    await asyncio.sleep(0.001)
    yield
    assert not hanging.done()
    hanging.cancel()
    await asyncio.wait({hanging})


class DeafToMejar(FaultyTransport):
    """Loses each question for the limits; everything else passes."""

    async def write(self, data: bytes) -> None:
        if b"MEJAR" not in data:
            await super().write(data)


@pytest.mark.parametrize("trouble", [waiting_motion, questions_in_flight, other_connection_stalls])
async def test_stop_is_on_the_wire_about_as_soon_as_bare(
    trouble: Callable[[EmulatedBench, MelfaR3, float], AbstractAsyncContextManager[None]],
) -> None:
    delays_ms: list[float] = []
    bare_ms: list[float] = []
    async with EmulatedBench(CONFIG) as bench:
        watch = Watch(bench)
        endpoint = next(served.endpoint for served in bench.endpoints if served.device == "robot")
        main = DeafToMejar(open_transport(endpoint), [])
        robot = MelfaR3(main, open_transport(endpoint), SystemClock())
        await robot.connect()
        await robot.servo(on=True)
        await robot.set_override(100.0)
        reader, writer = await asyncio.open_connection(*endpoint.removeprefix("tcp://").split(":"))
        for trial in range(TRIALS):
            async with trouble(bench, robot, FAR if trial % 2 else -FAR):
                watch.heard_s.clear()
                start_s = time.perf_counter()
                await robot.stop()
                delays_ms.append(1e3 * (watch.heard_s[0] - start_s))
                watch.heard_s.clear()
                start_s = time.perf_counter()
                writer.write(b"1;1;STOP\r")
                await reader.read(4096)
                bare_ms.append(1e3 * (watch.heard_s[0] - start_s))
        writer.close()
        await writer.wait_closed()
        await robot.close()
    p99_ms = statistics.quantiles(delays_ms, n=100)[98]
    what = f"STOP while {trouble.__name__.replace('_', ' ')}"
    middle_ms, longest_ms = statistics.median(delays_ms), max(delays_ms)
    plain_ms = statistics.median(bare_ms)
    figure = (
        f"median {middle_ms:.2f} ms, p99 {p99_ms:.2f} ms, longest {longest_ms:.2f} ms (target of the p99 20 ms); "
        f"{middle_ms / plain_ms:.2f} × a bare asyncio stream's, {plain_ms:.2f} ms (limit {MOST_BARE:g} ×)"
    )
    print(f"\n{what}: {figure}")  # noqa: T201  # the figure
    assert middle_ms <= MOST_BARE * plain_ms
