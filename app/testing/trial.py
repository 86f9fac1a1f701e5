"""One check's bench: the driver's device, the proxies on its links, and what the check may ask."""

import asyncio
import contextlib
import math
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass
from typing import Any, Final
from urllib.parse import urlsplit

from catseye.app.cell.arm import shipped_arm
from catseye.app.service.serial.emulation import serial_arm_of
from catseye.app.testing.bench import RunningBench, bench_config, bench_in_thread
from catseye.app.testing.borrowed_bench import borrowed_bench
from catseye.app.testing.candidate import Candidate, Change
from catseye.app.testing.proxy import Proxy, ProxyThread
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.device import Role
from catseye.drivers.roles.errors import DeviceError
from catseye.simulators.config import ArmDynamics, EmulatedDevice, EmulationConfig
from catseye.simulators.control_port.messages import Identify
from catseye.simulators.emulator import load_emulator

ROBOT = "robot"
_SERVO_DELAY_S = 0.05
"""Drives that hold soon: most checks of a robot switch them on."""

_NO_BEGINNING: Final = ("arrival", "stop", "stream goes on")
"""Deeds of an arm that no motion begins with; set points that a busy computer sends late let an arm rest midway."""

_QUESTIONS: Final[dict[Role, tuple[str, Callable[[Any], Awaitable[Any]]]]] = {
    "robot": ("joints()", lambda driver: driver.joints()),
    "interferometer": ("read()", lambda driver: driver.read()),
    "environment": ("sample()", lambda driver: driver.sample()),
    "tracker": ("examine() or locate()", lambda driver: _tracker_question(driver)),
    "io": ("door_closed()", lambda driver: driver.door_closed()),
}


def _tracker_question(driver: Any) -> Awaitable[Any]:
    """Ask a tracker something that takes no target: on the built-in bench there may be none."""
    measures = driver.abilities.points or driver.abilities.poses
    question: Awaitable[Any] = driver.examine() if measures else driver.locate()
    return question


class NotConformingError(AssertionError):
    """A driver does not do what a driver has to; the text says what, and what came instead."""


class NotApplicableError(Exception):
    """A check cannot be carried out with this device; the text says why."""


def expect(condition: bool, text: str) -> None:
    """Fail the check with a text unless a condition holds.

    Raises:
        NotConformingError: it does not hold.
    """
    if not condition:
        raise NotConformingError(text)


@dataclass(frozen=True)
class Trial:
    """What a check works with.

    Attributes:
        candidate: the driver under examination.
        endpoints: what `at` is given: `endpoint` and perhaps further ones.
        proxies: on the links, empty when the links are not TCP.
        threads: runs further proxies.
        bench: that tells the truth; None for a device without a control port.
        began_s: bench time before the check.
    """

    candidate: Candidate
    endpoints: dict[str, str]
    proxies: list[Proxy]
    threads: ProxyThread
    bench: RunningBench | None
    began_s: float = -math.inf

    @property
    def device(self) -> RunningBench:
        """The emulated bench, for checks that need one."""
        if self.bench is None:
            raise NotConformingError("this check needs an emulated bench")
        return self.bench

    def new_driver(self, endpoint: str | None = None) -> Any:
        """Return an unconnected driver.

        Args:
            endpoint: another one than the device's.
        """
        further = {key: value for key, value in self.endpoints.items() if key != "endpoint"}
        chosen = self.endpoints["endpoint"] if endpoint is None else endpoint
        return self.candidate.driver.at(chosen, SystemClock(), **further, **self.candidate.settings)

    @asynccontextmanager
    async def connected(self) -> AsyncIterator[Any]:
        """Yield a connected driver; it is closed at the end."""
        driver = self.new_driver()
        try:
            await self.in_time(driver.connect(), "connect()")
            yield driver
        finally:
            # The end of the check does not hang on a driver that does not close.
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(driver.close(), self.candidate.patience_s)

    async def ask(self, driver: Any) -> Any:
        """Ask the one question that the checks of the link ask of this role."""
        name, question = _QUESTIONS[self.candidate.role]
        return await self.in_time(question(driver), name)

    async def ask_after_trouble(self, driver: Any) -> Any:
        """Ask; one LinkError more is allowed, by which the driver reports the trouble.

        Raises:
            NotConformingError: the driver does not come back.
        """
        try:
            return await self.ask(driver)
        except DeviceError:
            pass
        try:
            return await self.ask(driver)
        except DeviceError as error:
            raise NotConformingError(
                f"the link is sound again, but the second question still fails with {error!r}: open the link again, "
                "drain it and ask who is there before the next request"
            ) from error

    async def in_time(self, work: Any, what: str) -> Any:
        """Await something, but not for ever.

        Raises:
            NotConformingError: it takes longer than a few of the driver's time-outs.
        """
        patience_s = self.candidate.patience_s
        try:
            async with asyncio.timeout(patience_s) as limit:
                return await work
        except TimeoutError:
            if not limit.expired():
                raise
            raise NotConformingError(
                f"{what} did not end within {patience_s:g} s: bound every wait"
            ) from None

    def stall(self) -> None:
        """Hold back whatever the device says from now on."""
        for proxy in self.proxies:
            proxy.stalled = True

    def release(self) -> None:
        """Let come late what was held back, and pass on again."""
        for proxy in self.proxies:
            proxy.stalled = proxy.muted = False

    def mute(self) -> None:
        """Lose whatever the device says from now on."""
        for proxy in self.proxies:
            proxy.muted = True

    def release_then_mute(self) -> None:
        """Let come late what was held back, and lose whatever the device says from now on."""
        self.mute()
        for proxy in self.proxies:
            proxy.stalled = False

    def drop(self) -> None:
        """Break all links."""
        for proxy in self.proxies:
            proxy.drop()

    def spoil(self, change: Change) -> None:
        """Change what the device says from now on."""
        for proxy in self.proxies:
            proxy.spoil = change

    def begin_with(self, data: bytes) -> None:
        """Send something to the device at the beginning of each link, before the driver says anything."""
        for proxy in self.proxies:
            proxy.opening = data

    def one_by_one(self) -> None:
        """Have everything that the device says come a byte at a time."""
        for proxy in self.proxies:
            proxy.one_by_one = True

    @property
    def connections(self) -> int:
        """How many links are open."""
        return sum(proxy.connections for proxy in self.proxies)

    def motions(self) -> list[str]:
        """Return the motions that the emulated arm has begun, oldest first."""
        return [text for text in self.deeds() if not text.startswith(_NO_BEGINNING)]

    def deeds(self) -> list[str]:
        """Return everything that the emulated arm did since the check began, oldest first."""
        entries = self.device.journal(ROBOT)
        return [entry.text for entry in entries if entry.kind == "motion" and entry.time_s > self.began_s]


@contextmanager
def trial_of(candidate: Candidate) -> Iterator[Trial]:
    """Set up one check's bench; everything is gone at the end."""
    with contextlib.ExitStack() as stack:
        threads = stack.enter_context(ProxyThread("catseye proxies"))
        bench, began_s = None, -math.inf
        if candidate.emulated:
            config = _config(candidate)
            bench = stack.enter_context(bench_in_thread(config))
            endpoints = _bench_endpoints(candidate, bench)
        else:
            endpoints = {"endpoint": str(candidate.endpoint)}
            if candidate.control is not None:
                bench = stack.enter_context(borrowed_bench(candidate.control, candidate.role))
                began_s = bench.ask(Identify()).time_s
        proxies: list[Proxy] = []
        for name, endpoint in endpoints.items():
            if endpoint.startswith("tcp://"):
                parts = urlsplit(endpoint)
                proxy = stack.enter_context(threads.proxy((parts.hostname or "", parts.port or 0)))
                proxies.append(proxy)
                endpoints[name] = proxy.endpoint
        yield Trial(candidate, endpoints, proxies, threads, bench, began_s)


def _config(candidate: Candidate) -> EmulationConfig:
    """Return the bench of the arm that the driver moves; for other devices any arm will do."""
    devices = _devices(candidate)
    if all(load_emulator(device.protocol).arm == "scara" for device in devices):
        return bench_config(*devices, dynamics=ArmDynamics(servo_delay_s=_SERVO_DELAY_S))
    arm = serial_arm_of(shipped_arm(candidate.arm))
    middle = tuple(0.5 * (joint.low + joint.high) for joint in arm.joints)
    return EmulationConfig(serial=arm, start_joints=middle, devices=tuple(devices))


def _devices(candidate: Candidate) -> list[EmulatedDevice]:
    """Return the emulated devices behind a driver's doors; drivers and emulators share the names of settings."""
    shared = {k: v for k, v in candidate.settings.items() if isinstance(v, str | int | float | bool)}
    options = {**shared, **candidate.options}
    made = []
    for door, protocol in candidate.doors.items():
        endpoint = f"{load_emulator(protocol).link}://127.0.0.1:0"
        made.append(EmulatedDevice(_device_name(candidate, door), protocol, endpoint, options))
    return made


def _bench_endpoints(candidate: Candidate, bench: RunningBench) -> dict[str, str]:
    if candidate.role == "tracker" and candidate.driver.has_hands:
        return {"endpoint": bench.control}
    return {door: bench.endpoint(_device_name(candidate, door)) for door in candidate.doors}


def _device_name(candidate: Candidate, door: str) -> str:
    main = ROBOT if candidate.role == "robot" else candidate.name
    return main if door == "endpoint" else f"{main}-{door.removesuffix('_endpoint')}"
