"""What the bench needs of an arm, whatever its joints are."""

from dataclasses import dataclass
from typing import Protocol

from catseye.simulators.config import Joints
from catseye.simulators.world.motion import Motion
from catseye.simulators.world.types import Floats, Plane


@dataclass(frozen=True)
class BeamPoses:
    """How the arm holds the start of the beam at several bench times, shape (n,) each.

    Attributes:
        time_s: bench times, s.
        axis_mm: true position of the axis that turns the beam, mm.
        beam_rad: true world direction of the beam of an interferometer mounted as at first, rad.
        height_mm: of the arm's end, mm.
        white_mm: white noise of the length at these places, mm.
    """

    time_s: Floats
    axis_mm: Plane
    beam_rad: Floats
    height_mm: Floats
    white_mm: Floats


class Arm(Protocol):
    """An arm that carries the beam. What it does is a function of bench time within one motion."""

    @property
    def motion(self) -> Motion:
        """The present motion and the rest that follows it."""
        ...

    @property
    def gliding(self) -> bool:
        """The present motion is a glide."""
        ...

    def move_to(
        self, target: Joints, time_s: float, speed_fraction: float, acceleration_fraction: float
    ) -> None:
        """Start a motion at a bench time at which the arm stands still."""
        ...

    def follow(self, times_s: Floats, joints: Floats, time_s: float) -> None:
        """Start a motion through knots at a bench time at which the arm stands still; see `plan_way`."""
        ...

    def glide(self, target: Joints, time_s: float, duration_s: float) -> bool:
        """Move at constant speed, from standstill or from a glide under way.

        Returns:
            False when the arm stands there already: nothing was changed.
        """
        ...

    def stop(self, time_s: float) -> None:
        """Decelerate from a bench time on; the path is not left."""
        ...

    def shake(self, size_mm: float, from_s: float, until_s: float) -> None:
        """Let something beside the arm keep it ringing between two bench times."""
        ...

    def play_at(self, time_s: float) -> Floats:
        """Return the states of the play (-1...1) of the joints that have any."""
        ...

    def true_joints(self, time_s: float) -> Joints:
        """Return the joints as they really are, deg or mm."""
        ...

    def axis_shift_mm(self, joint: int) -> complex:
        """Return by how much the axis of a joint is displaced at the end of the motion, in the frame that carries it.

        Args:
            joint: its number, from 1.

        Raises:
            BenchError: there is no such joint, or nothing can be mounted on its axis.
        """
        ...

    def sample_times(self) -> Floats:
        """Return the bench times at which the beam has to be looked at, from the motion's start until it is calm."""
        ...

    def poses(self, time_s: Floats) -> BeamPoses:
        """Return what the arm does at bench times not before the start of the present motion, s, shape (n,)."""
        ...
