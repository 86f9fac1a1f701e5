"""What a controller needs of a serial arm and its drives, and the arm that does exactly what it is commanded."""

from typing import Protocol

from catseye.simulators.config import ArmDynamics, Joints, SerialArm
from catseye.simulators.world.motion import STANDSTILL, Motion, plan_motion, plan_stop, plan_way
from catseye.simulators.world.types import Floats


class SerialPlant(Protocol):
    """The arm and its drives; what they do is a function of bench time within one motion and the rest after it.

    All joints are in the order of the arm description, deg or mm.
    """

    @property
    def motion(self) -> Motion:
        """The present motion as the controller commands it, and the rest that follows it."""
        ...

    def move_to(self, target: Joints, time_s: float, speed_fraction: float) -> None:
        """Start a synchronous motion of all axes at a bench time at which none is commanded.

        Args:
            target: command, from where the last command ended.
            time_s: bench time, s.
            speed_fraction: part of the largest speeds, above 0, up to 1.
        """
        ...

    def follow(self, times_s: Floats, joints: Floats, time_s: float) -> None:
        """Start a motion through knots, straight and at constant speed from one to the next; see `plan_way`."""
        ...

    def brake(self, time_s: float) -> None:
        """Decelerate to a standstill on the path as fast as the drives can."""
        ...

    def measured(self, time_s: float) -> Joints:
        """Return what the encoders show, counted out to the joints."""
        ...

    def true_joints(self, time_s: float) -> Joints:
        """Return where the links really are."""
        ...

    def torques_nm(self, time_s: float) -> tuple[float, ...]:
        """Return the torques of the drives at the joints, N m."""
        ...


class IdealArm:
    """An arm whose links stand where they are commanded to, without weight and without friction.

    Args:
        arm: axes with their speeds.
        start: joints at bench time 0.
    """

    def __init__(self, arm: SerialArm, start: Joints) -> None:
        self.motion = Motion.straight(start, start, 0.0, STANDSTILL)
        self._dynamics = ArmDynamics(
            tuple(joint.speed for joint in arm.joints), tuple(joint.acceleration for joint in arm.joints)
        )

    def move_to(self, target: Joints, time_s: float, speed_fraction: float) -> None:
        """Start a synchronous motion of all axes."""
        self.motion = plan_motion(
            self.motion.joints_at(time_s), target, time_s, self._dynamics, speed_fraction
        )

    def follow(self, times_s: Floats, joints: Floats, time_s: float) -> None:
        """Start a motion through knots."""
        self.motion = plan_way(self.motion.joints_at(time_s), times_s, joints, time_s)

    def brake(self, time_s: float) -> None:
        """Decelerate to a standstill on the path."""
        self.motion = plan_stop(self.motion, time_s, self._dynamics)

    def measured(self, time_s: float) -> Joints:
        """Return the commanded joints."""
        return self.motion.joints_at(time_s)

    def true_joints(self, time_s: float) -> Joints:
        """Return the commanded joints."""
        return self.motion.joints_at(time_s)

    def torques_nm(self, time_s: float) -> tuple[float, ...]:  # noqa: ARG002  # an arm without weight needs none
        """Return no torque."""
        return (0.0,) * len(self.motion.end)
