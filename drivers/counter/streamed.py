"""A length counter that sends its values without being asked for each."""

import re

from catseye.drivers.counter import codec
from catseye.drivers.counter.profile import CounterProfile
from catseye.drivers.links.latches import Latches
from catseye.drivers.links.stream import StreamLink
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import (
    LinkError,
    LinkTimeoutError,
    ProtocolError,
    RefusedError,
    WrongDeviceError,
)
from catseye.drivers.roles.interferometer import (
    BeamStatus,
    Compensated,
    LengthReading,
    StreamedInterferometer,
)


class StreamedCounter(StreamedInterferometer):
    """Interferometer driver of a profile with a stream.

    Such a counter gives neither status nor level: an error in place of a value is a lost beam, and the signal is 1
    with and 0 without a beam. Zeroing is done here.
    """

    def __init__(self, transport: Transport, clock: Clock, profile: CounterProfile) -> None:
        self._profile = profile
        self._latches = Latches()
        self._newest: tuple[float, str, float] | None = None
        self._error = ""
        self._count = 0
        self._last_count = 0
        self._offset_mm = 0.0
        self._link: StreamLink[str] = StreamLink(
            transport,
            clock,
            name=profile.title,
            decoder=lambda: codec.StreamDecoder(profile),
            take=self._take,
            greet=self._greet,
        )

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
        """Open the link, start the stream and wait for its first line.

        Raises:
            WrongDeviceError: what comes does not fit the profile.
            LinkError: unreachable or silent.
        """
        await self._link.open()
        return Identity(self._profile.claim, "", "", "EMULATOR" in self._profile.claim.upper())

    async def close(self) -> None:
        """Stop the stream and disconnect; may be called any number of times."""
        try:
            await self._say(self._profile.stream.stop, *self._profile.start.shutdown)
        except LinkError:
            # A link that is broken or closed already needs no farewell.
            return
        finally:
            await self._link.close()

    async def zero(self) -> int:
        """Take the next value as zero, clear the latched faults; return the new zero's number.

        Raises:
            RefusedError: an error comes in place of a value.
            LinkError: lost, or the stream has stopped.
        """
        value_mm, _, _ = await self._next()
        if self._error:
            raise self._refused()
        self._offset_mm = value_mm
        return self._latches.zeroed()

    async def read(self) -> LengthReading:
        """Return the first value that arrives after this call; with an error the last one, which is latched.

        Raises:
            RefusedError: there has been no value yet.
            LinkError: lost, or the stream has stopped.
        """
        value_mm, raw, time_s = await self._next()
        return LengthReading(value_mm - self._offset_mm, raw, time_s, self._latches.zero_id)

    async def status(self) -> BeamStatus:
        """Return the state of the beam.

        Raises:
            LinkError: lost, or the stream has stopped.
        """
        await self._await_line()
        return BeamStatus(
            beam_ok=not self._error,
            beam_lost=self._latches.beam_lost,
            overspeed=self._latches.overspeed,
            laser_ready=True,
            signal=0.0 if self._error else 1.0,
            signal_native=self._error,
            zero_id=self._latches.zero_id,
        )

    async def _next(self) -> tuple[float, str, float]:
        await self._await_line()
        if self._newest is None:
            raise self._refused()
        return self._newest

    async def _await_line(self) -> None:
        await self._link.ensure()
        before = self._count
        await self._link.wait(lambda: self._count > before, self._profile.line.timeout_s, "value")

    def _refused(self) -> RefusedError:
        return RefusedError(
            f"{self._link.where}: there is no value, the instrument sends {self._error[:64]!r}: aim the beam, and "
            "look the error up in its manual",
            0,
        )

    def _take(self, text: str, time_s: float) -> None:
        """Take a line: a value, an error, or anything else, which is left aside."""
        try:
            number, unit = codec.parse_value(self._profile.query.reply, text)
            codec.check_unit(unit, self._profile.scale)
        except ProtocolError:
            if not any(re.search(pattern, text) for pattern in self._profile.errors.patterns):
                return
            self._error = text
            self._latches.note(beam_lost=True)
        else:
            self._error = ""
            value_mm = self._length_mm(number)
            self._newest = value_mm, text, time_s
            if self._on_value is not None:
                self._on_value(time_s, value_mm - self._offset_mm)
        self._count += 1

    def _length_mm(self, number: float) -> float:
        scale = self._profile.scale
        if scale.wrap_bits:
            self._last_count = codec.unwrap(round(number), self._last_count, scale.wrap_bits)
            number = float(self._last_count)
        return codec.length_mm(number, scale)

    async def _greet(self) -> None:
        self._latches.greeting()
        await self._say(*self._profile.start.init, self._profile.stream.start)
        before = self._count
        try:
            await self._link.wait(lambda: self._count > before, self._profile.line.timeout_s, "value")
        except LinkTimeoutError as exc:
            if not self._link.last_bytes or self._newest:
                raise
            raise WrongDeviceError(
                f"{self._link.where}: what comes here does not fit the profile: check the endpoint and the "
                f"profile's patterns; {exc}"
            ) from None
        self._latches.greeted()

    async def _say(self, *commands: str | None) -> None:
        for command in filter(None, commands):
            await self._link.send((command + self._profile.line.terminator).encode("ascii"))
