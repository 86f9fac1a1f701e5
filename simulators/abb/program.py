"""The module CATSABB of the driver, carried out without an interpreter: it moves the arm on the orders of a PC."""

from collections.abc import Callable
from enum import IntEnum
from functools import partial
from typing import Final

from catseye.simulators.abb.arm_control import ArmControl
from catseye.simulators.abb.rapid import UNUSED, Value
from catseye.simulators.config import Joints, SerialArm
from catseye.simulators.world.timekeeper import TimeKeeper

MODULE: Final = "CATSABB"
TASK: Final = "T_ROB1"
POLL_S: Final = 0.04
"""How often WaitUntil looks, s."""

TICK_S: Final = 0.1
"""Of the timer whose trap looks for signs of life, s; the shortest that ITimer has."""

MOST_MISSED: Final = 4
"""Ticks without a new sign after which the arm is stopped: 0.4 to 0.5 s after the last one."""

_JOINTS: Final = 6
_OUT_OF_RANGE: Final = 50027
"""Event of a goal beyond the range of a joint."""


class Result(IntEnum):
    """cats_result."""

    DONE = 0
    UNDER_WAY = 1
    NOT_PREPARED = 2
    NO_HEARTBEAT = 3


def declarations() -> dict[str, Value]:
    """Return the persistent data of the module with their initial values."""
    return {
        "cats_version": 1.0,
        "cats_seq": 0.0,
        "cats_for": 0.0,
        "cats_goal": [[0.0] * _JOINTS, [UNUSED] * _JOINTS],
        "cats_beat": 0.0,
        "cats_taken": 0.0,
        "cats_done": 0.0,
        "cats_result": 0.0,
    }


class CatsAbb:
    """The program, on bench time.

    Args:
        arm: that it moves.
        control: of the arm.
        keeper: bench time; a PC's heartbeat lives in real time.
        note: called with number and text of an event.

    Attributes:
        data: its own, by name.
        running: it was started and has not been stopped since.
    """

    def __init__(
        self,
        arm: SerialArm,
        control: ArmControl,
        keeper: TimeKeeper,
        note: Callable[[int, str], None],
    ) -> None:
        self.data = declarations()
        self.running = True
        self._arm = arm
        self._control = control
        self._bench = control.bench
        self._keeper = keeper
        self._note = note
        self._at_main = False
        self._under_way = False
        self._halting = False
        self._heard: Value = 0.0
        self._missed = 0
        self._order = 0
        control.on_arrival = partial(self._end, Result.DONE)
        control.on_hold = self._stand

    def written(self) -> None:
        """Take note that a client has written data: the program sees it when it looks next."""
        self._bench.call_at(self._bench.time_s + POLL_S, self._look)
        self._keeper.stay_awake(self._has_order)

    def reset_pointer(self) -> None:
        """Set the program pointer to main: what was under way is given up."""
        self._at_main = True
        self._under_way = self._halting = False
        self._order += 1
        self._control.brake()

    def start(self) -> None:
        """Go on; a motion that was stopped is continued, from main nothing moves."""
        self.running = True
        if self._at_main:
            self._at_main = False
            self.data["cats_taken"] = self.data["cats_done"] = self.data["cats_seq"]
        else:
            self._control.release()
            if self._under_way:
                self._listen(self._order)
        self.written()

    def _stand(self) -> None:
        if self.running:
            self._note(10125, "Program stopped")
        self.running = False

    def _has_order(self) -> bool:
        return self.running and (self._under_way or self.data["cats_seq"] != self.data["cats_taken"])

    def _look(self) -> None:
        if self._under_way or not self._has_order():
            return
        if self._bench.moving:
            self._bench.call_at(self._bench.standstill_s, self._look)
        else:
            self._take()

    def _take(self) -> None:
        number = self.data["cats_seq"]
        self.data |= {"cats_result": float(Result.UNDER_WAY), "cats_taken": number}
        if self.data["cats_for"] != number:
            self._end(Result.NOT_PREPARED)
            return
        self._under_way = True
        self._order += 1
        self._heard, self._missed = self.data["cats_beat"], 0
        self._control.go(partial(self._drive, self._goal()))
        self._listen(self._order)

    def _goal(self) -> Joints:
        goal = self.data["cats_goal"]
        arm = goal[0] if isinstance(goal, list) else []
        return tuple(value for value in arm if isinstance(value, float)) if isinstance(arm, list) else ()

    def _drive(self, goal: Joints, override: float) -> None:
        """MoveAbsJ at the largest speed, of which the speed ratio leaves a part."""
        ranges = zip(goal, self._arm.joints, strict=True)
        if all(joint.low <= value <= joint.high for value, joint in ranges):
            self._bench.move_to(goal, 100.0 * override)
            return
        self._note(_OUT_OF_RANGE, "Joint out of range")
        self._control.brake()
        self._control.hold()

    def _listen(self, order: int) -> None:
        """Have the trap of the timer look, for as long as an order is under way."""
        self._bench.call_at(self._bench.time_s + TICK_S * self._keeper.speed, partial(self._tick, order))

    def _tick(self, order: int) -> None:
        if order != self._order or not self.running or not self._under_way or self._halting:
            return
        if self.data["cats_beat"] != self._heard:
            self._heard, self._missed = self.data["cats_beat"], 0
        else:
            self._missed += 1
        if self._missed >= MOST_MISSED:
            self._halt()
        else:
            self._listen(order)

    def _halt(self) -> None:
        """StopMove and ClearPath, and the error that ends the order once the arm stands."""
        self._halting = True
        self._bench.call_at(self._control.brake(), partial(self._halted, self._order))

    def _halted(self, order: int) -> None:
        if order == self._order:
            self._end(Result.NO_HEARTBEAT)

    def _end(self, result: Result) -> None:
        self._under_way = self._halting = False
        self._order += 1
        self.data |= {"cats_result": float(result), "cats_done": self.data["cats_taken"]}
        self.written()
