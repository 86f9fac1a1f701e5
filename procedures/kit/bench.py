"""The bench as a procedure knows it: nominal arm, rough reflectors, limits. Made from the cell file by the app."""

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.kinematics.bodies import Box, Capsule
from catseye.calibration.kinematics.chain import Chain
from catseye.drivers.roles.robot import Following


@dataclass(frozen=True)
class Reflector:
    """A cat's eye retroreflector.

    Attributes:
        name: as in the cell file.
        x_mm: place, mm; rough, or found by a search.
        y_mm: place, mm.
        facing_deg: direction of the axis of its field, deg.
    """

    name: str
    x_mm: float
    y_mm: float
    facing_deg: float

    @property
    def xy_mm(self) -> NDArray[np.float64]:
        """Place, mm, shape (2,)."""
        return np.array([self.x_mm, self.y_mm])


@dataclass(frozen=True)
class Arm:
    """The nominal arm and its limits.

    Attributes:
        link1_mm: nominal length of link 1.
        link2_mm: nominal length of link 2.
        j1_limits_deg: smallest and largest J1.
        j2_limits_deg: smallest and largest J2.
        j4_limits_deg: smallest and largest J4, cables included.
        j3_mm: height at which everything is measured.
        j3_range_mm: heights that J3 may be driven to, for the levelling of the beam.
        j3_speed_mm_s: fastest J3 at 100 % override, for the speed of a walk-through.
        speed_deg_s: fastest J1, J2, J4 at 100 % override, for the time estimate.
        acceleration_deg_s2: acceleration of J1, J2, J4, for the time estimate.
        override_percent: speed override of the run.
        following: how the arm follows a reflector.
        follow_speed_deg_s: fastest joint while set points are streamed.
        follow_acceleration_deg_s2: its acceleration then.
    """

    link1_mm: float
    link2_mm: float
    j1_limits_deg: tuple[float, float]
    j2_limits_deg: tuple[float, float]
    j4_limits_deg: tuple[float, float]
    j3_mm: float
    speed_deg_s: tuple[float, float, float]
    acceleration_deg_s2: tuple[float, float, float]
    override_percent: float
    following: Following = "stops"
    follow_speed_deg_s: float = 20.0
    follow_acceleration_deg_s2: float = 200.0
    j3_range_mm: tuple[float, float] | None = None
    j3_speed_mm_s: float = 1100.0


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
class Optics:
    """The beam and what stands in its way.

    Attributes:
        acceptance_mm: largest miss at which the cat's eye returns the beam.
        max_miss_mm: largest miss that the plan allows itself along its moves.
        field_half_angle_deg: half angle of the cat's eye's field.
        column_radius_mm: radius of the robot's base column.
        column_margin_mm: what the beam is kept away from the column beyond its radius.
        beam_min_mm: shortest beam.
        beam_max_mm: longest beam.
        theta40_deg: direction of the beam at J4 = 0 on the straight arm; rough, or found by a search.
        signal_min: smallest level of the returning beam that is measured with, 0...1; 0 takes any.
        one_reflector: one cat's eye is carried from nest to nest; it stands in one of them at a time.
    """

    acceptance_mm: float
    max_miss_mm: float
    field_half_angle_deg: float
    column_radius_mm: float
    column_margin_mm: float
    beam_min_mm: float
    beam_max_mm: float
    theta40_deg: float
    signal_min: float = 0.0
    one_reflector: bool = False


@dataclass(frozen=True)
class Alignment:
    """Screws that align the beam, and what is good enough.

    Attributes:
        stage_mm_per_turn: travel of the lateral stage in one turn of its screw.
        stage_clockwise: side to which the beam moves when the screw is turned clockwise; +y is to the left of the
            beam, seen from above.
        offset_tolerance_mm: largest accepted distance of the beam from the J4 axis.
        level_mrad_per_turn: tilt of the beam in one turn of the vertical screw.
        level_clockwise: where the beam tilts when that screw is turned clockwise.
        level_tolerance_mrad: largest accepted angle between the beam and the XY plane.
    """

    stage_mm_per_turn: float = 0.5
    stage_clockwise: Literal["+y", "-y"] = "+y"
    offset_tolerance_mm: float = 0.1
    level_mrad_per_turn: float = 2.0
    level_clockwise: Literal["up", "down"] = "up"
    level_tolerance_mrad: float = 0.2


@dataclass(frozen=True)
class Noise:
    """What a distance is good for, for estimates while measuring; standard uncertainties, mm.

    Attributes:
        white_mm: differs from distance to distance.
        radial_mm: radial error motions of J1, J2 and J4: they repeat with the angles.
        radial_orders: harmonics of the axis angle that the radial error motions are taken to have.
    """

    white_mm: float = 0.010
    radial_mm: tuple[float, float, float] = (0.005, 0.005, 0.010)
    radial_orders: int = 5


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


@dataclass(frozen=True)
class Bench:
    """Everything a plan is made from.

    Attributes:
        name: the cell's name.
        arm: nominal arm.
        workspace: bodies of the arm and around it.
        optics: beam.
        timing: how a point is measured.
        reflectors: in measuring order.
        nodes1_deg: J1 nodes, strictly increasing.
        nodes2_deg: J2 nodes, strictly increasing.
        take_up_deg: overshoot that brings a joint to its target from the proper side.
        alignment: screws and tolerances of the beam's alignment.
        noise: what a distance is good for.
        tracker: the cell has an independent instrument that the program reads.
    """

    name: str
    arm: Arm
    workspace: Workspace
    optics: Optics
    timing: Timing
    reflectors: tuple[Reflector, ...]
    nodes1_deg: tuple[float, ...]
    nodes2_deg: tuple[float, ...]
    take_up_deg: float
    alignment: Alignment = Alignment()
    noise: Noise = Noise()
    tracker: bool = True

    def aimed(self, places_mm: dict[str, tuple[float, float]], theta40_deg: float) -> "Bench":
        """Return the bench with places and zero direction found by a search."""
        moved = tuple(
            replace(reflector, x_mm=places_mm[reflector.name][0], y_mm=places_mm[reflector.name][1])
            if reflector.name in places_mm
            else reflector
            for reflector in self.reflectors
        )
        return replace(self, reflectors=moved, optics=replace(self.optics, theta40_deg=theta40_deg))
