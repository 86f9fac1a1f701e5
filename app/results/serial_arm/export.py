"""Parameters of a calibrated serial arm for other programs: labelled rows, and URDF with places and angles."""

from collections.abc import Sequence
from itertools import count
from xml.etree import ElementTree

import numpy as np

from catseye.app.cell.arm import ArmDescription, arm_description
from catseye.app.files.tabular import Row
from catseye.app.results.serial_arm.identified_arm import identified_arm
from catseye.app.results.serial_arm.result import SerialArmResult
from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.rotations import angles_of, pose_of

_M_PER_MM = 1e-3
_BASE = "base"


def parameter_rows(result: SerialArmResult) -> list[Row]:
    """Return a row for each parameter: what it belongs to, its value with u and interval, and the nominal value."""
    return [
        {
            "name": one.name,
            "of": one.name.rpartition(".")[0],
            "parameter": one.name.rpartition(".")[2],
            "value": one.value,
            "u": one.u if one.identified else None,
            "unit": one.unit,
            "nominal": one.nominal,
            "deviation": None if one.nominal is None else one.value - one.nominal,
            "identified": int(one.identified),
            "low_95": one.low,
            "high_95": one.high,
        }
        for one in result.parameters
    ]


def urdf_text(result: SerialArmResult) -> str:
    """Return the geometry as URDF: base, a link and a joint for each joint, and the targets as fixed links.

    Lengths are in m, angles in rad; rpy are URDF's, R = Rz(yaw)·Ry(pitch)·Rx(roll). Deflections, maps and where the
    base stands in the frame of the instrument have no place in URDF.

    Raises:
        UsageError: the result has a parameter that its arm does not have.
    """
    found = identified_arm(result)
    geometry, description = found.geometry, result.description or arm_description(result.arm)
    root = ElementTree.Element("robot", name=_plain(description.name))
    left_out = "left out: base in the frame of the instrument, compliances, maps"
    root.append(ElementTree.Comment(f" calibrated by catseye, model {result.model}; {left_out} "))
    ElementTree.SubElement(root, "link", name=_BASE)
    parent = _BASE
    for number, joint in enumerate(description.joint):
        low, high = joint.range
        turning = joint.type == "revolute"
        unit = float(np.deg2rad(1.0)) if turning else _M_PER_MM
        made = _joint(root, joint.name, (parent, _link_of(joint.name)), _origin(geometry.chain, number))
        made.set("type", joint.type)
        ElementTree.SubElement(made, "axis", xyz=f"0 0 {joint.sign:g}")
        speed = joint.speed
        ElementTree.SubElement(
            made,
            "limit",
            lower=_text(low * unit),
            upper=_text(high * unit),
            effort="0",
            velocity=_text((speed or 0.0) * unit),
        )
        parent = _link_of(joint.name)
    names = target_links([target.name for target in found.arm.targets], description)
    for name, frame in zip(names, geometry.tools, strict=True):
        made = _joint(root, f"{name}_fixed", (parent, name), frame)
        made.set("type", "fixed")
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def target_links(targets: Sequence[str], description: ArmDescription) -> list[str]:
    """Return the names of the targets' links: a name that another has already gets a number.

    Names that stand as they are come before those that are made plain.
    """
    joints = [joint.name for joint in description.joint]
    taken = {_BASE, *map(_link_of, joints), *(name.removesuffix("_fixed") for name in joints)}
    found: dict[str, str] = {}
    for target in sorted(targets, key=lambda name: _plain(name) != name):
        plain = _plain(target)
        numbered = (f"{plain}_{number}" for number in count(2))
        found[target] = plain if plain not in taken else next(name for name in numbered if name not in taken)
        taken.add(found[target])
    return [found[target] for target in targets]


def _link_of(joint: str) -> str:
    return f"{joint}_link"


def _origin(chain: Chain, number: int) -> Floats:
    """Return where a joint's frame is at zero, in that of the joint before, shape (4, 4)."""
    joint = chain.joints[number]
    turned = pose_of(np.zeros(3), np.array([0.0, 0.0, joint.theta_offset_deg]))
    along = pose_of(np.array([0.0, 0.0, joint.d_mm]), np.zeros(3))
    return np.asarray(chain.fixed[number] @ turned @ along)


def _joint(
    root: ElementTree.Element, name: str, links: tuple[str, str], origin: Floats
) -> ElementTree.Element:
    """Add a link and the joint that bears it."""
    parent, child = links
    ElementTree.SubElement(root, "link", name=child)
    made = ElementTree.SubElement(root, "joint", name=name)
    ElementTree.SubElement(made, "parent", link=parent)
    ElementTree.SubElement(made, "child", link=child)
    xyz = " ".join(map(_text, _M_PER_MM * origin[:3, 3]))
    rpy = " ".join(map(_text, np.deg2rad(angles_of(origin[:3, :3]))))
    ElementTree.SubElement(made, "origin", xyz=xyz, rpy=rpy)
    return made


def _text(value: float) -> str:
    return f"{value:.12g}"


def _plain(name: str) -> str:
    return "_".join(name.split())
