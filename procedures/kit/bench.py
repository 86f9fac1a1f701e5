"""The bench as every procedure knows it: an arm of any axes with its limits, what stands around it, how it is timed.

Made from the cell file by the app.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from catseye.calibration.kinematics.bodies import Box, Capsule
from catseye.calibration.kinematics.chain import Chain
from catseye.drivers.roles.pose import Axes, Unit
from catseye.drivers.roles.robot import Following


@dataclass(frozen=True)
class Arm:
    """An arm's axes, as the cell narrows them, and how they are driven.

    Attributes:
        axes: from the base outwards.
        range_keys: key of [robot] in the cell file that sets the range of each axis, for advice.
        override_percent: speed override of the run.
        following: how the arm follows a path.
        follow_speed_deg_s: fastest revolute axis while set points are streamed.
        follow_acceleration_deg_s2: its acceleration then.
        test_places: where each axis is tested, deg or mm, as the arm's description has it; empty where it has none.
        steps: the controller itself adds increments to the measured position.
        command_resolution: smallest increment that the controller can command, by the unit of an axis; None unknown.
    """

    axes: Axes
    range_keys: tuple[str, ...]
    override_percent: float
    following: Following = "stops"
    follow_speed_deg_s: float = 20.0
    follow_acceleration_deg_s2: float = 200.0
    test_places: tuple[tuple[float, ...], ...] = ()
    steps: bool = False
    command_resolution: Mapping[Unit, float] | None = None


@dataclass(frozen=True)
class AngularOptics:
    """An angular interferometer on its stand, and the retroreflector that turns with a joint.

    Attributes:
        spacing_mm: distance of the retroreflector's two prisms, the baseline S of θ = arcsin(ΔL / S).
        u_spacing_mm: its standard uncertainty.
        distance_mm: between interferometer and retroreflector, at most.
        signal_min: smallest level of the returning beam with which a recording begins, 0…1.
    """

    spacing_mm: float
    u_spacing_mm: float
    distance_mm: float
    signal_min: float


@dataclass(frozen=True)
class LinearOptics:
    """A linear interferometer on its stand, and the retroreflector at the tool.

    Attributes:
        distance_mm: between interferometer and retroreflector at the place of a series: its dead path.
        signal_min: smallest level of the returning beam with which a recording begins, 0…1.
    """

    distance_mm: float
    signal_min: float


@dataclass(frozen=True)
class Workspace:
    """The bodies of the arm and what stands around it, apart from the reflectors.

    Attributes:
        chain: joints of the arm with their ranges; bodies stand in its frames.
        bodies: of the arm, the base among them.
        table_z_mm: height of the table on which arm and reflectors stand, in the arm's base frame.
        stand_radius_mm: radius of a reflector with its stand, which reaches from the table to the flange.
        clearance_mm: what is kept between any two bodies.
        keep_out: boxes that no moving body may enter.
        keep_in: boxes that no moving body may leave.
        unconfirmed: dimensions that are estimates which nobody has confirmed, in words.
    """

    chain: Chain
    bodies: tuple[Capsule, ...]
    table_z_mm: float
    stand_radius_mm: float
    clearance_mm: float
    keep_out: tuple[Box, ...] = ()
    keep_in: tuple[Box, ...] = ()
    unconfirmed: tuple[str, ...] = ()


@dataclass(frozen=True)
class Stand:
    """A body that stands in the workspace beside its boxes.

    Attributes:
        body: fixed to the base.
        remedy: what to do where it is in the way.
    """

    body: Capsule
    remedy: str


@dataclass(frozen=True)
class Timing:
    """How a point is measured.

    Attributes:
        settle_time_s: wait after a motion.
        dwell_time_s: time over which the readings are spread.
        readings: readings of a point.
        spread_limit_mm: largest standard deviation of the readings of a settled point.
    """

    settle_time_s: float
    dwell_time_s: float
    readings: int
    spread_limit_mm: float = math.inf


@dataclass(frozen=True, kw_only=True)
class Bench:
    """What a plan for any arm is made from.

    Attributes:
        name: the cell's name.
        arm: axes, limits, speeds.
        workspace: bodies of the arm and around it.
        timing: how a point is measured.
        tracker: the cell has an independent instrument that the program reads.
        angular_optics: that turn with a joint; None where the cell has none.
        linear_optics: whose reflector the tool carries; None where the cell has none.
    """

    name: str
    arm: Arm
    workspace: Workspace
    timing: Timing
    tracker: bool = True
    angular_optics: AngularOptics | None = None
    linear_optics: LinearOptics | None = None

    @property
    def stands(self) -> tuple[Stand, ...]:
        """What stands in the workspace beside its boxes."""
        return ()
