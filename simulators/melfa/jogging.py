"""JOG with its dead-man (sheet, section 1.9): the arm moves while telegrams come, and stops when they stay away.

Joints turn at their own jog speeds until the first one reaches its limit. Along axes of space (`jog_ways`) the tool
goes straight at the jog speed of `Choices`, as far as joint limits and reach permit.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from catseye.simulators.config import Joints
from catseye.simulators.melfa import alarms, paths
from catseye.simulators.melfa.arm_control import ArmControl, Run
from catseye.simulators.melfa.jog_ways import SpaceAxes, even_rates, jog_rates, way_along
from catseye.simulators.world.types import Floats

DEAD_MAN_S = 0.140
"""Bench time after which a jog ends that is not repeated."""

_ARRIVED = 1e-9
_NEAR_LIMIT = 1e-6
_BACK = 0.01
"""Step back, mm or deg, that shows which way the joints have come."""


class Way(Protocol):
    """What a telegram asks for; equal to that of a telegram that asks for the same."""

    def start(self, control: ArmControl) -> Run | None:
        """Start towards the end of what the arm can do; None where it is there already."""
        ...

    def inch(self, control: ArmControl, step: float) -> Run | None:
        """Start one step, deg or mm; None where there is none."""
        ...

    def limit(self, control: ArmControl) -> int:
        """Return the alarm of an arm that can go no further."""
        ...


@dataclass(frozen=True)
class JointWay:
    """Joints that turn.

    Attributes:
        directions: of J1 to J4: -1, 0 or 1.
    """

    directions: tuple[int, ...]

    def start(self, control: ArmControl) -> Run | None:
        """See `Way`."""
        target = self._to_the_limit(control)
        if all(abs(a - b) < _ARRIVED for a, b in zip(target, control.arm.joints, strict=True)):
            return None
        return control.start(target, _percent(control))

    def inch(self, control: ArmControl, step: float) -> Run | None:
        """See `Way`; at a limit the step is shorter."""
        here = zip(control.arm.joints, self.directions, control.config.limits, strict=True)
        j1, j2, j3, j4 = (min(max(at + way * step, low), high) for at, way, (low, high) in here)
        return control.start((j1, j2, j3, j4), _percent(control))

    def limit(self, control: ArmControl) -> int:
        """See `Way`."""
        return _joint_limit(control, self.directions)

    def _to_the_limit(self, control: ArmControl) -> Joints:
        config = control.config
        speeds = config.dynamics.max_speed
        axes = list(zip(control.arm.joints, self.directions, speeds, config.limits, strict=True))
        left = [
            max(0.0, (high - at) if way > 0 else (at - low)) / speed
            for at, way, speed, (low, high) in axes
            if way
        ]
        j1, j2, j3, j4 = (at + way * speed * min(left) for at, way, speed, _ in axes)
        return (j1, j2, j3, j4)


@dataclass(frozen=True)
class SpaceWay:
    """A tool that goes along axes of space.

    Attributes:
        axes: which ones.
        directions: along and about them, of X, Y, Z, A, B and C: -1, 0 or 1.
    """

    axes: SpaceAxes
    directions: tuple[int, ...]

    def start(self, control: ArmControl) -> Run | None:
        """See `Way`."""
        speed_mm_s = control.override_percent / 100.0 * control.choices.jog_mm_s
        turn_deg_s = _percent(control) / 100.0 * control.config.dynamics.max_speed[3]
        rates = jog_rates(control, self.axes, self.directions, speed_mm_s, turn_deg_s)
        ramp_s = speed_mm_s / control.choices.path_mm_s2
        return _led(control, *way_along(control, self.axes, rates), 1.0, 1.0 / ramp_s)

    def inch(self, control: ArmControl, step: float) -> Run | None:
        """See `Way`; where the arm can go less far, the step is shorter."""
        speed_mm_s = control.override_percent / 100.0 * control.choices.jog_mm_s
        way = way_along(control, self.axes, even_rates(self.axes, self.directions), step)
        return _led(control, *way, speed_mm_s, control.choices.path_mm_s2)

    def limit(self, control: ArmControl) -> int:
        """See `Way`; where no joint goes beyond its limit, the arm cannot reach further."""
        back = even_rates(self.axes, tuple(-way for way in self.directions))
        _, knots = way_along(control, self.axes, back, _BACK)
        if not len(knots):
            return alarms.NO_SOLUTION
        steps = np.array(control.arm.joints) - knots[-1]
        moved = np.where(np.abs(steps) > _NEAR_LIMIT, np.sign(steps), 0.0)
        return _joint_limit(control, [int(way) for way in moved]) or alarms.NO_SOLUTION


def _led(
    control: ArmControl, advanced: Floats, knots: Floats, speed: float, acceleration: float
) -> Run | None:
    """Start a motion through knots, no joint faster than the override permits; None where there is no way to go."""
    if not advanced.size:
        return None
    share = control.override_percent / 100.0
    fastest = [share * one for one in control.config.dynamics.max_speed]
    all_knots = np.vstack([control.arm.joints, knots])
    times_s = paths.jogging_times_s(np.append(0.0, advanced), all_knots, speed, acceleration, fastest)
    j1, j2, j3, j4 = knots[-1].tolist()
    return control.follow(times_s, knots, (j1, j2, j3, j4))


class Jog:
    """Jog of one arm."""

    def __init__(self, controller: ArmControl) -> None:
        self._controller = controller
        self._way: Way | None = None
        self._until_s = 0.0
        self._run: Run | None = None

    def go(self, way: Way | None) -> None:
        """Take one telegram; None: nothing is to move.

        Raises:
            Refusal: the controller or the arm is not in a state to move.
        """
        controller, now_s = self._controller, self._controller.bench.time_s
        if self._run is not None and controller.arm.moving:
            if way is not None and way == self._way:
                self._until_s = now_s + DEAD_MAN_S
            else:
                # A new direction begins with the next telegram after standstill.
                self._end()
            return
        controller.require_ready()
        if way is None:
            return
        self._way, self._until_s = way, now_s + DEAD_MAN_S
        self._start(way)

    def inch(self, way: Way | None, step: float) -> None:
        """Move by one step, deg or mm; a telegram that comes during a step is taken for nothing."""
        controller = self._controller
        if self._run is not None and controller.arm.moving:
            return
        controller.require_ready()
        if way is None:
            return
        self._way, self._run = None, way.inch(controller, step)
        if self._run is not None:
            self._until_s = self._run.end_s

    def forget(self) -> None:
        """Take note that something else has stopped the arm."""
        self._run = None

    def _start(self, way: Way) -> None:
        run = way.start(self._controller)
        if run is None:
            self._hit_limit(way)
            return
        self._run = run
        self._look_again(way, run)

    def _look_again(self, way: Way, run: Run) -> None:
        self._controller.bench.call_at(min(self._until_s, run.end_s), lambda: self._look(way, run))

    def _look(self, way: Way, run: Run) -> None:
        """Stop, unless a telegram has come meanwhile; at the limit raise its alarm."""
        if self._run is not run:
            return
        bench = self._controller.bench
        if self._controller.arm.joints == run.target:
            self._hit_limit(way)
        elif bench.time_s < self._until_s:
            self._look_again(way, run)
        else:
            self._end()

    def _end(self) -> None:
        self._until_s = self._controller.bench.time_s
        self._controller.arm.stop()

    def _hit_limit(self, way: Way) -> None:
        if number := way.limit(self._controller):
            self._controller.raise_alarm(number)


def _percent(control: ArmControl) -> float:
    return control.override_percent * control.choices.jog_percent / 100.0


def _joint_limit(control: ArmControl, directions: Sequence[int]) -> int:
    """Return the alarm of the first joint that stands at the limit in whose direction it goes, 0 for none."""
    axes = zip(control.arm.joints, directions, control.config.limits, strict=True)
    for axis, (at, way, (low, high)) in enumerate(axes, start=1):
        if way > 0 and abs(at - high) < _NEAR_LIMIT:
            return alarms.JOINT_LIMIT_ABOVE + axis
        if way < 0 and abs(at - low) < _NEAR_LIMIT:
            return alarms.JOINT_LIMIT_BELOW + axis
    return 0
