"""An emulated bench for a test: in a thread of this process, in a process of its own, or on the test's own loop."""

from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass
from typing import Any, TypeVar

from catseye.app.testing.loop_thread import LoopThread
from catseye.simulators.config import (
    CLASSIC_DEVICES,
    EmulatedDevice,
    EmulationConfig,
    ErrorBudget,
    ReflectorPlace,
)
from catseye.simulators.control_port.client import ask, ask_blocking
from catseye.simulators.control_port.exchange import Answer, Request
from catseye.simulators.control_port.faults import ClearFaults, Fault, fault_named
from catseye.simulators.control_port.messages import (
    ArmState,
    JournalEntry,
    ReadArm,
    ReadLog,
    ReadState,
    ReadTruth,
    State,
)
from catseye.simulators.emulated_bench import ServedBench, served_bench
from catseye.simulators.emulator import load_emulator
from catseye.simulators.errors import EmulatorError

_REFLECTORS = (
    ReflectorPlace("P1", 650.0, -400.0),
    ReflectorPlace("P2", 680.0, 0.0),
    ReflectorPlace("P3", 640.0, 380.0),
)

A = TypeVar("A", bound=Answer)

Endpoints = Mapping[str, str]
"""Where each device answers, by its name."""


@dataclass(frozen=True)
class _ServedBench:
    """An emulated bench that answers.

    Attributes:
        endpoints: where each device answers, by its name.
        control: endpoint of the control port.
    """

    endpoints: Endpoints
    control: str

    def endpoint(self, device: str) -> str:
        """Return where a device answers, in the form that cell files and drivers take.

        Raises:
            LookupError: there is no such device.
        """
        if device not in self.endpoints:
            raise LookupError(f"the bench has no device {device!r}; it has {', '.join(self.endpoints)}")
        return self.endpoints[device]


class RunningBench(_ServedBench):
    """An emulated bench that runs elsewhere: in another thread or in another process.

    Its control port is asked over a socket, by blocking calls of about a millisecond.
    """

    def ask(self, request: Request[A]) -> A:
        """Put a request to the control port; see `catseye.simulators.control_port.messages`.

        Raises:
            ValueError: the bench refused the request; the text is its own.
        """
        return ask_blocking(self.control, request)

    def fault(self, name: str, **arguments: object) -> None:
        """Set a fault: `bench.fault("block_beam", duration_s=2.0)`, `bench.fault("drop", device="robot")`.

        Raises:
            ValueError: there is no such fault, or an argument is wrong.
        """
        self.ask(_fault(name, arguments))

    def clear_faults(self) -> None:
        """Take all faults back."""
        self.ask(ClearFaults())

    def state(self) -> State:
        """Return the true state of the bench: joints, motion, beam, servo, alarm."""
        return self.ask(ReadState())

    def arm(self) -> ArmState:
        """Return the true state of the arm, whatever it carries: joints, motion, servo, alarm."""
        return self.ask(ReadArm())

    def truth(self) -> dict[str, Any]:
        """Return the true arm in the result format."""
        return self.ask(ReadTruth()).truth

    def journal(self, device: str) -> list[JournalEntry]:
        """Return what came over the wire of a device, oldest first; for the robot the arm's motions too."""
        return self.ask(ReadLog(device=device)).entries


class AsyncBench(_ServedBench):
    """An emulated bench on the event loop of the test; its control port is asked by coroutines."""

    async def ask(self, request: Request[A]) -> A:
        """Put a request to the control port; see `catseye.simulators.control_port.messages`.

        Raises:
            ValueError: the bench refused the request; the text is its own.
        """
        return await ask(self.control, request)

    async def fault(self, name: str, **arguments: object) -> None:
        """Set a fault: `await bench.fault("stall", device="line-counter", duration_s=2.0)`.

        Raises:
            ValueError: there is no such fault, or an argument is wrong.
        """
        await self.ask(_fault(name, arguments))

    async def clear_faults(self) -> None:
        """Take all faults back."""
        await self.ask(ClearFaults())

    async def state(self) -> State:
        """Return the true state of the bench: joints, motion, beam, servo, alarm."""
        return await self.ask(ReadState())

    async def truth(self) -> dict[str, Any]:
        """Return the true arm in the result format."""
        return (await self.ask(ReadTruth())).truth

    async def journal(self, device: str) -> list[JournalEntry]:
        """Return what came over the wire of a device, oldest first; for the robot the arm's motions too."""
        return (await self.ask(ReadLog(device=device))).entries


def bench_config(
    *devices: str | EmulatedDevice, speed: float = 1.0, seed: int = 0, budget: bool = False, **fields: Any
) -> EmulationConfig:
    """Return a bench for tests: three reflectors, and a beam that returns from P2 at the start.

    Args:
        devices: protocols by name (`"line-counter"`; the device then has the protocol's name) or whole devices,
            for options or another endpoint such as `serial:///dev/ptmx?baud=9600`. None: the names robot,
            interferometer and environment with melfa-r3, line-counter and modbus-air.
        speed: bench seconds in one real second.
        seed: of everything random; the same seed gives the same arm.
        budget: True makes measurements scatter as on a real bench; False leaves the arm's links, maps and play.
        fields: further fields of `catseye.simulators.config.EmulationConfig`.
    """
    chosen = {
        "reflectors": _REFLECTORS,
        # Wide enough for the true places, which differ from the rough ones by some millimetres.
        "acceptance_mm": 50.0,
        "devices": tuple(map(_device, devices)) or CLASSIC_DEVICES,
        "budget": ErrorBudget() if budget else ErrorBudget.none(),
    }
    return EmulationConfig(speed=speed, seed=seed, **{**chosen, **fields})


@contextmanager
def bench_in_thread(config: EmulationConfig) -> Iterator[RunningBench]:
    """Run the emulators of a bench in a thread of this process.

    Raises:
        EmulatorError: a protocol, an option or an endpoint cannot be used.
    """
    bench = served_bench(config)
    with LoopThread("catseye emulators") as thread:
        thread.run(bench.__aenter__())
        try:
            yield RunningBench(*_served(bench))
        finally:
            thread.run(bench.__aexit__(None, None, None))


@asynccontextmanager
async def bench_on_loop(config: EmulationConfig) -> AsyncIterator[AsyncBench]:
    """Run the emulators of a bench on the running event loop.

    Raises:
        EmulatorError: a protocol, an option or an endpoint cannot be used.
    """
    async with served_bench(config) as bench:
        yield AsyncBench(*_served(bench))


def _served(bench: ServedBench) -> tuple[Endpoints, str]:
    return by_name([(served.device, served.endpoint) for served in bench.endpoints])


def by_name(served: list[tuple[str, str]]) -> tuple[Endpoints, str]:
    """Return the devices' endpoints by name, the first of each device, and that of the control port."""
    endpoints = dict(reversed(served))
    return endpoints, endpoints.pop("control")


def _device(given: str | EmulatedDevice) -> EmulatedDevice:
    if isinstance(given, EmulatedDevice):
        return given
    return EmulatedDevice(given, given, f"{load_emulator(given).link}://127.0.0.1:0")


def _fault(name: str, arguments: dict[str, object]) -> Fault:
    try:
        return fault_named(name, arguments)
    except EmulatorError as error:
        raise ValueError(str(error)) from None
