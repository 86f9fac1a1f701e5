"""JOG with its dead-man (sheet, section 1.9): the arm moves while telegrams come, and stops when they stay away."""

from catseye.simulators.config import Joints
from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.arm_control import ArmControl, Run

DEAD_MAN_S = 0.140
"""Bench time after which a jog ends that is not repeated."""

_ARRIVED = 1e-9


class Jog:
    """Joint jog of one arm. All axes move at their own jog speed until the first one reaches its limit."""

    def __init__(self, controller: ArmControl) -> None:
        self._controller = controller
        self._directions: tuple[int, ...] = ()
        self._until_s = 0.0
        self._run: Run | None = None

    def go(self, directions: tuple[int, int, int, int]) -> None:
        """Take one telegram.

        Args:
            directions: of J1 to J4: -1, 0 or 1.

        Raises:
            Refusal: the controller or the arm is not in a state to move.
        """
        controller, now_s = self._controller, self._controller.bench.time_s
        if self._run is not None and controller.bench.moving:
            if directions == self._directions:
                self._until_s = now_s + DEAD_MAN_S
            else:
                # A new direction begins with the next telegram after standstill.
                self._end()
            return
        controller.require_ready()
        if not any(directions):
            return
        self._directions, self._until_s = directions, now_s + DEAD_MAN_S
        self._start()

    def inch(self, directions: tuple[int, int, int, int], step: float) -> None:
        """Move by one step, deg or mm; a telegram that comes during a step is taken for nothing."""
        controller = self._controller
        if self._run is not None and controller.bench.moving:
            return
        controller.require_ready()
        if not any(directions):
            return
        here = zip(controller.bench.joints, directions, controller.config.limits, strict=True)
        j1, j2, j3, j4 = (min(max(at + way * step, low), high) for at, way, (low, high) in here)
        self._run = controller.start((j1, j2, j3, j4), self._percent)
        self._directions, self._until_s = (), self._run.end_s

    def forget(self) -> None:
        """Take note that something else has stopped the arm."""
        self._run = None

    @property
    def _percent(self) -> float:
        return self._controller.override_percent * self._controller.choices.jog_percent / 100.0

    def _start(self) -> None:
        controller = self._controller
        target = self._to_the_limit()
        if all(abs(a - b) < _ARRIVED for a, b in zip(target, controller.bench.joints, strict=True)):
            self._hit_limit()
            return
        self._run = run = controller.start(target, self._percent)
        self._look_again(run)

    def _to_the_limit(self) -> Joints:
        config, here = self._controller.config, self._controller.bench.joints
        speeds = config.dynamics.max_speed
        axes = list(zip(here, self._directions, speeds, config.limits, strict=True))
        left = [
            max(0.0, (high - at) if way > 0 else (at - low)) / speed
            for at, way, speed, (low, high) in axes
            if way
        ]
        j1, j2, j3, j4 = (at + way * speed * min(left) for at, way, speed, _ in axes)
        return (j1, j2, j3, j4)

    def _look_again(self, run: Run) -> None:
        self._controller.bench.call_at(min(self._until_s, run.end_s), lambda: self._look(run))

    def _look(self, run: Run) -> None:
        """Stop, unless a telegram has come meanwhile; at the limit raise its alarm."""
        if self._run is not run:
            return
        bench = self._controller.bench
        if bench.joints == run.target:
            self._hit_limit()
        elif bench.time_s < self._until_s:
            self._look_again(run)
        else:
            self._end()

    def _end(self) -> None:
        self._until_s = self._controller.bench.time_s
        self._controller.bench.stop()

    def _hit_limit(self) -> None:
        config = self._controller.config
        axes = zip(self._controller.bench.joints, self._directions, config.limits, strict=True)
        for axis, (at, way, (low, high)) in enumerate(axes, start=1):
            if way and abs(at - (high if way > 0 else low)) < 1e-6:
                above = alarms.JOINT_LIMIT_ABOVE if way > 0 else alarms.JOINT_LIMIT_BELOW
                self._controller.raise_alarm(above + axis)
                return
