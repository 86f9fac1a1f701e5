"""What the controller does with its arm: servo, alarms, stop, overrides, motion; and the variables it moves by."""

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from catseye.simulators.config import EmulationConfig, Joints
from catseye.simulators.melfa import alarms, paths
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.choices import Choices
from catseye.simulators.melfa.frames import Frames
from catseye.simulators.melfa.machine_lock import CommandedArm, LockedArm
from catseye.simulators.melfa.open_files import RealTimePort
from catseye.simulators.melfa.signals import Signals
from catseye.simulators.melfa.values import Position, Variable, joints_of, position_of, rounded, within_limits
from catseye.simulators.world.timed_bench import TimedBench
from catseye.simulators.world.types import Floats

_SPEED_STEP_S = 1e-3
"""Speeds are taken over this time."""


@dataclass
class Run:
    """One motion that a client may wait for.

    Attributes:
        end_s: bench time of its standstill, s.
        target: joints at its end, unless it is interrupted.
        interrupted_by: error number that ended it early, 0 for none.
    """

    end_s: float
    target: Joints = (0.0, 0.0, 0.0, 0.0)
    interrupted_by: int = 0


@dataclass(frozen=True)
class LogLine:
    """One line of the error log: bench time, s, and error number."""

    time_s: float
    number: int


class ArmControl:
    """The controller's hold on the arm.

    Args:
        config: limits, nominal links, delays.
        changed: called when a motion ends at another moment than it would have.
        choices: what no source says of a controller.

    Attributes:
        real_time: the port for real-time control; None on a bench without one.
        on_interrupt: called with the error number when something stops the arm, before it stops.
    """

    def __init__(
        self,
        bench: TimedBench,
        config: EmulationConfig,
        changed: Callable[[], None],
        choices: Choices | None = None,
    ) -> None:
        self.bench = bench
        self.config = config
        self.choices = choices or Choices()
        self.emergency_stop = False
        self._start_anew()
        self.log: deque[LogLine] = deque(maxlen=128)
        self._changed = changed
        self.real_time: RealTimePort | None = None
        self._servo_from_s: float | None = None
        self._run = Run(0.0)
        self.on_interrupt: list[Callable[[int], None]] = []

    def _start_anew(self) -> None:
        """Set whatever is as it is after power on."""
        self.override_percent = 100
        self.program_override_percent: float = 100.0
        self.joint_override_percent: float = 100.0
        self.linear_speed_mm_s: float = 10_000.0
        self.accel_percent = 100.0
        self.signals = Signals()
        self.tool: int = 0
        self.frames = Frames(base_places_world=self.choices.base_places_world)
        self.alarm: int = 0
        self.caution: int = 0
        self.start_enabled = True
        self.stop_latched = False
        self.stopped = True
        self.variables: dict[str, Variable] = {}
        self._locked: LockedArm | None = None

    @property
    def program_running(self) -> bool:
        """A program is carried out line by line."""
        return False

    @property
    def alarm_shown(self) -> int:
        """The alarm that ERROR answers: the active one, else a caution that nobody has reset."""
        return self.alarm or self.caution

    @property
    def machine_lock(self) -> LockedArm | None:
        """What stands for the arm while the machine is locked, None while it is not."""
        return self._locked

    @property
    def arm(self) -> CommandedArm:
        """What motions lead: the arm, unless the machine is locked."""
        return self._locked or self.bench

    @property
    def shown_joints(self) -> Joints:
        """Joints as the controller tells them at this moment, deg or mm."""
        return self.arm.joints if self.choices.lock_shows_commands else self.bench.joints

    def lock_machine(self, *, on: bool) -> None:
        """Let motions be carried out without the arm, or with it again.

        Raises:
            Refusal: something moves.
        """
        if on == (self._locked is not None):
            return
        if self.arm.moving:
            raise Refusal(alarms.WHILE_RUNNING)
        self._locked = LockedArm(self.bench, self.config.dynamics) if on else None

    @property
    def servo_on(self) -> bool:
        """The drives hold the arm."""
        return self._servo_from_s is not None and self.bench.time_s >= self._servo_from_s

    def switch_servo_on(self) -> None:
        """Start to power the drives; they hold after the configured delay."""
        if self.emergency_stop:
            raise Refusal(alarms.SERVO_ON_IMPOSSIBLE)
        if self.alarm:
            raise Refusal(alarms.ALARM_PRESENT)
        if self._servo_from_s is None:
            self._servo_from_s = self.bench.time_s + self.config.dynamics.servo_delay_s

    def switch_servo_off(self, number: int = alarms.SERVO_IS_OFF) -> None:
        """Stop the arm and take the power off; a waiting client gets the number."""
        self.interrupt(number)
        self._servo_from_s = None

    def move(self, target: Joints | Position) -> Run:
        """Start a joint-interpolated motion.

        Raises:
            Refusal: the controller or the arm is not in a state to move, or the target is not permitted.
        """
        self.require_ready()
        joints = target if not isinstance(target, Position) else self.joints_of(target, self.arm.joints)
        joints = rounded(joints)
        if not within_limits(joints, self.config):
            raise Refusal(alarms.DESTINATION_OUT_OF_RANGE)
        return self.start(joints, self.effective_percent)

    def move_along(self, *sections: Floats) -> Run:
        """Start a motion of the tool along a way at the speed of SPD, at rest between its sections.

        Args:
            sections: places of the tool, each without the start; see `catseye.simulators.melfa.paths`.

        Raises:
            Refusal: the controller or the arm is not in a state to move, or the way is not permitted.
        """
        self.require_ready()
        percent = self.override_percent * self.program_override_percent / 1e4
        fastest = [percent * speed for speed in self.config.dynamics.max_speed]
        acceleration = self.choices.path_mm_s2 * self.accel_percent / 100.0
        here, place = self.arm.joints, self.position()
        spot, began_s = np.array([place.x_mm, place.y_mm, place.z_mm]), 0.0
        times_s, knots = [], []
        for way in sections:
            joints = paths.joints_along(self.frames.flanges(way), here, place.flag1, self.config)
            spots = np.vstack([spot, way[:, :3]])
            speed_mm_s = percent * self.linear_speed_mm_s
            passed_s = paths.passing_times_s(
                spots, np.vstack([here, joints]), speed_mm_s, acceleration, fastest
            )
            times_s.append(began_s + passed_s)
            knots.append(joints)
            j1, j2, j3, j4 = joints[-1].tolist()
            here, spot, began_s = (j1, j2, j3, j4), spots[-1], began_s + float(passed_s[-1])
        return self.follow(np.concatenate(times_s), np.concatenate(knots), here)

    def start(self, joints: Joints, percent: float) -> Run:
        """Start a motion that is permitted, at a speed in per cent of the largest."""
        self.arm.move_to(joints, percent, self.accel_percent)
        self._run = Run(self.arm.standstill_s, joints)
        return self._run

    def follow(self, times_s: Floats, joints: Floats, target: Joints) -> Run:
        """Start a motion through knots that is permitted; see `Bench.follow`."""
        if times_s.size:
            self.arm.follow(times_s, joints)
        self._run = Run(self.arm.standstill_s, target)
        return self._run

    def wait(self, seconds: float) -> Run:
        """Stand still for a while; what waits for the end of a motion waits for that of the delay."""
        return Run(self.bench.time_s + seconds, self.arm.joints)

    @property
    def effective_percent(self) -> float:
        """Speed of joint motions: panel override times program overrides."""
        return self.override_percent * self.program_override_percent * self.joint_override_percent / 1e4

    def stop(self) -> None:
        """Stop the motion; a client that waits for it gets an error."""
        self.stopped = True
        self.interrupt(alarms.STOP_IS_ON)

    def raise_alarm(self, number: int) -> None:
        """Let an alarm occur: the arm stops, one of high level switches the servo off too."""
        self.log.append(LogLine(self.bench.time_s, number))
        if alarms.level(number) == alarms.CAUTION:
            self.caution = number
            return
        self.alarm = number
        if alarms.level(number) == alarms.HIGH:
            self.switch_servo_off(number)
        else:
            self.interrupt(number)

    def set_emergency_stop(self, *, on: bool) -> None:
        """Open or close the emergency stop circuit; its alarm stays until it is reset."""
        self.emergency_stop = on
        if on:
            self.raise_alarm(alarms.EMERGENCY_STOP)

    def reset_alarm(self) -> None:
        """Clear alarm and caution.

        Raises:
            Refusal: its cause, the open emergency stop circuit, is still there.
        """
        if self.emergency_stop:
            raise Refusal(alarms.EMERGENCY_STOP)
        self.alarm = self.caution = 0

    def position(self) -> Position:
        """Return the nominal position of the tool's end at the commanded joints."""
        return self.position_of(self.arm.joints)

    def position_of(self, joints: Joints) -> Position:
        """Return the nominal position of the tool's end at joints."""
        return self.frames.seen(position_of(joints, self.config))

    def joints_of(self, position: Position, near: Joints) -> Joints:
        """Return the joints that bring the tool's end there, J4 on the branch nearest to a pose.

        Raises:
            Refusal: the position is out of reach.
        """
        return joints_of(self.frames.flange(position), near, self.config)

    def changed(self) -> None:
        """Let everybody who waits for something look again."""
        self._changed()

    def tool_speed_mm_s(self) -> float:
        """Return the speed of the tool's end at this moment, mm/s: as commanded, of the nominal arm; locked, 0."""
        now_s = self.bench.time_s
        step_s = min(_SPEED_STEP_S, self.bench.standstill_s - now_s)
        if step_s <= 0.0:
            return 0.0
        here, there = (self.position_of(self.bench.joints_at(at_s)) for at_s in (now_s, now_s + step_s))
        return math.dist((here.x_mm, here.y_mm, here.z_mm), (there.x_mm, there.y_mm, there.z_mm)) / step_s

    @property
    def feedback(self) -> Joints:
        """Joints as the encoders count them, deg or mm; they sit before the gears."""
        if self.bench.counts_encoders:
            return self.bench.measured
        ratio = self.choices.pulses_per_unit
        return tuple(round(value * ratio) / ratio for value in self.bench.measured)

    def require_start(self) -> None:
        """Raise a refusal unless a program may start.

        Raises:
            Refusal: an alarm is active, a STOP is on, or the start is disabled.
        """
        if self.alarm:
            raise Refusal(alarms.ALARM_PRESENT)
        if self.stop_latched:
            raise Refusal(alarms.STOP_IS_ON)
        if not self.start_enabled:
            raise Refusal(alarms.START_DISABLED)

    def require_ready(self) -> None:
        """Raise a refusal unless the arm may move.

        Raises:
            Refusal: an alarm is active, the servo is off, a STOP is on, or the arm moves already.
        """
        if self.alarm:
            raise Refusal(alarms.ALARM_PRESENT)
        if not self.servo_on:
            raise Refusal(alarms.SERVO_IS_OFF)
        if self.stop_latched:
            raise Refusal(alarms.STOP_IS_ON)
        if self.arm.moving:
            raise Refusal(alarms.WHILE_RUNNING)

    def interrupt(self, number: int) -> None:
        """Stop the arm and everything that moves it; a waiting client gets the error number."""
        for listener in self.on_interrupt:
            listener(number)
        if not self.arm.moving:
            return
        self.arm.stop()
        self._run.end_s = self.arm.standstill_s
        self._run.interrupted_by = self._run.interrupted_by or number
        self._changed()
