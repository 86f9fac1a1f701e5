"""The program CATSKUKA of the driver, carried out without an interpreter: it moves the arm on the orders of a PC."""

import math
from enum import IntEnum
from functools import partial
from typing import Final

import numpy as np

from catseye.simulators.config import Joints, SerialArm
from catseye.simulators.kuka.arm_control import ArmControl
from catseye.simulators.kuka.kinematics import Kinematics, UnsolvableError
from catseye.simulators.kuka.values import AXES, Structure, Value, e6axis, single
from catseye.simulators.world.serial.held_arm import Begin
from catseye.simulators.world.timekeeper import TimeKeeper
from catseye.simulators.world.types import Floats

CYCLE_S: Final = 0.012
"""Interpolation cycle of a KR C4, in which interrupts are looked for, s."""

HEARTBEAT_S: Final = 0.5
STEP_PERCENT: Final = 1
"""$VEL_AXIS of a step; with $OV_PRO = 10 the 0.1 % of the paper."""

MOVE_PERCENT: Final = 100
LINE_M_S: Final = 0.002
_MOST_KNOTS = 64
_KNOT_MM = 0.05
"""Between two knots of a line the axes turn evenly: on so short a chord the flange leaves it by a nanometre."""


def line_times_s(way_mm: float, override: float) -> Floats:
    """Return when a straight step passes its knots, the last one at its end.

    Args:
        way_mm: length of the step.
        override: part of the programmed speed, above 0, up to 1.

    Returns:
        Times since its start, s, shape (k,).
    """
    duration_s = max(way_mm / (1e3 * LINE_M_S * override), CYCLE_S)
    count = min(_MOST_KNOTS, math.ceil(duration_s / CYCLE_S), max(1, math.ceil(way_mm / _KNOT_MM)))
    return np.asarray(duration_s * np.arange(1, count + 1) / count)


class Order(IntEnum):
    """CATS_CMD."""

    NONE = 0
    AXES = 1
    STEP_AXIS = 2
    STEP_LINE = 3
    STEP_TO = 4


class Result(IntEnum):
    """CATS_RESULT."""

    DONE = 0
    UNDER_WAY = 1
    STOPPED = 2
    NO_HEARTBEAT = 3
    STOP_STANDS = 4
    NOT_PREPARED = 5
    TOO_LARGE = 6
    UNKNOWN = 7


def declarations() -> dict[str, Value]:
    """Return the variables of CATSVARS.dat with their initial values."""
    return {
        "CATS_VERSION": 3,
        "CATS_SEQ": 0,
        "CATS_FOR": 0,
        "CATS_CMD": 0,
        "CATS_AXIS": 0,
        "CATS_INC": 0.0,
        "CATS_X": 0.0,
        "CATS_Y": 0.0,
        "CATS_Z": 0.0,
        "CATS_GOAL": e6axis((0.0,) * len(AXES)),
        "CATS_STOP": False,
        "CATS_BEAT": False,
        "CATS_TAKEN": 0,
        "CATS_DONE": 0,
        "CATS_RESULT": 0,
        "CATS_MOVING": False,
        "CATS_MAX_DEG": 1.0,
        "CATS_MAX_MM": 2.0,
    }


class CatsKuka:
    """The program, on bench time.

    Args:
        arm: that it moves.
        control: of the arm.
        keeper: bench time; a PC's heartbeat lives in real time.

    Attributes:
        variables: its own, by name.
        running: it was started and neither held nor ended.
        selected: the controller has it in its hands; after a cold start it has none.
        at_first_line: it was reset and not started since.
    """

    def __init__(self, arm: SerialArm, control: ArmControl, keeper: TimeKeeper) -> None:
        self.variables = declarations()
        self.running = True
        self.selected = True
        self.at_first_line = False
        self._begins = False
        self._control = control
        self._bench = control.bench
        self._keeper = keeper
        self._kinematics = Kinematics(arm)
        self._alive_until_s = -math.inf
        self._under_way = False
        self._halting = False
        control.on_arrival = partial(self._end, Result.DONE)
        control.on_hold = self._stand

    def written(self) -> None:
        """Take note that a client has written a variable: the program sees it in its next cycle."""
        cycle = math.floor(self._bench.time_s / CYCLE_S) + 1
        self._bench.call_at(cycle * CYCLE_S, self._look)
        self._keeper.stay_awake(self._has_order)

    def reset(self) -> None:
        """Select the first line: the motion under way, or the one that was refused, is given up."""
        self._control.brake()
        self._under_way = self._halting = self.running = False
        self.selected = self.at_first_line = self._begins = True

    def deselect(self) -> None:
        """Have no program selected, as after a cold start."""
        self.reset()
        self.selected = False

    def start(self, *, halts: bool = False) -> None:
        """Go on, as after the start key; a motion that was held is continued, from the first line nothing moves.

        Args:
            halts: behind block coincidence, which only the first start leads to.
        """
        if self.at_first_line and not self._coincides(halts=halts):
            return
        self.running = True
        if self._begins:
            self._begin()
        else:
            self._control.release()
        self.written()

    def _coincides(self, *, halts: bool) -> bool:
        """Do the first motion, to where the arm stands; return whether the program goes on behind it."""
        if not self._control.within_limits(self._bench.joints):
            self._control.refuse_beyond_limits()
            return False
        self.at_first_line = False
        return not halts

    def _begin(self) -> None:
        """Do what stands before the loop: an order from before the start is not carried out."""
        self._begins = False
        number = self.variables["CATS_SEQ"]
        self.variables |= {"CATS_TAKEN": number, "CATS_DONE": number, "CATS_MOVING": False}

    def _stand(self) -> None:
        self.running = False

    def _look(self) -> None:
        if self.running and self._under_way:
            self._watch()
        elif self._has_order():
            self._take()

    def _has_order(self) -> bool:
        return self.running and (
            self._under_way or self.variables["CATS_SEQ"] != self.variables["CATS_TAKEN"]
        )

    def _watch(self) -> None:
        """Do what the interrupts do while the arm moves."""
        if self._halting:
            return
        if self.variables["CATS_STOP"]:
            self._halt(Result.STOPPED)
            return
        if self.variables["CATS_BEAT"]:
            self.variables["CATS_BEAT"] = False
            self._hear()
        if self._bench.time_s >= self._alive_until_s:
            self._halt(Result.NO_HEARTBEAT)

    def _hear(self) -> None:
        self._alive_until_s = self._bench.time_s + HEARTBEAT_S * self._keeper.speed
        self._bench.call_at(self._alive_until_s, self._look)

    def _take(self) -> None:
        number = self._whole("CATS_SEQ")
        result, begin = self._examined(number)
        self.variables["CATS_TAKEN"] = number
        if begin is None:
            self._end(result)
            return
        self.variables |= {"CATS_RESULT": int(Result.UNDER_WAY), "CATS_MOVING": True, "CATS_BEAT": False}
        self._under_way = True
        self._hear()
        self._control.go(begin)

    def _examined(self, number: int) -> tuple[Result, Begin | None]:
        """Return what becomes of an order: a refusal, or how its motion begins."""
        if self.variables["CATS_STOP"]:
            return Result.STOP_STANDS, None
        if self.variables["CATS_FOR"] != number:
            return Result.NOT_PREPARED, None
        match self.variables["CATS_CMD"]:
            case Order.AXES:
                return Result.UNDER_WAY, partial(self._drive, self._goal(), MOVE_PERCENT)
            case Order.STEP_AXIS:
                return self._axis_step()
            case Order.STEP_LINE:
                return self._line_step()
            case Order.STEP_TO:
                return self._step_to()
        return Result.UNKNOWN, None

    def _goal(self) -> Joints:
        goal = self.variables["CATS_GOAL"]
        return tuple(goal.number(axis) for axis in AXES) if isinstance(goal, Structure) else ()

    def _axis_step(self) -> tuple[Result, Begin | None]:
        axis, increment = self._whole("CATS_AXIS") - 1, self._real("CATS_INC")
        if not 0 <= axis < len(AXES):
            return Result.UNKNOWN, None
        if abs(increment) > self._real("CATS_MAX_DEG"):
            return Result.TOO_LARGE, None
        goal = list(self._bench.joints)
        # REALs have 32 bits: what is measured, the increment and their sum.
        goal[axis] = single(single(self._bench.measured[axis]) + increment)
        return Result.UNDER_WAY, partial(self._drive, tuple(goal), STEP_PERCENT)

    def _step_to(self) -> tuple[Result, Begin | None]:
        goal = self._goal()
        if max(abs(to - at) for at, to in zip(self._bench.joints, goal, strict=True)) > self._real(
            "CATS_MAX_DEG"
        ):
            return Result.TOO_LARGE, None
        return Result.UNDER_WAY, partial(self._drive, goal, STEP_PERCENT)

    def _line_step(self) -> tuple[Result, Begin | None]:
        increment = np.array([self._real(name) for name in ("CATS_X", "CATS_Y", "CATS_Z")])
        if np.linalg.norm(increment) > self._real("CATS_MAX_MM"):
            return Result.TOO_LARGE, None
        goal = self._kinematics.stepped(self._bench.measured, increment)
        return Result.UNDER_WAY, partial(self._lead, goal)

    def _drive(self, goal: Joints, percent: int, override: float) -> None:
        if not self._control.within_limits(goal):
            self._control.refuse_beyond_limits()
            return
        self._bench.move_to(goal, percent * override)

    def _lead(self, goal: Floats, override: float) -> None:
        start = self._bench.joints
        way_mm = float(np.linalg.norm(goal[:3, 3] - self._kinematics.flange(start)[:3, 3]))
        times_s = line_times_s(way_mm, override)
        try:
            knots = self._kinematics.line(start, goal, times_s.size)
        except UnsolvableError:
            self._control.refuse_beyond_limits()
            return
        if not all(map(self._control.within_limits, knots.tolist())):
            self._control.refuse_beyond_limits()
            return
        self._bench.follow(times_s, knots)

    def _halt(self, result: Result) -> None:
        """BRAKE, and RESUME once the arm stands."""
        self._halting = True
        self._bench.call_at(self._control.brake(), partial(self._halted, result))

    def _halted(self, result: Result) -> None:
        # A reset meanwhile has given the order up.
        if self._halting:
            self._end(result)

    def _end(self, result: Result) -> None:
        self._under_way = self._halting = False
        taken = self.variables["CATS_TAKEN"]
        self.variables |= {"CATS_RESULT": int(result), "CATS_MOVING": False, "CATS_DONE": taken}
        self.written()

    def _whole(self, name: str) -> int:
        return int(self._real(name))

    def _real(self, name: str) -> float:
        value = self.variables[name]
        return float(value) if isinstance(value, int | float) else math.nan
