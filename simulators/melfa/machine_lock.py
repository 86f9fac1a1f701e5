"""Machine lock (sheet, sections 1.9 and 1.10): motions take their time and the arm stands.

The sheet says that MLOCKON and MLOCKOFF need no operation right and that STATE shows the lock. It does not say what
the controller tells of positions meanwhile: see `Choices`. Assumed are that nothing but the motion differs (servo,
limits and alarms stay as they are), that the lock cannot be switched while something moves or leads the arm (5640),
and that with its end the controller counts from where the arm is.
"""

from typing import Protocol

from catseye.simulators.config import ArmDynamics, Joints
from catseye.simulators.errors import BenchError
from catseye.simulators.world.motion import STANDSTILL, Motion, plan_glide, plan_motion, plan_stop, plan_way
from catseye.simulators.world.timed_bench import TimedBench
from catseye.simulators.world.types import Floats


class CommandedArm(Protocol):
    """What a controller leads: the arm, or what stands for it while the machine is locked. See `TimedBench`."""

    @property
    def joints(self) -> Joints:
        """Joints as commanded at this moment, deg or mm."""
        ...

    @property
    def destination(self) -> Joints:
        """Joints as commanded at the end of the present motion, deg or mm."""
        ...

    @property
    def moving(self) -> bool:
        """A motion is under way."""
        ...

    @property
    def standstill_s(self) -> float:
        """Bench time at which the present or last motion ends, s."""
        ...

    def move_to(self, target: Joints, override_percent: float = 100.0, accel_percent: float = 100.0) -> None:
        """Start a joint-interpolated motion."""
        ...

    def follow(self, times_s: Floats, joints: Floats) -> None:
        """Start a motion through knots."""
        ...

    def stop(self) -> None:
        """Decelerate to standstill."""
        ...


class LockedArm:
    """Stands for the arm while the machine is locked.

    Args:
        bench: of the arm, which is left alone; it gives the time.
    """

    def __init__(self, bench: TimedBench, dynamics: ArmDynamics) -> None:
        self._bench = bench
        self._dynamics = dynamics
        self._motion = Motion.straight(bench.joints, bench.joints, bench.time_s, STANDSTILL)

    @property
    def joints(self) -> Joints:
        """Joints as commanded at this moment, deg or mm."""
        return self._motion.joints_at(self._bench.time_s)

    @property
    def destination(self) -> Joints:
        """Joints as commanded at the end of the present motion, deg or mm."""
        return self._motion.end

    @property
    def moving(self) -> bool:
        """A motion is carried out, if only in the controller."""
        return self._bench.time_s < self._motion.end_s

    @property
    def standstill_s(self) -> float:
        """Bench time at which the present or last motion ends, s."""
        return self._motion.end_s

    def move_to(self, target: Joints, override_percent: float = 100.0, accel_percent: float = 100.0) -> None:
        """Start a joint-interpolated motion.

        Raises:
            BenchError: one is under way already.
        """
        here = self._rest()
        shares = override_percent / 100.0, accel_percent / 100.0
        self._motion = plan_motion(here, target, self._bench.time_s, self._dynamics, *shares)

    def follow(self, times_s: Floats, joints: Floats) -> None:
        """Start a motion through knots.

        Raises:
            BenchError: one is under way already.
        """
        self._motion = plan_way(self._rest(), times_s, joints, self._bench.time_s)

    def glide(self, target: Joints, duration_s: float) -> None:
        """Do one cycle of real-time control; a glide that comes early leaves the one before where it is."""
        self._motion = plan_glide(self.joints, target, self._bench.time_s, duration_s)

    def stop(self) -> None:
        """Decelerate to standstill; without a motion nothing happens."""
        if self.moving:
            self._motion = plan_stop(self._motion, self._bench.time_s, self._dynamics)

    def _rest(self) -> Joints:
        if self.moving:
            raise BenchError("the arm moves already")
        return self.joints
