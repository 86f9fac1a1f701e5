"""Real-time control (sheet, section 2): set points in datagrams, one a cycle, and what the servo makes of them.

What the program CATSMXT does on a controller, without an interpreter: `Mxt` is active while the program runs, or
while a program that is interpreted has the port (`open_files`), whose `Mxt` ends with END. It may be asked where the
arm stands (command 0), which lets it accept set points (command 1) until END (command 255). Each
datagram is answered once, at the next cycle; of several in one cycle the last set point counts. In joint data J3 is
in mm, the other axes are in rad.

Each cycle: the set point, a moving average over the filter's length, a first-order lag of each axis' servo, and
the arm glides there until the next cycle. The lags and their differences are assumptions (a lag common to all
axes delays the motion, a difference makes the beam miss), as are the currents. What the sheet does not say:
answers repeat command, types and communication counter of the request; the time-out (H7820) counts from the first
set point on; set points without a command 0 before, or after END, are ignored; END is answered too; datagrams of
any address are taken, since a PC that opens its socket again is the same PC; signals in datagrams are ignored;
pulses for a degree are those of `Choices`.

Alarms: H7840 for a datagram of another length, with an unknown command, with data of another type than `Mxt`
declares, or with a number that is none; H213n for a step beyond the joint's largest speed; H216n and H217n for the
limits; L2000 while the servo is off; L2802 for a position out of reach; L5640 while the arm moves otherwise. Each one
halts the program, as STOP does: nothing is answered until RUN, or until RSTPRG and the next command 0.
"""

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from catseye.simulators.config import Joints
from catseye.simulators.errors import BenchError
from catseye.simulators.melfa import alarms, mxt_packet
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.arm_control import ArmControl
from catseye.simulators.melfa.mxt_packet import IllegalPacketError, Request
from catseye.simulators.melfa.resident import Resident, Stage
from catseye.simulators.melfa.servo import ServoModel
from catseye.simulators.melfa.values import Position
from catseye.simulators.ports.session import Answer, Pending, Session
from catseye.simulators.world.bench import Bench

Mode = Literal["joint", "xyz", "pulse"]
"""What `Mxt` declares set points to be."""

_SEND_TYPES: dict[Mode, int] = {"xyz": 1, "joint": 2, "pulse": 3}
_MODES: tuple[Mode, ...] = ("xyz", "joint", "pulse")
"""By the number that a program's `Mxt` gives."""

_JOINT, _PULSE = 2, 0
"""Remainders of the types of data by three; 1 is a pose."""

_FAR = 1e6
_MOST_WAITING = 64
_LOOK_S = 0.002
_HELD_S = 5.0
_HAIR_S = 1e-9


@dataclass(frozen=True)
class MxtOptions:
    """Options of real-time control.

    Attributes:
        program: name of the program.
        mode: what set points are.
        cycle_s: of the controller: 0.0071 or 0.0035.
        filter_s: length of the moving average.
        timeout_s: longest time without reception, -1 for any.
        lag_s: time constant of J1's and J3's servo.
        lag_spread_s: how much longer J2's is; J4's is shorter by half of it.
        holds_early: the last datagram that comes while a program has not come to its `Mxt` yet waits for it, 5 s at
            most.
    """

    program: str = "CATSMXT"
    mode: Mode = "joint"
    cycle_s: float = 0.0071
    filter_s: float = 0.010
    timeout_s: float = 0.5
    lag_s: float = 0.008
    lag_spread_s: float = 0.0002
    holds_early: bool = True

    @property
    def timeout_cycles(self) -> int:
        """The time-out as the parameter MXTTOUT has it here: a count of cycles, which no sheet confirms."""
        return -1 if self.timeout_s < 0.0 else int(self.timeout_s / self.cycle_s)

    @property
    def lags_s(self) -> Joints:
        """Time constants of all axes, s."""
        return (self.lag_s, self.lag_s + self.lag_spread_s, self.lag_s, self.lag_s - 0.5 * self.lag_spread_s)


class Mxt(Resident):
    """The program that obeys set points in real time while it runs.

    Args:
        bench: that of the controller's arm.
        sync: advances bench time to this moment.

    Attributes:
        opened: a program that is interpreted has the port open; see `RealTimePort`.
        silent_cycles: without reception before the last set point.
    """

    def __init__(
        self, controller: ArmControl, bench: Bench, options: MxtOptions, sync: Callable[[], object]
    ) -> None:
        super().__init__(options.program, controller.require_start, controller.changed)
        self.controller = controller
        self._bench = bench
        self.sync = sync
        self._options = options
        self._mode, self._filter_s = options.mode, options.filter_s
        self._servo = self._servo_here()
        self._accepts = self._leads = False
        self._target: Joints | None = None
        self._heard_s: float | None = None
        self._ticking = False
        self.silent_cycles = 0
        self.opened = False
        self._lease: Callable[[], None] | None = None
        self._ending = self._ended = False

    @property
    def live(self) -> bool:
        """The port obeys set points: for its own program, or for one that is interpreted."""
        return self.running or self._lease is not None

    @property
    def expected(self) -> bool:
        """A program that is interpreted runs and may come to its `Mxt`."""
        return self.controller.program_running and not self.live

    @property
    def holds_early(self) -> bool:
        """What comes before `Mxt` is answered by it."""
        return self._options.holds_early and self.expected

    def lend(self, mode: int, filter_s: float, ended: Callable[[], None]) -> None:
        """Obey set points for another program; see `RealTimePort`."""
        if self.live:
            raise Refusal(alarms.NETWORK)
        self._mode, self._filter_s = _MODES[mode], filter_s
        self._ending = self._ended = False
        self._lease = ended
        self.begin()
        self.controller.changed()

    def take_back(self) -> None:
        """Obey no longer; see `RealTimePort`."""
        if self._lease is not None:
            self._lease = None
            self._mode, self._filter_s = self._options.mode, self._options.filter_s
            self.begin()

    def start(self) -> None:
        """Begin at the top, or go on where it was halted.

        Raises:
            Refusal: another program has the port.
        """
        if self._lease is not None:
            raise Refusal(alarms.WHILE_RUNNING)
        super().start()

    @property
    def busy(self) -> bool:
        """It leads the arm, or waits for the next set point to do so."""
        return self._heard_s is not None

    def begin(self) -> None:
        """Wait for command 0."""
        self._accepts = self._leads = False
        self._target = self._heard_s = None

    def halted(self) -> None:
        """Let go of the arm."""
        self.begin()

    def receive(self, datagram: bytes) -> tuple[Request, float] | None:
        """Take a datagram; return it and the bench time of its answer, None when nothing answers.

        A datagram that is not accepted raises an alarm.
        """
        self.sync()
        try:
            request = mxt_packet.decode(datagram)
            if request.command == mxt_packet.NO_COMMAND and not (self.opened or self.expected):
                self.wake()
            if not self.live or not self._takes(request):
                return None
            return request, self._next_cycle()
        except IllegalPacketError:
            self._fail(alarms.MXT_PACKET)
        except Refusal as refusal:
            self._fail(refusal.number)
        return None

    def reply(self, request: Request) -> bytes:
        """Return the answer to a datagram; none when the program was halted meanwhile."""
        if not self.live and not (self._ended and request.command == mxt_packet.END):
            return b""
        first, second, third, fourth = (self._data(kind) for kind in request.wanted)
        return mxt_packet.encode(request, self.silent_cycles, (first, second, third, fourth))

    def _takes(self, request: Request) -> bool:
        if request.command == mxt_packet.NO_COMMAND:
            self._accepts = True
            self._find_arm()
            self._bench.begin_stream()
            return True
        if request.command == mxt_packet.END:
            self._accepts = False
            self._heard_s = None
            self._ending = self._lease is not None
            return True
        if not self._accepts:
            return False
        if request.send_type != _SEND_TYPES[self._mode]:
            raise IllegalPacketError(f"data of type {request.send_type}")
        self._find_arm()
        target = self._set_point(request.data)
        self._require(target)
        self._target = target
        return True

    def _find_arm(self) -> None:
        """Begin where the arm is, unless the servo leads it: it may have been moved otherwise."""
        if not (self._ticking and self._leads):
            self._servo = self._servo_here()
            self._leads = True

    def _require(self, target: Joints) -> None:
        if self.controller.alarm:
            raise Refusal(alarms.ALARM_PRESENT)
        if not self.controller.servo_on:
            raise Refusal(alarms.SERVO_IS_OFF)
        for axis, (value, (low, high)) in enumerate(
            zip(target, self.controller.config.limits, strict=True), start=1
        ):
            if value > high + 1e-4:
                raise Refusal(alarms.JOINT_LIMIT_ABOVE + axis)
            if value < low - 1e-4:
                raise Refusal(alarms.JOINT_LIMIT_BELOW + axis)

    def _set_point(self, data: bytes) -> Joints:
        if self._mode == "pulse":
            ratio = self.controller.choices.pulses_per_unit
            j1, j2, j3, j4 = (count / ratio for count in mxt_packet.pulses(data)[:4])
            return (j1, j2, j3, j4)
        one, two, three, four, _, six, *_ = mxt_packet.numbers(data)
        if self._mode == "joint":
            return (math.degrees(one), math.degrees(two), three, math.degrees(four))
        if max(map(abs, (one, two, three, six))) > _FAR:
            raise Refusal(alarms.NO_SOLUTION)
        position = Position(one, two, three, math.degrees(six), *mxt_packet.pose_flags(data))
        return self.controller.joints_of(position, self._servo.command)

    def _next_cycle(self) -> float:
        """Return the bench time of the next cycle, and have it happen."""
        cycle_s = self._options.cycle_s
        due_s = cycle_s * (math.floor(self.controller.bench.time_s / cycle_s + _HAIR_S) + 1)
        if not self._ticking:
            self._ticking = True
            self.controller.bench.call_at(due_s, self._tick)
        return due_s

    def _tick(self) -> None:
        """Do what a cycle of the controller does."""
        self._ticking = False
        if not self.live:
            return
        try:
            self._take_set_point()
            here = self._servo.next()
            if here is not None:
                self.controller.stopped = False
                (self.controller.machine_lock or self._bench).glide(here, self._options.cycle_s)
        except BenchError:
            self._fail(alarms.WHILE_RUNNING)
            return
        except Refusal as refusal:
            self._fail(refusal.number)
            return
        watched = self._heard_s is not None and self._options.timeout_s >= 0.0
        if watched or not self._servo.settled:
            self._next_cycle()
        elif self._ending:
            self._end_lease()

    def _end_lease(self) -> None:
        """Let the program that has the port go on: END has come and the arm stands at the last set point."""
        lease = self._lease
        self.take_back()
        self._ending, self._ended = False, True
        if lease is not None:
            lease()

    def _take_set_point(self) -> None:
        """Hand the last set point to the servo, and watch over the time without any."""
        now_s, cycle_s = self.controller.bench.time_s, self._options.cycle_s
        if self._target is None:
            if self._heard_s is not None and 0.0 <= self._options.timeout_s < now_s - self._heard_s:
                raise Refusal(alarms.MXT_TIMEOUT)
            return
        last_s = now_s - cycle_s if self._heard_s is None else self._heard_s
        self.silent_cycles = max(0, round((now_s - last_s) / cycle_s) - 1)
        speeds = zip(
            self._target, self._servo.command, self.controller.config.dynamics.max_speed, strict=True
        )
        for axis, (new, old, fastest) in enumerate(speeds, start=1):
            if abs(new - old) > fastest * cycle_s:
                raise Refusal(alarms.OVER_SPEED + axis)
        self._servo.command = self._target
        self._target = None
        self._heard_s = now_s

    def _fail(self, number: int) -> None:
        """Let an alarm occur; a program that is halted already notices nothing."""
        if self._lease is not None:
            # It halts the program that has the port, which takes it back.
            self.controller.raise_alarm(number)
            self.take_back()
        elif self.running:
            self.controller.raise_alarm(number)
            self.stage = Stage.HALTED
            self.halted()

    def _servo_here(self) -> ServoModel:
        options = self._options
        return ServoModel(self.controller.arm.joints, options.cycle_s, self._filter_s, options.lags_s)

    def _data(self, kind: int) -> bytes:
        """Return what a type stands for; types that are unknown are null."""
        if kind in {10, 11}:
            return mxt_packet.count_data(self._servo.current_percent(self.controller.config.dynamics))
        sources: dict[int, Joints] = {
            0: self._servo.command,
            1: self._servo.filtered,
            2: self.controller.feedback,
        }
        if not 1 <= kind <= 9:
            return mxt_packet.NO_DATA
        joints = sources[(kind - 1) // 3]
        j1, j2, j3, j4 = joints
        if kind % 3 == _JOINT:
            return mxt_packet.number_data((math.radians(j1), math.radians(j2), j3, math.radians(j4)))
        if kind % 3 == _PULSE:
            ratio = self.controller.choices.pulses_per_unit
            return mxt_packet.count_data(tuple(joint * ratio for joint in joints))
        place = self.controller.position_of(joints)
        values = (place.x_mm, place.y_mm, place.z_mm, 0.0, 0.0, math.radians(place.c_deg))
        return mxt_packet.pose_data(values, place.flag1, place.flag2)


@dataclass
class _Datagram:
    """One that is to be answered.

    Attributes:
        data: its bytes.
        since_s: bench time at which it came.
        taken: what it asks for and when its answer is due; None while it waits for `Mxt`.
    """

    data: bytes
    since_s: float
    taken: tuple[Request, float] | None


class MxtSession(Session):
    """Conversation with one address.

    Args:
        note: called with each command but set points, which are too many.
    """

    def __init__(self, program: Mxt, note: Callable[[str], None]) -> None:
        self._program = program
        self._note = note
        self._due: deque[_Datagram] = deque(maxlen=_MOST_WAITING)
        self._early: _Datagram | None = None

    def feed(self, data: bytes) -> None:
        """Take a datagram."""
        taken = self._program.receive(data)
        if taken is None and not self._program.holds_early:
            return
        datagram = _Datagram(data, self._program.controller.bench.time_s, taken)
        if taken is None:
            self._early = datagram
        self._take(datagram)
        self._due.append(datagram)

    def answer(self) -> Answer | None:
        """Answer the next datagram at its cycle."""
        if not self._due:
            return None
        datagram = self._due.popleft()
        return Pending(lambda: self._due_s(datagram), lambda: self._reply(datagram))

    def _take(self, datagram: _Datagram) -> None:
        if datagram.taken is not None and datagram.taken[0].command != mxt_packet.MOVE:
            self._note(f"MXT command {datagram.taken[0].command}")

    def _due_s(self, datagram: _Datagram) -> float | None:
        now_s = self._program.controller.bench.time_s
        if datagram.taken is None and datagram is self._early:
            if self._program.holds_early and now_s < datagram.since_s + _HELD_S:
                return now_s + _LOOK_S
            # Mxt has begun, the program has ended, or it takes too long.
            self._early = None
            datagram.taken = self._program.receive(datagram.data) if self._program.live else None
            self._take(datagram)
        if datagram.taken is None:
            return None
        due_s = datagram.taken[1]
        return due_s if now_s < due_s else None

    def _reply(self, datagram: _Datagram) -> bytes:
        return b"" if datagram.taken is None else self._program.reply(datagram.taken[0])
