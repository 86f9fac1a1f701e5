"""An emulated bench for a test: in a thread of this process, in a process of its own, or on the test's own loop."""

import asyncio
import json
import socket
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass
from typing import Any

from catseye.app.testing.loop_thread import LoopThread
from catseye.simulators.config import (
    CLASSIC_DEVICES,
    EmulatedDevice,
    EmulationConfig,
    ErrorBudget,
    ReflectorPlace,
)
from catseye.simulators.emulated_bench import EmulatedBench
from catseye.simulators.registry import load_emulator

_TIMEOUT_S = 10.0
_LONGEST_ANSWER_BYTES = 1 << 22
_REFLECTORS = (
    ReflectorPlace("P1", 650.0, -400.0),
    ReflectorPlace("P2", 680.0, 0.0),
    ReflectorPlace("P3", 640.0, 380.0),
)

Endpoints = Mapping[str, str]
"""Where each device answers, by its name."""


@dataclass(frozen=True)
class JournalEntry:
    """What the emulated bench saw.

    Attributes:
        time_s: bench time, s.
        kind: `request` for what came over the wire, `motion` for what the arm did.
        text: the request or the event.
    """

    time_s: float
    kind: str
    text: str


@dataclass(frozen=True)
class RunningBench:
    """An emulated bench that runs elsewhere: in another thread or in another process.

    Its control port is asked over a socket, by blocking calls of about a millisecond.

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
        return _endpoint(self.endpoints, device)

    def ask(self, op: str, **arguments: object) -> dict[str, Any]:
        """Put a request to the control port; docs/emulators.md lists them.

        Raises:
            ValueError: the bench refused the request; the text is its own.
        """
        with socket.create_connection(_address(self.control), timeout=_TIMEOUT_S) as link:
            link.sendall(_request(op, arguments))
            with link.makefile("rb") as answers:
                return _answer(answers.readline())

    def fault(self, name: str, **arguments: object) -> None:
        """Set a fault: `bench.fault("block_beam", duration_s=2.0)`, `bench.fault("drop", device="robot")`.

        Raises:
            ValueError: there is no such fault, or an argument is wrong.
        """
        self.ask("fault", name=name, **arguments)

    def clear_faults(self) -> None:
        """Take all faults back."""
        self.fault("clear_faults")

    def state(self) -> dict[str, Any]:
        """Return the true state of the bench: joints, motion, beam, servo, alarm."""
        return self.ask("state")

    def truth(self) -> dict[str, Any]:
        """Return the true arm in the result format."""
        truth: dict[str, Any] = self.ask("truth")["truth"]
        return truth

    def journal(self, device: str) -> list[JournalEntry]:
        """Return what came over the wire of a device, oldest first; for the robot the arm's motions too."""
        return _entries(self.ask("log", device=device))


@dataclass(frozen=True)
class AsyncBench:
    """An emulated bench on the event loop of the test; its control port is asked by coroutines.

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
        return _endpoint(self.endpoints, device)

    async def ask(self, op: str, **arguments: object) -> dict[str, Any]:
        """Put a request to the control port; docs/emulators.md lists them.

        Raises:
            ValueError: the bench refused the request; the text is its own.
        """
        async with asyncio.timeout(_TIMEOUT_S):
            reader, writer = await asyncio.open_connection(
                *_address(self.control), limit=_LONGEST_ANSWER_BYTES
            )
            try:
                writer.write(_request(op, arguments))
                return _answer(await reader.readline())
            finally:
                writer.close()
                await writer.wait_closed()

    async def fault(self, name: str, **arguments: object) -> None:
        """Set a fault: `await bench.fault("stall", device="line-counter", duration_s=2.0)`.

        Raises:
            ValueError: there is no such fault, or an argument is wrong.
        """
        await self.ask("fault", name=name, **arguments)

    async def clear_faults(self) -> None:
        """Take all faults back."""
        await self.fault("clear_faults")

    async def state(self) -> dict[str, Any]:
        """Return the true state of the bench: joints, motion, beam, servo, alarm."""
        return await self.ask("state")

    async def truth(self) -> dict[str, Any]:
        """Return the true arm in the result format."""
        truth: dict[str, Any] = (await self.ask("truth"))["truth"]
        return truth

    async def journal(self, device: str) -> list[JournalEntry]:
        """Return what came over the wire of a device, oldest first; for the robot the arm's motions too."""
        return _entries(await self.ask("log", device=device))


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
    bench = EmulatedBench(config)
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
    async with EmulatedBench(config) as bench:
        yield AsyncBench(*_served(bench))


def _served(bench: EmulatedBench) -> tuple[Endpoints, str]:
    return by_name([(served.device, served.endpoint) for served in bench.endpoints])


def by_name(served: list[tuple[str, str]]) -> tuple[Endpoints, str]:
    """Return the devices' endpoints by name, the first of each device, and that of the control port."""
    endpoints = dict(reversed(served))
    return endpoints, endpoints.pop("control")


def _device(given: str | EmulatedDevice) -> EmulatedDevice:
    if isinstance(given, EmulatedDevice):
        return given
    return EmulatedDevice(given, given, f"{load_emulator(given).link}://127.0.0.1:0")


def _endpoint(endpoints: Endpoints, device: str) -> str:
    if device not in endpoints:
        raise LookupError(f"the bench has no device {device!r}; it has {', '.join(endpoints)}")
    return endpoints[device]


def _address(control: str) -> tuple[str, int]:
    host, _, port = control.removeprefix("tcp://").rpartition(":")
    return host.strip("[]"), int(port)


def _request(op: str, arguments: Mapping[str, object]) -> bytes:
    return json.dumps({"op": op, **arguments}).encode() + b"\n"


def _answer(line: bytes) -> dict[str, Any]:
    answer: dict[str, Any] = json.loads(line)
    if not answer.pop("ok"):
        raise ValueError(f"the emulated bench refused: {answer['error']}")
    return answer


def _entries(answer: dict[str, Any]) -> list[JournalEntry]:
    return [JournalEntry(**entry) for entry in answer["entries"]]
