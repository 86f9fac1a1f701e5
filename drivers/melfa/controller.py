"""The controller beyond motion: variables, programs, parameters, signals, log, monitors, jog; for technicians."""

import contextlib
import re
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable, Mapping
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from dataclasses import dataclass, field
from typing import Self, TypeVar

from catseye.drivers.links.healing import Repeat
from catseye.drivers.melfa import codec, texts
from catseye.drivers.melfa.jog import Jog, jogging
from catseye.drivers.melfa.session import Session
from catseye.drivers.melfa.texts import EncoderReading, LogEntry, ProgramEntry, StopSources, Value
from catseye.drivers.roles.errors import DeviceError, ProtocolError, RefusedError
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import JogDirection

T = TypeVar("T")

LONGEST_LINE = 127
"""Characters in one line of a program (sheet, section 4.1)."""

_VARIABLE = re.compile(r"[A-Z][A-Z0-9_]{0,15}\$?(?:\(\d{1,4}(?:,\d{1,4}){0,2}\))?", re.IGNORECASE)
_PROGRAM = re.compile(r"[A-Z0-9_-]{1,16}(?:\.[A-Z0-9]{1,4})?", re.IGNORECASE)
_PARAMETER = re.compile(r"[A-Z][A-Z0-9]{0,15}", re.IGNORECASE)
_MOST_ENTRIES = 100_000
_SCARA_JOINTS = 4


@dataclass(frozen=True)
class ProgramText:
    """A program as it is listed.

    Attributes:
        lines: each with its number in front.
        variables: position and joint variables that belong to it, by name.
    """

    lines: tuple[str, ...]
    variables: Mapping[str, Value] = field(default_factory=dict)

    @classmethod
    def of(cls, source: str) -> Self:
        """Return a source text without line numbers as a program: numbered from 1, blank lines left out."""
        lines = (line.rstrip() for line in source.splitlines() if line.strip())
        return cls(tuple(f"{number} {line}" for number, line in enumerate(lines, start=1)))


class MelfaController:
    """Questions and orders to a controller over a session that is open. Nothing here moves the robot but `jog`.

    All methods raise LinkError (lost or silent), ProtocolError (garbage came) and RefusedError (refused).

    Args:
        take_right: takes the operation right.
        stop: stops the robot and waits for its standstill.
        watch_stops: returns a check that refuses once a stop has begun.
        guarded: has the arm stopped when this program falls silent meanwhile.
    """

    def __init__(
        self,
        session: Session,
        take_right: Callable[[], Awaitable[None]],
        stop: Callable[[], Awaitable[None]],
        watch_stops: Callable[[], Callable[[], None]],
        guarded: Callable[[], AbstractAsyncContextManager[None]],
    ) -> None:
        self._session = session
        self._take_right = take_right
        self._stop = stop
        self._watch_stops = watch_stops
        self._guarded = guarded

    async def read_variable(self, name: str) -> Value:
        """Return a variable's value: number, joints (deg or mm), position or text."""
        _check(_VARIABLE, name, "a variable")
        return await self._ask(f"VAL{name}", lambda payload: texts.parse_variable(payload, name))

    async def write_variable(self, name: str, value: Value, *, program: str | None = None) -> None:
        """Write a variable.

        Args:
            program: of the running program whose variable it is; None: the edit slot's.

        Raises:
            ValueError: such a name or value cannot be sent.
        """
        _check(_VARIABLE, name, "a variable")
        text = f"{name}={texts.value_text(value)}"
        if program is None:
            await self._order(f"VAL={text}", Repeat.HARMLESS)
        else:
            _check(_PROGRAM, program, "a program")
            await self._order(f"HOT{program};{text}", Repeat.HARMLESS)

    async def feedback(self) -> Pose:
        """Return the joints from the encoders (J_Fbc), J1 deg, J2 deg, J3 mm, J4 deg.

        Certain is that these are feedback, not command (sheet, section 4.2); the number format of the answer is not.
        Two decimals, as JPOSF has them, are 0.1 mm at the arm's reach.
        """
        value = await self.read_variable("J_FBC")
        if not isinstance(value, tuple) or len(value) < _SCARA_JOINTS:
            raise ProtocolError(f"{self._session.where}: J_FBC is {value!r}, which are not four joints")
        return value[0], value[1], value[2], value[3]

    async def programs(self) -> list[ProgramEntry]:
        """Return the programs in the controller's memory."""
        top = await self._ask("PDIRTOP", lambda payload: texts.parse_directory(payload) if payload else None)
        if top is None:
            return []
        first, count = top
        further = [
            (await self._ask(f"PDIR{place}", texts.parse_directory))[0] for place in range(2, count + 1)
        ]
        return [first, *further]

    async def read_program(self, name: str) -> ProgramText:
        """Return a program's lines and variables; it is opened for that and closed unchanged."""
        if not await self.has_program(name):
            # Opening it would make an empty one.
            raise RefusedError(f"{self._session.where}: there is no program {name}: see programs()", 4140)
        async with self._editing(name):
            lines = [line async for line in self._listed("LISTI")]
            entries = [entry async for entry in self._listed("LISTP")]
        names = [entry.partition("=")[0] for entry in entries]
        values = {key: texts.parse_variable(text, key) for key, text in zip(names, entries, strict=True)}
        return ProgramText(tuple(lines), values)

    async def write_program(self, name: str, program: ProgramText, *, replace: bool = False) -> None:
        """Write a whole program; when a line is refused nothing is kept.

        Args:
            name: under which the controller keeps it.
            program: lines, each beginning with its number, and variables.
            replace: a program of that name may be written over.

        Raises:
            ValueError: a line cannot be sent.
            RefusedError: there is one of that name already, or the controller refuses.
        """
        orders = [f"EDATA{_checked_line(line)}" for line in program.lines]
        orders += [f"EDATA{key}={texts.value_text(value)}" for key, value in program.variables.items()]
        for order in orders:
            codec.encode(order)
        if await self.has_program(name) and not replace:
            raise RefusedError(
                f"{self._session.where}: there is a program {name} already: write it with replace=True, or "
                "choose another name",
                0,
            )
        async with self._editing(name):
            for order in ("ECLR", *orders, "SAVE"):
                await self._order(order, Repeat.BOUND)

    async def has_program(self, name: str) -> bool:
        """Return whether there is a program of that name."""
        _check(_PROGRAM, name, "a program")
        return await self._ask(f"FCHECK{name}", lambda payload: payload == "N")

    async def read_parameter(self, name: str) -> tuple[str, ...]:
        """Return a parameter's values as text."""
        _check(_PARAMETER, name, "a parameter")
        return await self._ask(f"PNR{name}", lambda payload: texts.parse_parameter(payload, name))

    async def joint_limits(self) -> tuple[tuple[float, float], ...]:
        """Return the controller's own limits of J1...J4 from the parameter MEJAR, deg or mm."""
        values = await self._ask("PNRMEJAR", lambda payload: codec.parse_parameter(payload, "MEJAR"))
        if len(values) < 2 * _SCARA_JOINTS:
            raise ProtocolError(
                f"{self._session.where}: MEJAR has {len(values)} values, 8 are needed for 4 joints"
            )
        return tuple((values[2 * i], values[2 * i + 1]) for i in range(_SCARA_JOINTS))

    async def write_parameter(self, name: str, values: Iterable[str], *, confirm: bool = False) -> None:
        """Write a parameter. It acts after the controller was switched off and on.

        Args:
            name: as the manual spells it, MEJAR for instance.
            values: all of them, as text.
            confirm: True says that the change of the robot's settings is meant.

        Raises:
            ValueError: not confirmed, or such a value cannot be sent.
        """
        _check(_PARAMETER, name, "a parameter")
        if not confirm:
            raise ValueError(
                f"parameter {name} changes the robot's settings: pass confirm=True if that is meant"
            )
        listed = [value.strip() for value in values]
        if not listed or any(not value or ";" in value or "," in value for value in listed):
            raise ValueError(f"parameter {name}: {listed} cannot be sent: values are texts without , and ;")
        await self._order(f"PRM={name};{', '.join(listed)}")

    async def inputs(self, first: int) -> int:
        """Return 16 input signals from the first one on, which is bit 0."""
        return await self._ask(f"IN{first}", lambda payload: texts.parse_word(payload, "IN"))

    async def outputs(self, first: int) -> int:
        """Return 16 output signals from the first one on, which is bit 0."""
        return await self._ask(f"OUT{first}", lambda payload: texts.parse_word(payload, "OUT"))

    async def write_outputs(self, first: int, bits: int) -> None:
        """Switch 16 output signals; whatever is wired to them acts.

        Raises:
            ValueError: the bits are no word.
        """
        if not 0 <= bits <= 0xFFFF:
            raise ValueError(f"16 signals are 0 to 65535, got {bits}")
        await self._order(f"OUT={first};{bits:04X}")

    async def error_log(self, count: int) -> list[LogEntry]:
        """Return the newest lines of the error log, newest first.

        No source says whether TOP is the newest or the oldest line: the dates do.
        """
        top, end = [await self._log_entry(place) for place in ("TOP", "END")]
        if top is None or end is None:
            return []
        newest, step = ("TOP", "+1") if top.time >= end.time else ("END", "-1")
        entries: list[LogEntry] = []
        place = newest
        while len(entries) < count and (entry := await self._log_entry(place)) is not None:
            entries.append(entry)
            place = step
        return entries

    async def stop_sources(self) -> StopSources:
        """Return who keeps the robot from moving."""
        return await self._ask("STPSIG", texts.parse_stop_sources)

    async def encoders(self) -> tuple[EncoderReading, ...]:
        """Return the encoders of all axes, pulses."""
        return await self._ask("SRVENC", texts.parse_encoders)

    async def currents(self) -> tuple[float, ...]:
        """Return the motor currents of all axes as fed back, in the controller's unit."""
        return await self._ask("SRVCUR1", texts.parse_currents)

    async def clock(self) -> str:
        """Return date and time of the controller's clock."""
        return await self._ask("TIME", texts.parse_date)

    @asynccontextmanager
    async def jog(self, directions: Mapping[str, JogDirection]) -> AsyncIterator[Jog]:
        """Jog joints while `feed` of what is yielded is called; stop at the end, however it comes.

        Args:
            directions: joint names with -1 or 1.

        Raises:
            AlarmError: an alarm is active.
            NotReadyError: refused for a reason that an operator has to look at.
            ValueError: there is no such joint.
        """
        permit = self._watch_stops()
        await self._session.link.ensure()
        await self._take_right()
        async with (
            self._guarded(),
            jogging(self._session, directions, self._stop, permit) as jog,
        ):
            yield jog

    async def _ask(self, command: str, parse: Callable[[str], T]) -> T:
        return await self._session.question(command, codec.free_text, parse)

    async def _order(self, command: str, repeat: Repeat = Repeat.NEVER) -> None:
        await self._session.ask(command, codec.bare, repeat=repeat)

    async def _log_entry(self, place: str) -> LogEntry | None:
        # A step depends on the one before on this very connection, so it is never asked twice.
        repeat = Repeat.NEVER if place in {"TOP", "END"} else Repeat.BOUND
        answer = await self._session.ask(f"ERRORLOG{place}", codec.free_text, repeat=repeat)
        return self._session.parsed("ERRORLOG", texts.parse_log, answer)

    @asynccontextmanager
    async def _editing(self, name: str) -> AsyncIterator[None]:
        await self._order(f"LOAD={name}")
        try:
            yield
        finally:
            # After SAVE nothing is open, and on a lost link the controller closes by itself.
            with contextlib.suppress(DeviceError):
                await self._order("NEW", Repeat.BOUND)

    async def _listed(self, command: str) -> AsyncIterator[str]:
        place = "TOP"
        for _ in range(_MOST_ENTRIES):
            answer = await self._session.ask(f"{command}{place}", codec.free_text, repeat=Repeat.BOUND)
            if not answer.payload:
                return
            yield answer.payload
            place = "+1"


def _checked_line(line: str) -> str:
    number, _, text = line.strip().partition(" ")
    if not (number.isascii() and number.isdecimal()) or not text.strip():
        raise ValueError(f"a line of a program begins with its number and a blank, got {line!r}")
    if len(text) > LONGEST_LINE:
        raise ValueError(f"line {number} has {len(text)} characters, at most {LONGEST_LINE} are allowed")
    return f"{number} {text}"


def _check(pattern: re.Pattern[str], name: str, what: str) -> None:
    if not pattern.fullmatch(name):
        raise ValueError(f"{name!r} is not the name of {what}")
