"""The parameters of a serial arm's model, by name: base, links, compliances, reversal errors, harmonics, targets.

Names and units are those of result files: `base.x_mm`, `A2.alpha_deg`, `A2.compliance_rad_per_nmm`, `nest1.x_mm`.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

from catseye.calibration.kinematics.chain import Joint
from catseye.calibration.serial_arm.arm import Anchor, SerialArm

LinkPart = Literal["alpha_deg", "beta_deg", "a_mm", "theta_offset_deg", "d_mm"]
"""What a joint's fixed geometry consists of."""

FramePart = Literal["x_mm", "y_mm", "z_mm", "rx_deg", "ry_deg", "rz_deg"]
"""What a frame's place and orientation consist of; R = Rz·Ry·Rx."""

Coordinate = Literal["x_mm", "y_mm", "z_mm"]

FRAME_PARTS: tuple[FramePart, ...] = get_args(FramePart)
LINK_PARTS: tuple[LinkPart, ...] = get_args(LinkPart)

NODE_SPACING_DEG = 30.0
"""Between the nodes of a joint's map."""


@dataclass(frozen=True)
class BaseFrame:
    """One of six numbers of the arm's base in the frame of the instrument, from where a closed form put it."""

    part: FramePart


@dataclass(frozen=True)
class Link:
    """A number of a joint's geometry."""

    joint: int
    part: LinkPart


@dataclass(frozen=True)
class Compliance:
    """Turn of a joint under the gravity torque about its +z, rad/(N mm); of a prismatic joint a shift, mm/N."""

    joint: int


@dataclass(frozen=True)
class Reversal:
    """What a joint's value has more when it is approached from below than from above, deg or mm."""

    joint: int


@dataclass(frozen=True)
class Harmonic:
    """Amplitude of a periodic error of a revolute joint over its angle, deg.

    Attributes:
        order: periods in a turn of the joint.
        wave: of cosine or sine.
    """

    joint: int
    order: float
    wave: Literal["cos", "sin"]


@dataclass(frozen=True)
class MapNode:
    """Error of a revolute joint at a node of its map, deg; linear to zero at the neighbouring nodes.

    Attributes:
        at_deg: command of the joint.
        reversal: half of it counts up or down with the side of approach: the backlash there.
    """

    joint: int
    at_deg: float
    reversal: bool = False


@dataclass(frozen=True)
class TargetPlace:
    """A coordinate of a target in the frame of the flange, mm, or an angle of its frame, deg."""

    target: int
    part: FramePart


@dataclass(frozen=True)
class AnchorPlace:
    """A coordinate of the fixed end of distances in the frame of the instrument, mm."""

    anchor: int
    part: Coordinate


@dataclass(frozen=True)
class DeadPath:
    """What the distances of a segment have more than the instrument says, mm."""

    segment: int


JointTerm = Compliance | Reversal | Harmonic | MapNode
"""What adds to the value of a joint."""

Role = BaseFrame | Link | JointTerm | TargetPlace | AnchorPlace | DeadPath
"""What a parameter does; joints, targets, anchors and segments are counted from 0."""


@dataclass(frozen=True)
class Parameter:
    """One number of the model.

    Attributes:
        name: as result files have it.
        unit: as result files have it.
        role: what it does.
        nominal: value that it has beforehand; 0 of the base, which is counted from where a closed form put it.
        u: standard uncertainty of the nominal value, where the value is a measurement of its own; None otherwise.
    """

    name: str
    unit: str
    role: Role
    nominal: float
    u: float | None = None


def base_parameters() -> tuple[Parameter, ...]:
    """Return the six of the base."""
    return tuple(Parameter(f"base.{part}", _unit(part), BaseFrame(part), 0.0) for part in FRAME_PARTS)


def link_parameters(arm: SerialArm) -> tuple[Parameter, ...]:
    """Return the geometry of all joints but the first, which the base has already.

    Of an axis that is parallel to the one before, the offset d is left to that one, and the tilt about y is added
    (Hayati 1983): a twist alone does not say where two nearly parallel axes point.
    """
    found: list[Parameter] = []
    for number, joint in enumerate(arm.chain.joints[1:], 1):
        found += [_link(number, joint, part) for part in _parts(joint)]
    return tuple(found)


def compliance_parameters(arm: SerialArm) -> tuple[Parameter, ...]:
    """Return the compliances of all joints but the first; that of an upright first axis nothing shows."""
    return tuple(
        Parameter(f"{joint.name}.compliance_rad_per_nmm", "rad/(N·mm)", Compliance(number), 0.0)
        for number, joint in enumerate(arm.chain.joints)
        if number and joint.kind == "revolute"
    )


def harmonic_parameters(arm: SerialArm, orders: Sequence[float], u_deg: float) -> tuple[Parameter, ...]:
    """Return periodic errors of all revolute joints, known beforehand to be about zero.

    Args:
        orders: periods in a turn of the joint.
        u_deg: standard deviation that an amplitude has among arms.
    """
    return tuple(
        Parameter(f"{joint.name}.{wave}{order:g}_deg", "deg", Harmonic(number, order, wave), 0.0, u_deg)
        for number, joint in enumerate(arm.chain.joints)
        if joint.kind == "revolute"
        for order in orders
        for wave in _WAVES
    )


def reversal_parameters(arm: SerialArm) -> tuple[Parameter, ...]:
    """Return the reversal errors of all joints."""
    return tuple(
        Parameter(f"{joint.name}.reversal_{joint.unit}", joint.unit, Reversal(number), 0.0)
        for number, joint in enumerate(arm.chain.joints)
    )


def map_parameters(
    arm: SerialArm, used_deg: Sequence[tuple[float, float]], u_deg: float, *, reversal: bool
) -> tuple[Parameter, ...]:
    """Return the nodes of the maps of all revolute joints, known beforehand to be about zero.

    Args:
        used_deg: smallest and largest command of each joint.
        u_deg: standard deviation that an error at a node has among arms.
        reversal: of the maps of backlash, beside those of what both sides of approach have in common.
    """
    kinds = {"map": False, "reversal": True} if reversal else {"map": False}
    return tuple(
        Parameter(f"{joint.name}.{kind}_{at:g}_deg", "deg", MapNode(number, at, turned), 0.0, u_deg)
        for number, joint in enumerate(arm.chain.joints)
        if joint.kind == "revolute"
        for kind, turned in kinds.items()
        for at in _nodes_deg(*used_deg[number])
    )


def _nodes_deg(low: float, high: float) -> tuple[float, ...]:
    first, last = math.floor(low / NODE_SPACING_DEG), math.ceil(high / NODE_SPACING_DEG)
    return tuple(k * NODE_SPACING_DEG for k in range(first, last + 1))


def target_parameters(arm: SerialArm, targets: Sequence[int]) -> tuple[Parameter, ...]:
    """Return the places of targets whose places are not exact.

    Args:
        targets: numbers of those that were measured.
    """
    return tuple(
        Parameter(f"{target.name}.{part}", "mm", TargetPlace(number, part), target.place_mm[k], target.u_mm)
        for number, target in enumerate(arm.targets)
        if number in targets and target.u_mm != 0.0
        for k, part in enumerate(_AXES)
    )


def distance_parameters(anchors: Sequence[Anchor], segments: Sequence[str]) -> tuple[Parameter, ...]:
    """Return the places of anchors that are not exact, and the dead paths of segments."""
    places = [
        Parameter(f"{anchor.name}.{part}", "mm", AnchorPlace(number, part), known, anchor.u_mm)
        for number, anchor in enumerate(anchors)
        if anchor.u_mm != 0.0
        for part, known in zip(_AXES, anchor.place_mm, strict=True)
    ]
    paths = [
        Parameter(f"{segment}.dead_path_mm", "mm", DeadPath(number), 0.0)
        for number, segment in enumerate(segments)
    ]
    return (*places, *paths)


def orientation_parameters(arm: SerialArm, targets: Sequence[int]) -> tuple[Parameter, ...]:
    """Return the angles of frames whose orientation on the flange is unknown.

    Args:
        targets: numbers of those whose orientation was measured.
    """
    return tuple(
        Parameter(f"{target.name}.{part}", "deg", TargetPlace(number, part), 0.0)
        for number, target in enumerate(arm.targets)
        if number in targets and target.turned
        for part in FRAME_PARTS[3:]
    )


_WAVES: tuple[Literal["cos"], Literal["sin"]] = ("cos", "sin")
_AXES: tuple[Coordinate, ...] = get_args(Coordinate)


def _parts(joint: Joint) -> tuple[LinkPart, ...]:
    if joint.parallel:
        return "alpha_deg", "beta_deg", "a_mm", "theta_offset_deg"
    return "alpha_deg", "a_mm", "theta_offset_deg", "d_mm"


def _link(number: int, joint: Joint, part: LinkPart) -> Parameter:
    return Parameter(f"{joint.name}.{part}", _unit(part), Link(number, part), float(getattr(joint, part)))


def _unit(part: LinkPart | FramePart) -> str:
    return "mm" if part.endswith("_mm") else "deg"
