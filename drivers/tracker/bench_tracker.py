"""The emulated laser tracker of the emulated bench, reached through its control port: one JSON object a line."""

import json
import math
from collections.abc import Mapping
from typing import Any, ClassVar, Self

from pydantic import Field

from catseye.drivers.links.driver import DeviceSettings
from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.links.healing import Repeat
from catseye.drivers.links.link import RequestLink
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import Clock, SystemClock
from catseye.drivers.roles.device import Identity, Sink
from catseye.drivers.roles.errors import DeviceError, LinkError, ProtocolError, WrongDeviceError
from catseye.drivers.roles.tracker import Position, Tracker, TrackerAbilities

_LONGEST_ANSWER_BYTES = 65536

_SAME_SPEED = 0.01
"""Speeds that differ by a smaller share are the same."""


class BenchTrackerSettings(DeviceSettings):
    """What a cell file may set of the emulated tracker. Times are real seconds."""

    connect_timeout_s: float = Field(default=5.0, gt=0, description="for connecting.")
    answer_timeout_s: float = Field(default=5.0, gt=0, description="for an answer.")
    quiet_s: float = Field(default=0.02, gt=0, description="silence after which a link counts as drained.")


class ObjectDecoder:
    """Cuts one JSON object out of the stream: a line that ends in LF."""

    may_end = False

    def __init__(self) -> None:
        self._buffer = b""
        self.rest = b""

    def feed(self, data: bytes) -> dict[str, Any] | None:
        """Take a chunk; return the object when its line is complete.

        Raises:
            ProtocolError: no JSON object, or the line does not end.
        """
        self._buffer += data
        line, end, self.rest = self._buffer.partition(b"\n")
        if not end:
            if len(self._buffer) > _LONGEST_ANSWER_BYTES:
                raise ProtocolError(f"a line longer than {_LONGEST_ANSWER_BYTES} bytes does not end")
            return None
        try:
            answer = json.loads(line)
        except (ValueError, RecursionError):
            answer = None
        if not isinstance(answer, dict):
            raise ProtocolError(f"{line[:60]!r} is not a JSON object")
        return answer

    def end(self) -> dict[str, Any]:
        """Refuse: silence does not end a line.

        Raises:
            ProtocolError: always.
        """
        raise ProtocolError("a line without end")


class BenchTracker(Tracker):
    """Asks the emulated bench where a laser tracker would see the last axis.

    Args:
        clock_speed: seconds of the run's clock in one real second; None where nobody knows.
    """

    Settings: ClassVar[type[BenchTrackerSettings]] = BenchTrackerSettings
    protocols: ClassVar[Mapping[str, str] | None] = {}
    has_hands: ClassVar[bool] = True
    abilities: ClassVar[TrackerAbilities] = TrackerAbilities()
    summary: ClassVar[str] = "the emulated bench's own; there is none for real hardware"

    def __init__(
        self,
        transport: Transport,
        settings: BenchTrackerSettings | None = None,
        clock_speed: float | None = None,
    ) -> None:
        self._settings = settings or BenchTrackerSettings()
        self._clock_speed = clock_speed
        self._notes: tuple[str, ...] = ()
        self._link = RequestLink(transport, name="tracker", greet=self._greet, quiet_s=self._settings.quiet_s)
        self._name = ""

    @classmethod
    def at(
        cls,
        endpoint: str,
        clock: Clock,
        sink: Sink | None = None,
        **settings: Any,
    ) -> Self:
        """Return a driver for an endpoint; nothing is opened yet.

        Raises:
            LinkError: the endpoint is wrong.
            pydantic.ValidationError: a setting is unknown or wrong.
        """
        checked = BenchTrackerSettings(**settings)
        transport = open_transport(endpoint, connect_timeout_s=checked.connect_timeout_s, sink=sink)
        return cls(transport, checked, clock.speed if isinstance(clock, SystemClock) else None)

    @property
    def notes(self) -> tuple[str, ...]:
        """What an operator should know about this connection; empty when all is as it should be."""
        return self._notes

    async def connect(self) -> Identity:
        """Open the link and check who answers.

        Raises:
            WrongDeviceError: it is not the control port of an emulated bench.
            LinkError: unreachable or silent.
        """
        self._name = ""
        await self._link.open()
        return Identity(model=self._name, firmware="", serial="", simulated="EMULATOR" in self._name)

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        await self._link.close()

    async def locate(self) -> Position:
        """Return where the tracker sees the last axis now.

        Raises:
            ProtocolError: the answer is no position.
            LinkError: the link is broken or silent.
        """
        timeout_s = self._settings.answer_timeout_s
        answer = await self._link.request(
            _encode("tracker"), ObjectDecoder, timeout_s, repeat=Repeat.HARMLESS
        )
        try:
            return Position(*(_finite(answer[key]) for key in ("x_mm", "y_mm", "u_mm")))
        except (KeyError, TypeError, ValueError, OverflowError):
            self._link.distrust("no position came")
            raise ProtocolError(
                f"{self._link.where}: no position in {answer!r}: check that the emulated bench is of the same "
                "version"
            ) from None

    async def _greet(self) -> None:
        try:
            answer = await self._link.exchange(
                _encode("identify"), ObjectDecoder(), self._settings.answer_timeout_s
            )
            name = answer.get("name")
            if answer.get("ok") is not True or not isinstance(name, str):
                raise ProtocolError(f"{self._link.where}: 'identify' was answered by {answer!r}")
        except (LinkError, ProtocolError) as exc:
            raise self._stranger(exc) from None
        self._name = name
        self._notes = self._speeds(answer.get("speed"))

    def _speeds(self, bench: object) -> tuple[str, ...]:
        """Warn of a bench whose time runs otherwise than the run's."""
        own = self._clock_speed
        if own is None or not isinstance(bench, int | float) or bench <= 0.0:
            return ()
        if abs(bench / own - 1.0) < _SAME_SPEED:
            return ()
        return (
            f"the emulated bench runs at {bench:g} times real time, and this program reckons with {own:g}: settling "
            f"times and drift rates of a run would be wrong by {max(bench / own, own / bench):.3g} times; start runs "
            f"with --speed {bench:g}",
        )

    def _stranger(self, cause: DeviceError) -> DeviceError:
        came = self._link.greeting or self._link.last_bytes
        if not came or self._name:
            return cause
        return WrongDeviceError(
            f"{self._link.where}: no emulated bench answers here, first bytes {came!r}: the tracker's endpoint has "
            f"to be the bench's control port; {cause}"
        )


def _finite(value: Any) -> float:
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(value)
    return number


def _encode(operation: str) -> bytes:
    return json.dumps({"op": operation}).encode() + b"\n"
