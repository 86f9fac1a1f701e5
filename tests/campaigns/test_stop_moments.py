"""STOP at random moments, each with a random fault on a random link: how soon the operating system has it.

CATSEYE_STOPS=500 make campaigns      # or with -k stop_moments; CATSEYE_SEED=1 repeats a campaign
"""

import asyncio
import contextlib
import os
import random
import statistics
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace
from typing import Literal, get_args

import pytest

from catseye.app.testing.proxy import Proxy, ProxyThread
from catseye.drivers.links.endpoint import TcpEndpoint, parse_endpoint
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.device import Entry
from catseye.drivers.roles.errors import DeviceError, LinkError
from catseye.simulators.config import EmulatedDevice, EmulationConfig, ErrorBudget, ReflectorPlace
from catseye.simulators.emulated_bench import EmulatedBench

STOPS = int(os.environ.get("CATSEYE_STOPS", "500"))
SEED = int(os.environ.get("CATSEYE_SEED", str(random.SystemRandom().randrange(10_000))))
FAR = 150.0
WAITS_S = (0.0, 0.6)
CONFIG = EmulationConfig(
    reflectors=(ReflectorPlace("P1", 650.0, -400.0),),
    budget=ErrorBudget.none(),
    devices=(EmulatedDevice("robot", "melfa-r3"),),
)

Trouble = Literal["lost", "garbled", "flood", "stalled", "half-closed", "none"]
Where = Literal["main", "stop", "status"]


@dataclass
class Figures:
    """What the campaign found.

    Attributes:
        delays_ms: from the call of stop to the first STOP that the operating system has taken.
        silent: stops that no connection took.
        unconfirmed: stops whose standstill was reported as unconfirmed.
        moving: arms that moved after a stop that was confirmed.
        twice: motions that were commanded more than once.
    """

    delays_ms: list[float] = field(default_factory=list)
    silent: int = 0
    unconfirmed: int = 0
    moving: int = 0
    twice: int = 0


class Sent:
    """Notes when the operating system had taken each STOP, and each motion."""

    def __init__(self) -> None:
        self.stops_s: list[float] = []
        self.motions = 0

    def note(self, direction: Entry, data: bytes) -> None:
        if direction == "tx":
            self.motions += data.count(b"EXEC2=MOV")
            if b"STOP\r" in data:
                # Noted just before the bytes are handed over, which waits for nothing.
                self.stops_s.append(time.perf_counter())


@asynccontextmanager
async def behind(proxies: dict[Where, Proxy], sent: Sent) -> AsyncIterator[MelfaR3]:
    """A robot whose three connections each lead through a proxy of their own."""
    robot = MelfaR3.at(
        proxies["main"].endpoint,
        SystemClock(),
        sent.note,
        stop_endpoint=proxies["stop"].endpoint,
        status_endpoint=proxies["status"].endpoint,
        answer_timeout_s=0.5,
    )
    try:
        await robot.connect()
        await robot.servo(on=True)
        await robot.set_override(2.0)
        yield robot
    finally:
        await robot.close()


def spoil(proxy: Proxy, trouble: Trouble) -> None:
    match trouble:
        case "lost":
            proxy.muted = True
        case "garbled":
            proxy.spoil = lambda data: bytes([data[0] ^ 0x80]) + data[1:]
        case "flood":
            proxy.flood = b"\r\n"
        case "stalled":
            proxy.stalled = True
        case "half-closed":
            proxy.half_close()
        case "none":
            return


async def one_stop(bench: EmulatedBench, source: random.Random, threads: ProxyThread, found: Figures) -> None:
    target = parse_endpoint(bench.endpoints[0].endpoint)
    assert isinstance(target, TcpEndpoint)
    trouble, where = source.choice(get_args(Trouble)), source.choice(get_args(Where))
    before_s, after_s = source.uniform(*WAITS_S), source.uniform(0.0, 0.3)
    sent = Sent()
    with contextlib.ExitStack() as stack:
        proxies: dict[Where, Proxy] = {
            name: stack.enter_context(threads.proxy((target.host, target.port))) for name in get_args(Where)
        }
        async with behind(proxies, sent) as robot:
            goal = FAR if bench.bench.joints[0] < 0.0 else -FAR
            motion = asyncio.create_task(robot.move_joints((goal, 0.0, 0.0, 0.0)))
            await asyncio.sleep(before_s)
            spoil(proxies[where], trouble)
            await asyncio.sleep(after_s)
            begun_s = time.perf_counter()
            earlier = len(sent.stops_s)
            confirmed = True
            try:
                await robot.stop()
            except LinkError:
                confirmed = False
            if len(sent.stops_s) > earlier:
                found.delays_ms.append(1e3 * (sent.stops_s[earlier] - begun_s))
            else:
                found.silent += 1
            bench.keeper.sync()
            found.unconfirmed += not confirmed
            found.moving += confirmed and bench.bench.moving
            found.twice += sent.motions > 1
            motion.cancel()
            with contextlib.suppress(DeviceError, asyncio.CancelledError):
                await motion
            # A stalled way back lets go, so that closing has its answers.
            proxies[where].stalled = proxies[where].muted = False
            proxies[where].flood, proxies[where].spoil = b"", None
    bench.controller.stop()


@pytest.mark.timeout(7200)
async def test_stop_is_taken_at_any_moment() -> None:
    source = random.Random(SEED)
    found = Figures()
    threads = ProxyThread("proxies")
    with threads:
        async with EmulatedBench(replace(CONFIG)) as bench:
            for _ in range(STOPS):
                await one_stop(bench, source, threads, found)
    ordered = sorted(found.delays_ms)
    p99_ms = statistics.quantiles(ordered, n=100)[98] if len(ordered) > 1 else ordered[0]
    times = f"median {statistics.median(ordered):.2f} ms, p99 {p99_ms:.2f} ms (20), longest {ordered[-1]:.2f} ms (50)"
    print(  # noqa: T201  # the figure
        f"\nseed {SEED}: {STOPS} stops, {times}; {found.silent} not taken, {found.unconfirmed} unconfirmed, "
        f"{found.moving} moving after a confirmed stop, {found.twice} motions sent twice, "
        f"load {os.getloadavg()[0]:.1f}"
    )
    assert (found.silent, found.moving, found.twice) == (0, 0, 0)
    assert len(ordered) == STOPS
