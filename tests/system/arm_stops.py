"""STOP at random moments of a robot's motion, each with a random fault on one of its connections."""

import asyncio
import contextlib
import random
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any, Final, Literal, get_args

from catseye.app.testing.proxy import Proxy, ProxyThread
from catseye.drivers.links.endpoint import TcpEndpoint, open_transport, parse_endpoint
from catseye.drivers.roles.errors import DeviceError, LinkError, LinkTimeoutError
from tests.patience import until
from tests.system.makes import AnyBench, Make

Trouble = Literal["lost", "garbled", "flood", "stalled", "half-closed", "none"]

OVERRIDE_PERCENT: Final = 2
FAR_DEG: Final = 100.0
WAITS_S: Final = (0.0, 0.6)


@dataclass
class Figures:
    """What was found.

    Attributes:
        brakes_s: from the call of stop to the moment at which the arm began to brake, bench s.
        confirmed_s: from the call of stop to its confirmation, real s.
        unconfirmed: stops whose standstill was reported as unconfirmed.
        moving: arms that moved after a stop that was confirmed.
        deaf: stops after which the arm went on, confirmed or not.
        twice: orders that were written more than once.
    """

    brakes_s: list[float] = field(default_factory=list)
    confirmed_s: list[float] = field(default_factory=list)
    unconfirmed: int = 0
    moving: int = 0
    deaf: int = 0
    twice: int = 0


@asynccontextmanager
async def behind(make: Make, proxies: list[Proxy]) -> AsyncIterator[Any]:
    """A robot whose connections each lead through a proxy of their own."""
    robot = make.behind(*(open_transport(proxy.endpoint) for proxy in proxies))
    try:
        await robot.connect()
        await robot.set_override(OVERRIDE_PERCENT)
        yield robot
    finally:
        await robot.close()


def spoil(proxy: Proxy, trouble: Trouble, flood: bytes) -> None:
    match trouble:
        case "lost":
            proxy.muted = True
        case "garbled":
            proxy.spoil = lambda data: bytes([data[0] ^ 0x80]) + data[1:]
        case "flood":
            proxy.flood = flood
        case "stalled":
            proxy.stalled = True
        case "half-closed":
            proxy.half_close()
        case "none":
            return


async def one_stop(
    make: Make, bench: AnyBench, source: random.Random, threads: ProxyThread, found: Figures
) -> None:
    """Move, spoil a connection, stop, and look at what the arm did."""
    target = parse_endpoint(bench.endpoints[0].endpoint)
    assert isinstance(target, TcpEndpoint)
    trouble = source.choice(get_args(Trouble))
    before_s, after_s = source.uniform(*WAITS_S), source.uniform(0.0, 0.3)
    with contextlib.ExitStack() as stack:
        proxies = [stack.enter_context(threads.proxy((target.host, target.port))) for _ in make.uses]
        spoiled = source.choice(proxies)
        async with behind(make, proxies) as robot:
            goal = FAR_DEG if bench.bench.joints[0] < 0.0 else -FAR_DEG
            motion = asyncio.create_task(robot.move_joints((goal, *make.pose[1:])))
            await asyncio.sleep(before_s)
            spoil(spoiled, trouble, make.flood)
            await asyncio.sleep(after_s)
            await _stopped(bench, robot, found)
            motion.cancel()
            with contextlib.suppress(DeviceError, asyncio.CancelledError):
                await motion
            # A stalled way back lets go, so that closing has its answers.
            spoiled.stalled = spoiled.muted = False
            spoiled.flood, spoiled.spoil = b"", None
    found.twice += _repeated_orders(make, bench)
    bench.controller.control.brake()


async def unseen_s(make: Make, bench: AnyBench, threads: ProxyThread) -> float:
    """Have the connection for orders fall silent in mid-motion; return after which bench time the arm brakes, s."""
    target = parse_endpoint(bench.endpoints[0].endpoint)
    assert isinstance(target, TcpEndpoint)
    with contextlib.ExitStack() as stack:
        proxies = [stack.enter_context(threads.proxy((target.host, target.port))) for _ in make.uses]
        async with behind(make, proxies) as robot:
            motion = asyncio.create_task(robot.move_joints((FAR_DEG, *make.pose[1:])))
            await until(lambda: bench.keeper.sync() > 0.0 and bench.bench.moving)
            silent_s, proxies[0].muted = bench.bench.time_s, True
            with contextlib.suppress(LinkTimeoutError):
                await motion
            proxies[0].muted = False
    assert not bench.bench.moving
    return next(at_s for at_s in _brakes_s(bench) if at_s >= silent_s) - silent_s


def _brakes_s(bench: AnyBench) -> list[float]:
    """Return the bench times at which the arm began to brake."""
    entries = bench.journal.entries("robot")
    return [entry.time_s for entry in entries if entry.text.startswith("stop towards")]


async def _stopped(bench: AnyBench, robot: Any, found: Figures) -> None:
    bench.keeper.sync()
    asked_s, asked_at = bench.bench.time_s, time.perf_counter()
    moved = bench.bench.moving
    try:
        await robot.stop()
    except LinkError:
        found.unconfirmed += 1
    else:
        found.confirmed_s.append(time.perf_counter() - asked_at)
        bench.keeper.sync()
        found.moving += bench.bench.moving
    bench.keeper.sync()
    brakes = [at_s for at_s in _brakes_s(bench) if at_s >= asked_s]
    if moved and brakes:
        found.brakes_s.append(brakes[0] - asked_s)
    found.deaf += bench.bench.moving


def _repeated_orders(make: Make, bench: AnyBench) -> int:
    """Return how many orders were written more than once so far."""
    written = [e.text for e in bench.journal.entries("robot") if e.text.startswith(make.order)]
    return len(written) - len(set(written))
