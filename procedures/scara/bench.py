"""The bench of a SCARA that carries an interferometer: links, reflectors, beam, nodes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.kinematics.bodies import Capsule, Point
from catseye.calibration.scara.budget import Contributor
from catseye.calibration.scara.plausibility.bounds import BOUNDS, Bounds
from catseye.drivers.roles.pose import Range
from catseye.procedures.kit.bench import Bench, Stand
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.scara.tool_zero import AS_THE_JOINTS, ToolZero


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
        changing: contributors that change with time.
    """

    white_mm: float = 0.010
    radial_mm: tuple[float, float, float] = (0.005, 0.005, 0.010)
    radial_orders: int = 5
    changing: tuple[Contributor, ...] = ()


@dataclass(frozen=True, kw_only=True)
class ScaraBench(Bench):
    """Everything an open-loop plan is made from.

    Attributes:
        link1_mm: nominal length of link 1.
        link2_mm: nominal length of link 2.
        j3_mm: height at which everything is measured.
        j3_range_mm: heights that J3 may be driven to, for the levelling of the beam.
        optics: beam.
        reflectors: in measuring order.
        nodes1_deg: J1 nodes, strictly increasing.
        nodes2_deg: J2 nodes, strictly increasing.
        take_up_deg: overshoot that brings a joint to its target from the proper side.
        alignment: screws and tolerances of the beam's alignment.
        noise: what a distance is good for.
        gear_orders: known periods of the gears of J1 and of J2 in a turn of the joint.
        plausibility: how far an identified arm may be from what was known before.
        mount_deg: angle by which the interferometer is turned on J4's flange against its first mounting; the zero
            direction of the beam contains it.
        tool_zero: how height and orientation of path files are counted.
    """

    link1_mm: float
    link2_mm: float
    j3_mm: float
    j3_range_mm: Range | None = None
    optics: Optics
    reflectors: tuple[Reflector, ...]
    nodes1_deg: tuple[float, ...]
    nodes2_deg: tuple[float, ...]
    take_up_deg: float
    alignment: Alignment = Alignment()
    noise: Noise = Noise()
    gear_orders: tuple[tuple[int, ...], tuple[int, ...]] = ((), ())
    plausibility: Bounds = BOUNDS
    mount_deg: float = 0.0
    tool_zero: ToolZero = AS_THE_JOINTS

    def chosen(self, names: Sequence[str]) -> tuple[Reflector, ...]:
        """Return the reflectors of these names in their order; all when there are no names.

        Raises:
            PlanError: there is none of that name.
        """
        known = {reflector.name: reflector for reflector in self.reflectors}
        for name in names:
            if name not in known:
                raise PlanError(f"reflector {name} is not in the cell file; known: {', '.join(known)}")
        return tuple(known[name] for name in names) if names else self.reflectors

    @property
    def j1_limits_deg(self) -> Range:
        """Smallest and largest J1."""
        return self.arm.axes[0].range

    @property
    def j2_limits_deg(self) -> Range:
        """Smallest and largest J2."""
        return self.arm.axes[1].range

    @property
    def j4_limits_deg(self) -> Range:
        """Smallest and largest J4, cables included."""
        return self.arm.axes[3].range

    @cached_property
    def stands(self) -> tuple[Stand, ...]:
        """The reflectors, from the table to the height of the flange; the beam is below that."""
        rest = np.array([[0.0, 0.0, self.j3_mm, 0.0]])
        top_mm = float(self.workspace.chain.frames(rest)[-1, 0, 2, 3])
        return tuple(self._stand(reflector, top_mm) for reflector in self.reflectors)

    def _stand(self, reflector: Reflector, top_mm: float) -> Stand:
        foot, top = ((reflector.x_mm, reflector.y_mm, z_mm) for z_mm in (self.workspace.table_z_mm, top_mm))
        return Stand(
            Capsule(f"stand of reflector {reflector.name}", 0, foot, top, self.workspace.stand_radius_mm),
            "put the reflector out of the arm's reach, or take nodes near it out of [measurement]",
        )

    def with_turned_head(self) -> "ScaraBench":
        """Return the bench with what is mounted on J4 at both places, as it is and turned by half a turn."""
        workspace, last = self.workspace, len(self.workspace.chain.joints)
        turned = tuple(
            replace(
                body,
                name=f"{body.name}, turned",
                start_mm=_half_turned(body.start_mm),
                end_mm=_half_turned(body.end_mm),
            )
            for body in workspace.bodies
            if body.frame == last
        )
        return replace(self, workspace=replace(workspace, bodies=(*workspace.bodies, *turned)))

    def mounted(self, mount_deg: float) -> "ScaraBench":
        """Return the bench with the interferometer mounted so far turned against its first mounting."""
        theta40_deg = self.optics.theta40_deg + mount_deg - self.mount_deg
        return replace(self, mount_deg=mount_deg, optics=replace(self.optics, theta40_deg=theta40_deg))

    def aimed(self, places_mm: dict[str, tuple[float, float]], theta40_deg: float) -> "ScaraBench":
        """Return the bench with places and zero direction found by a search."""
        moved = tuple(
            replace(reflector, x_mm=places_mm[reflector.name][0], y_mm=places_mm[reflector.name][1])
            if reflector.name in places_mm
            else reflector
            for reflector in self.reflectors
        )
        return replace(self, reflectors=moved, optics=replace(self.optics, theta40_deg=theta40_deg))


def _half_turned(place_mm: Point) -> Point:
    x_mm, y_mm, z_mm = place_mm
    return -x_mm, -y_mm, z_mm
