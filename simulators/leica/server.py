"""The emulated emScon server: every command, answered (sheet `trackers_ballbar`, section 1).

Known are numbers, sizes and layouts. Not known, and assumed here: how long motions take; that a command that comes
while another is carried out is answered "busy" and not put into a queue; that a target that is not found is "no
distance set" (37), a measurement whose beam is broken an error with "no stationary result" (10009); what the server
starts with (metres, radians, spherical coordinates). Stored and not applied: station orientation, transformation,
regions, the try mode.
"""

import math
import struct
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from catseye.simulators.leica import packets
from catseye.simulators.leica.information import Information
from catseye.simulators.leica.instrument import Instrument
from catseye.simulators.leica.packets import Command
from catseye.simulators.leica.parameters import BLOCKS, READ_BY, Parameters

START, STOP = 49, 52
START_NIVEL = 51
GO_AND_MEASURE = 135

OK, BUSY, NOT_IMPLEMENTED, WRONG_PARAMETER = 0, 1, 2, 3
NO_LAST_POINT, NO_NIVEL, UNKNOWN, NO_DISTANCE = 28, 31, 36, 37
NOT_INITIALISED, NO_RESULT, NOT_WARM = 39, 10009, 10012

_NOT_READY, _READY = 0, 2
_UNUSED = {50, 64, 141}
_LAST_COMMAND = 142

_INITIALISE_S, _MOVE_S, _SEARCH_S, _FACE_S, _NIVEL_S = 8.0, 0.6, 0.8, 2.0, 1.0

_MOST_NEWS = 100
_DISTANCE_SET, _ENVIRONMENT_CHANGED = 0, 2
_NEWS_OF_FACE: Final = {1: 30, 2: 31}


@dataclass
class Job:
    """Something that takes bench time.

    Attributes:
        due_s: bench time at which it is done.
        done: it is.
        said: what its client receives then.
    """

    due_s: float
    done: bool = False
    said: bytes = b""


class News:
    """Codes of changes of state; only the last ones are kept.

    Attributes:
        count: how many there were so far.
    """

    def __init__(self) -> None:
        self.count = 0
        self._last: deque[int] = deque(maxlen=_MOST_NEWS)

    def add(self, code: int) -> None:
        """Add a change."""
        self.count += 1
        self._last.append(code)

    def since(self, count: int) -> list[int]:
        """Return the changes after so many, as far as they are kept."""
        new = min(self.count - count, len(self._last))
        return list(self._last)[len(self._last) - new :]


Said = bytes | Job
"""An answer at once, or one that follows."""


class Server:
    """What all clients share.

    Args:
        instrument: the tracker.
        kept: what clients have set.
        information: what the server says of itself.
        warm_s: returns the bench time from which the laser is ready.
        has_nivel: there is an inclination sensor.

    Attributes:
        news: changes of state.
        last_status: of the last command.
    """

    def __init__(
        self,
        instrument: Instrument,
        kept: Parameters,
        information: Information,
        *,
        warm_s: Callable[[], float],
        has_nivel: bool,
    ) -> None:
        self.instrument = instrument
        self.kept = kept
        self.information = information
        self.news = News()
        self.last_status = OK
        self._warm_s = warm_s
        self._has_nivel = has_nivel
        self._laser_on = True
        self._parameters_of_system: dict[int, float] = {}
        self._job: Job | None = None
        self._questions: dict[int, Callable[[], bytes]] = {
            1: lambda: information.system_status(
                self.last_status, self._processor, self._laser, instrument.weather
            ),
            2: lambda: struct.pack("<i", _READY if instrument.locked else _NOT_READY),
            21: lambda: struct.pack("<3d", *instrument.air()),
            66: lambda: struct.pack("<2d", *map(instrument.units.angle, self._direction())),
            98: lambda: struct.pack("<i", instrument.face),
            122: lambda: struct.pack("<2i", self.last_status, self._measurement_status()),
            124: lambda: struct.pack("<3d", *instrument.units.place(instrument.glance_mm)),
            127: lambda: struct.pack("<d", instrument.air()[0]),
            **information.questions,
        }
        self._motions: dict[int, tuple[str, float, Callable[..., int]]] = {
            7: ("", _INITIALISE_S, self._initialise),
            8: ("", 0.0, lambda: OK),
            10: ("", _MOVE_S, self._home),
            53: ("", _FACE_S, self._change_face),
            54: ("", _MOVE_S, self._home),
            55: ("3di", _MOVE_S, lambda x, y, z, _adm: self._aim(x, y, z)),
            56: ("3di", _MOVE_S, lambda turn, zenith, distance, _adm: self._aim_hvd(turn, zenith, distance)),
            57: ("2d", _MOVE_S, self._turn),
            58: ("3d", _MOVE_S, lambda x, y, z: self._point(self._aim, x, y, z)),
            59: ("3d", _MOVE_S, lambda *values: self._point(self._aim_hvd, *values)),
            60: ("2i", 0.0, lambda _turn, _zenith: OK),
            61: ("i", _MOVE_S, lambda _position: OK if self._has_nivel else NO_NIVEL),
            62: ("", _MOVE_S, self._last_point),
            63: ("d", _SEARCH_S, lambda _distance: self._found(instrument.aim())),
            95: ("i", _MOVE_S, lambda _clockwise: self._home()),
        }

    @property
    def now_s(self) -> float:
        """Bench time, s."""
        return self.instrument.bench.time_s

    @property
    def busy(self) -> bool:
        """A command is under way."""
        return self._job is not None and not self._job.done

    def carry_out(self, command: Command) -> Said:
        """Carry out a command but for the start and the end of a measurement; return what is said."""
        said = self._carried_out(command.number, command.parameters)
        if isinstance(said, bytes):
            self.last_status = struct.unpack_from("<i", said, 12)[0]
        return said

    def refusal_to_measure(self, command: int) -> bytes:
        """Return the reply to a command that cannot begin now; empty when it can."""
        status = BUSY if self.busy else OK if self.instrument.initialised else NOT_INITIALISED
        if status == OK and self._laser != Information.LASER_READY:
            status = NOT_WARM
        return packets.reply(command, status) if status else b""

    def begin(self, duration_s: float, finish: Callable[[], bytes]) -> Job:
        """Begin something that takes bench time; it is finished whoever is still there."""
        job = Job(self.now_s + duration_s)

        def end() -> None:
            if not job.done and self.instrument.has_power:
                job.done, job.said = True, finish()

        self._job = job
        self.instrument.bench.call_at(job.due_s, end)
        return job

    @property
    def _laser(self) -> int:
        if not self._laser_on:
            return Information.LASER_OFF
        return Information.LASER_READY if self.now_s >= self._warm_s() else Information.LASER_HEATING

    @property
    def _processor(self) -> int:
        return Information.INITIALISED if self.instrument.initialised else Information.COMPENSATION_SET

    def _carried_out(self, number: int, data: bytes) -> Said:
        if not 0 <= number <= _LAST_COMMAND or number in _UNUSED:
            return packets.reply(number, UNKNOWN)
        if number in self._questions:
            return packets.reply(number, OK, self._questions[number]())
        if number in READ_BY:
            self.instrument.refresh_air()
            return packets.reply(number, OK, self.kept.packed(READ_BY[number]))
        if number in BLOCKS:
            return packets.reply(number, self._set(number, data))
        if number in self._motions:
            return self._motion(number, data)
        return self._special(number, data)

    def _set(self, number: int, data: bytes) -> int:
        status = self.kept.write(number, data)
        if status == OK:
            self.news.add(BLOCKS[number].news)
        return status

    def _motion(self, number: int, data: bytes) -> Said:
        layout, duration_s, move = self._motions[number]
        if len(data) != struct.calcsize(f"<{layout}"):
            return packets.reply(number, WRONG_PARAMETER)
        if self.busy:
            return packets.reply(number, BUSY)
        if not self.instrument.initialised and number != 7:
            return packets.reply(number, NOT_INITIALISED)
        values = struct.unpack(f"<{layout}", data)
        if not all(math.isfinite(value) for value in values):
            return packets.reply(number, WRONG_PARAMETER)

        def finish() -> bytes:
            self.last_status = move(*values)
            return packets.reply(number, self.last_status)

        return self.begin(duration_s, finish)

    def _special(self, number: int, data: bytes) -> Said:
        match number, len(data):
            case 0, 0:
                return packets.reply(number, OK)
            case 11, 4:
                self._laser_on = bool(struct.unpack("<i", data)[0])
                return packets.reply(number, OK)
            case 20, 24:
                self.instrument.set_air(struct.unpack("<3d", data))
                self.news.add(_ENVIRONMENT_CHANGED)
                return packets.reply(number, OK)
            case 65, 32:
                return self._look(number, data)
            case (120, 8) | (125, 12):
                key, value = struct.unpack("<ii" if number == 120 else "<id", data)
                self._parameters_of_system[key] = value
                return packets.reply(number, OK)
            case (121, 4) | (126, 4):
                (key,) = struct.unpack("<i", data)
                value = self._parameters_of_system.get(key, 0.0)
                layout = "<ii" if number == 121 else "<id"
                return packets.reply(
                    number, OK, struct.pack(layout, key, int(value) if number == 121 else value)
                )
            case 130, 4:
                return packets.reply(number, OK)
            case 134, 0:
                self.kept.restore()
                return packets.reply(number, OK)
            case ((0 | 11 | 20 | 65 | 120 | 121 | 125 | 126 | 130 | 134), _):
                return packets.reply(number, WRONG_PARAMETER)
        return packets.reply(number, NOT_IMPLEMENTED)

    def _look(self, number: int, data: bytes) -> Said:
        """Search a target at a place, and say in which direction it is."""
        *values, _radius = struct.unpack("<4d", data)
        if self.busy or not self.instrument.initialised:
            return packets.reply(number, BUSY if self.busy else NOT_INITIALISED, bytes(16))

        def finish() -> bytes:
            status = self._aim(*values)
            angles = map(self.instrument.units.angle, self._direction())
            return packets.reply(number, status, struct.pack("<2d", *angles))

        return self.begin(_SEARCH_S, finish)

    def _direction(self) -> tuple[float, float]:
        x, y, z = self.instrument.glance_mm
        return math.atan2(y, x), math.acos(z / math.hypot(x, y, z))

    def _measurement_status(self) -> int:
        """Return the bits of what a measurement needs."""
        found = 1 | 2 | 4 | 8
        found |= 2048 if self.instrument.locked else 0
        found |= 4096 if self.instrument.face == 1 else 0
        return found | (65536 if self.instrument.initialised else 0)

    def _found(self, found: bool) -> int:
        if found:
            self.news.add(_DISTANCE_SET)
        return OK if found else NO_DISTANCE

    def _initialise(self) -> int:
        self.instrument.initialised = True
        return self._home()

    def _home(self) -> int:
        self.instrument.go_home()
        return self._found(True)

    def _change_face(self) -> int:
        self.instrument.change_face()
        self.news.add(_NEWS_OF_FACE[self.instrument.face])
        return OK

    def _aim(self, *values: float) -> int:
        place_mm = self.instrument.units.to_place_mm(values)
        if not math.hypot(*place_mm) > 1.0:
            return WRONG_PARAMETER
        return self._found(self.instrument.aim(place_mm))

    def _aim_hvd(self, turn: float, zenith: float, distance: float) -> int:
        units = self.instrument.units
        rad = units.to_rad(turn), units.to_rad(zenith)
        return self._found(self.instrument.aim_along(*rad, units.to_mm(distance)))

    def _point(self, aim: Callable[..., int], *values: float) -> int:
        """Point without asking for a target; one that the beam meets is locked on all the same."""
        aim(*values)
        return OK

    def _turn(self, turn: float, zenith: float) -> int:
        units = self.instrument.units
        self.instrument.turn(units.to_rad(turn), units.to_rad(zenith))
        return OK

    def _last_point(self) -> int:
        last_mm = self.instrument.last_mm
        return NO_LAST_POINT if last_mm is None else self._found(self.instrument.aim(last_mm))
