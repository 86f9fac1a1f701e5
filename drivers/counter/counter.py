"""A length counter that is asked by lines of text."""

import contextlib
import re
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, ClassVar, TypeVar

from pydantic import Field

from catseye.drivers.counter import codec
from catseye.drivers.counter.profile import (
    CounterProfile,
    Status,
    built_in_profiles,
    built_in_text,
    load_profile,
)
from catseye.drivers.counter.streamed import StreamedCounter
from catseye.drivers.links.driver import DeviceSettings
from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.links.latches import Latches
from catseye.drivers.links.link import RequestLink
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Identity, Sink
from catseye.drivers.roles.errors import DeviceError, LinkError, ProtocolError, RefusedError, WrongDeviceError
from catseye.drivers.roles.interferometer import BeamStatus, Compensated, Interferometer, LengthReading

T = TypeVar("T")


class CounterSettings(DeviceSettings):
    """What a cell file may set of a line counter. Times are real seconds."""

    profile: str = Field(default="default", description="name of a built-in profile or path of a TOML file.")
    connect_timeout_s: float = Field(default=5.0, gt=0, description="for connecting.")
    quiet_s: float = Field(default=0.02, gt=0, description="silence after which a link counts as drained.")


class LineCounter(Interferometer):
    """Interferometer driver.

    A beam that was lost makes every later count worthless until the next zero, so the loss is latched here too,
    whatever the instrument says afterwards. A link that was opened again counts as a lost beam: the instrument
    may have started anew meanwhile, and nothing proves that its count went on.

    Args:
        quiet_s: silence after which the link counts as drained, real s.
    """

    Settings: ClassVar[type[CounterSettings]] = CounterSettings
    summary: ClassVar[str] = "counter with text commands; a profile gives them (DISTAX too)"

    def __init__(
        self, transport: Transport, clock: Clock, profile: CounterProfile, *, quiet_s: float = 0.02
    ) -> None:
        self._clock = clock
        self._profile = profile
        # A name cannot be mistaken for a reading that comes late.
        identify = self._recognise if profile.identify else None
        first = self._encode(profile.start.first) if profile.start.first else b""
        self._link = RequestLink(
            transport,
            name=profile.title,
            greet=self._greet,
            identify=identify,
            first=first,
            quiet_s=quiet_s,
        )
        self._model: str | None = None
        self._latches = Latches()
        self._offset_mm = 0.0
        self._last_count = 0

    @classmethod
    def at(
        cls,
        endpoint: str,
        clock: Clock,
        sink: Sink | None = None,
        **settings: Any,
    ) -> "LineCounter | StreamedCounter":
        """Return a driver for an endpoint as the cell file writes it; nothing is opened yet.

        The profile of a stream makes a driver that listens, any other one a driver that asks.

        Args:
            endpoint: where it answers, tcp:// or serial://, as in a cell file.
            settings: fields of `CounterSettings`.

        Raises:
            LinkError: the endpoint is wrong.
            ProfileError: the profile is not found or wrong.
            pydantic.ValidationError: a setting is unknown or wrong.
        """
        checked = CounterSettings(**settings)
        transport = open_transport(endpoint, connect_timeout_s=checked.connect_timeout_s, sink=sink)
        used = load_profile(checked.profile)
        if used.stream.mode != "none":
            return StreamedCounter(transport, clock, used)
        return cls(transport, clock, used, quiet_s=checked.quiet_s)

    @classmethod
    def profiles(cls) -> Mapping[str, str]:
        """Return the built-in profiles."""
        return {name: built_in_text(name) for name in built_in_profiles()}

    @property
    def notes(self) -> tuple[str, ...]:
        """What an operator should know about this counter; empty when all is as it should be."""
        return self._profile.notes

    @property
    def compensated(self) -> Compensated:
        """Who corrects the lengths for the air."""
        return self._profile.compensated

    @property
    def count_mm(self) -> float:
        """Displacement that 1 in the instrument's number means, by the profile, mm."""
        return codec.length_mm(1.0, self._profile.scale)

    async def connect(self) -> Identity:
        """Open the link and check who answers.

        Raises:
            WrongDeviceError: something answers that does not fit the profile.
            LinkError: unreachable or silent.
        """
        self._model = None
        await self._link.open()
        model = ": ".join(filter(None, (self._profile.claim, self._model)))
        return Identity(model=model, firmware="", serial="", simulated="EMULATOR" in model.upper())

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        # A link that is broken or closed already needs no farewell.
        with contextlib.suppress(LinkError):
            for command in self._profile.start.shutdown if self._model is not None else ():
                await self._link.send(self._encode(command), self._profile.line.timeout_s)
        self._model = None
        await self._link.close()

    async def zero(self) -> int:
        """Zero the count, clear the latched faults; return the new zero's number.

        The arm stands still meanwhile: a zero whose answer is lost is sent again, and the last one counts.

        Raises:
            RefusedError: the instrument refuses.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        zero = self._profile.zero
        if zero.mode == "software" or not zero.command:
            self._offset_mm += (await self.read()).displacement_mm
        elif not zero.reply:
            await self._pause()
            with self._latches.zeroing():
                await self._link.send(self._encode(zero.command), self._profile.line.timeout_s)
        else:
            await self._link.repeated(partial(self._zero, zero.command, zero.reply))
        if zero.mode == "device":
            self._offset_mm, self._last_count = 0.0, 0
        return self._latches.zeroed()

    async def read(self) -> LengthReading:
        """Return one reading.

        Raises:
            RefusedError: the instrument answers with an error.
            LinkError: lost or silent.
            ProtocolError: garbage came, or another unit than the profile's.
        """
        query, scale = self._profile.query, self._profile.scale
        number, text = await self._ask_parsed(query.command, partial(self._number, query.reply))
        time_s = self._clock.monotonic_s()
        if scale.wrap_bits:
            self._last_count = codec.unwrap(round(number), self._last_count, scale.wrap_bits)
            number = float(self._last_count)
        value_mm = codec.length_mm(number, scale) - self._offset_mm
        return LengthReading(value_mm, text, time_s, self._latches.zero_id)

    async def status(self) -> BeamStatus:
        """Return the state of the beam. Without a signal command the signal is 1 with and 0 without a beam.

        Raises:
            RefusedError: the instrument answers with an error.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        bits = await self._bits(self._profile.status)
        absent = bits.get("beam_absent", bits["beam_lost"])
        self._latches.note(beam_lost=bits["beam_lost"] or absent, overspeed=bits.get("overspeed", False))
        # Before the latch is looked at, since this question too may find the link lost.
        signal = await self._signal(default=0.0 if absent else 1.0)
        return BeamStatus(
            beam_ok=not absent,
            beam_lost=self._latches.beam_lost,
            overspeed=self._latches.overspeed,
            laser_ready=bits.get("laser_ready", True),
            signal=signal,
            zero_id=self._latches.zero_id,
        )

    async def _bits(self, status: Status | None) -> dict[str, bool]:
        """Return the status bits; without any an error in place of a value means that there is no beam."""
        if status is None:
            try:
                await self.read()
            except RefusedError:
                return {"beam_lost": True}
            return {"beam_lost": False}
        return (await self._ask_parsed(status.command, partial(codec.parse_bits, status)))[0]

    async def _zero(self, command: str, reply: str) -> None:
        with self._latches.zeroing():
            text = await self._ask(command)
            if not re.search(reply, text):
                raise self._unfit(command, text, ProtocolError(f"no match for {reply!r}"))

    async def _signal(self, default: float) -> float:
        signal = self._profile.signal
        if not signal:
            return default
        level, _ = await self._ask_parsed(signal.command, partial(self._number, signal.reply))
        return min(max(level / signal.full_scale, 0.0), 1.0)

    def _encode(self, command: str) -> bytes:
        return (command + self._profile.line.terminator).encode("ascii")

    def _decoder(self, command: str) -> codec.LineDecoder:
        return codec.LineDecoder(self._profile, command if self._profile.line.echo else "")

    async def _pause(self) -> None:
        if self._profile.line.gap_s:
            await self._clock.sleep(self._profile.line.gap_s)

    async def _ask_parsed(self, command: str, parse: Callable[[str], T]) -> tuple[T, str]:
        """Ask; return what the answer says, and its text. Asked again when the answer is lost or does not fit.

        A question that was garbled on its way is refused: only what is refused twice is.
        """

        async def once() -> tuple[T, str]:
            text = await self._ask(command)
            try:
                return parse(text), text
            except ProtocolError as exc:
                raise self._unfit(command, text, exc) from None

        try:
            return await self._link.repeated(once)
        except RefusedError:
            return await self._link.repeated(once)

    async def _ask(self, command: str) -> str:
        await self._pause()
        timeout_s = self._profile.line.timeout_s
        text = await self._link.request(self._encode(command), partial(self._decoder, command), timeout_s)
        self._check_error(command, text)
        return text

    def _check_error(self, command: str, text: str) -> None:
        """Raise what an error line says. A line that fits the question is an answer: status E1 is no error 1."""
        if self._fits(command, text) or not self._is_error(text):
            return
        digits = re.search(r"\d+", text)
        raise RefusedError(
            f"{self._link.where} refused {command!r} with {text[:64]!r}: look the error up in the instrument's "
            f"manual and compare the commands of the profile ({self._profile.title}) with it",
            int(digits[0]) if digits else 0,
        )

    def _is_error(self, text: str) -> bool:
        return any(re.search(pattern, text) for pattern in self._profile.errors.patterns)

    def _fits(self, command: str, text: str) -> bool:
        profile = self._profile
        asked = (profile.query, profile.zero, profile.status, profile.signal, profile.identify)
        return any(a and a.command == command and a.reply and re.search(a.reply, text) for a in asked)

    def _number(self, reply: str, text: str) -> float:
        value, unit = codec.parse_value(reply, text)
        codec.check_unit(unit, self._profile.scale)
        return value

    def _unfit(self, command: str, text: str, cause: ProtocolError) -> ProtocolError:
        self._link.distrust(f"{command!r} had an answer that does not fit")
        return ProtocolError(
            f"{self._link.where}: {command!r} was answered by {text[:64]!r}: {cause}: check the profile "
            f"({self._profile.title}) and that nothing else answers on this port"
        )

    async def _greet(self) -> None:
        """Ask who is there and for a value, which a stranger does not know."""
        self._latches.greeting()
        profile = self._profile
        try:
            for command in profile.start.init:
                await self._pause()
                await self._link.exchange(self._encode(command), codec.QuietDecoder(), profile.line.timeout_s)
            model = await self._name()
            if self._model not in {None, model}:
                raise WrongDeviceError(
                    f"{self._link.where}: after the link was opened again {model!r} answers instead of "
                    f"{self._model!r}: check the network"
                )
            text = await self._greet_ask(profile.query.command)
            # A counter that has given its name may have no value to show, as without a beam.
            if not model or not self._is_error(text):
                try:
                    self._number(profile.query.reply, text)
                except ProtocolError as exc:
                    raise self._unfit(profile.query.command, text, exc) from None
        except (LinkError, ProtocolError) as exc:
            raise self._stranger(exc) from None
        self._model = model
        self._latches.greeted()

    async def _name(self) -> str:
        """Return the instrument's name, empty when it gives none."""
        identify = self._profile.identify
        if not identify:
            return ""
        match = re.search(identify.reply, await self._greet_ask(identify.command))
        return match["model"] if match else ""

    async def _recognise(self) -> None:
        """Check on the open connection that the next answer belongs to the next question: the count goes on."""
        if not (name := await self._name()) or name != self._model:
            raise ProtocolError(f"{self._link.where}: {name!r} instead of the name {self._model!r}")

    async def _greet_ask(self, command: str) -> str:
        await self._pause()
        return await self._link.exchange(
            self._encode(command), self._decoder(command), self._profile.line.timeout_s
        )

    def _stranger(self, cause: DeviceError) -> DeviceError:
        came = self._link.greeting or self._link.last_bytes
        if not came or self._model is not None:
            return cause
        return WrongDeviceError(
            f"{self._link.where}: what answers here does not fit the profile, first bytes {came!r}: check host "
            f"and port in the cell file and the profile's commands; {cause}"
        )
