"""What the application asks of a bench without knowing what is measured on it."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from catseye.drivers.roles.pose import Axes, Pose, with_axis
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.errors import ManualStepError, WayBlockedError
from catseye.procedures.kit.ideal import IdealBeam, NoBeam, SteadyBeam
from catseye.procedures.kit.motion.clear_way import way_refusal
from catseye.procedures.kit.records import Json


class System:
    """A bench whose arm carries nothing that has to be kept in sight; systems that know more subclass it.

    Attributes:
        bench: what it is made from.
    """

    def __init__(self, bench: Bench) -> None:
        self.bench = bench

    @property
    def rest(self) -> Pose:
        """Where the arm is taken to stand when nobody knows."""
        return tuple(min(max(0.0, axis.low), axis.high) for axis in self.bench.arm.axes)

    @property
    def manual_axes(self) -> Axes:
        """The arm's axes with the ranges within which it is moved by hand."""
        return self.bench.arm.axes

    @property
    def jog_names(self) -> tuple[str, ...]:
        """What is stepped by hand: names of axes, in lower case."""
        return tuple(axis.name.lower() for axis in self.bench.arm.axes)

    def ideal_beam(self) -> IdealBeam:
        """Return the beam of an ideal instrument on an ideal arm."""
        optics = self.bench.angular_optics or self.bench.linear_optics
        return NoBeam() if optics is None else SteadyBeam()

    def tool_mm(self, poses: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where the tool is, mm, shape (n, 2 or 3).

        Args:
            poses: deg or mm, shape (n, axes).
        """
        place_mm: NDArray[np.float64] = self.bench.workspace.chain.frames(poses)[-1, :, :3, 3]
        return place_mm

    def way_in(self, here: Pose, target: Pose) -> tuple[Pose, ...]:
        """Return the targets that lead from where the arm stands to a target, that one included.

        Raises:
            WayBlockedError: there is no free way.
        """
        if (refusal := way_refusal((here, target), self.bench)) is not None:
            raise WayBlockedError(f"{refusal}. Jog the arm to where its way is free, then go on")
        return (target,)

    def step_target(self, here: Pose, name: str, by: float, aim: str | None = None) -> Pose:
        """Return the pose at the end of a step by hand.

        Args:
            name: what moves, one of `jog_names`.
            by: deg, mm of a prismatic axis, or what else moves is measured in.
            aim: target of an instrument that is kept in sight.

        Raises:
            ManualStepError: nothing of that name moves, or what is aimed at is not there.
        """
        if aim is not None:
            raise ManualStepError(f"nothing on this arm is aimed, so not at {aim!r}: step without aim")
        number = self.axis_number(name)
        return with_axis(here, number, here[number] + by)

    def axis_number(self, name: str) -> int:
        """Return the number of an axis, from 0.

        Raises:
            ManualStepError: nothing of that name moves.
        """
        names = {axis.name.lower(): number for number, axis in enumerate(self.bench.arm.axes)}
        moved = {known: number for known, number in names.items() if known in self.jog_names}
        if name not in moved:
            raise ManualStepError(f"there is no axis {name!r} to move; there are {', '.join(moved)}")
        return moved[name]

    def turned(self, turned_deg: float) -> "System":
        """Return the system with what the arm carries mounted turned about the last axis, deg."""
        del turned_deg
        return self

    def aimed_at(self, pose: Pose) -> str | None:
        """Return the target that an instrument on the arm is meant for at a pose; None for none."""
        del pose
        return None

    def aim_facts(self) -> dict[str, Json]:
        """Return what the bench is aimed with, as a run stores it."""
        return {}

    def aimed(self, facts: Mapping[str, Json]) -> Bench:
        """Return the bench, aimed with what a run has stored."""
        del facts
        return self.bench
