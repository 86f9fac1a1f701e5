"""Arm and tool as the kinematics take them: chain, loads, and the tool centre point."""

import numpy as np

from catseye.app.cell.arm import ArmDescription
from catseye.app.cell.tool import ToolDescription
from catseye.calibration.kinematics.bodies import Point
from catseye.calibration.kinematics.chain import Chain, Joint
from catseye.calibration.kinematics.gravity import Load
from catseye.calibration.kinematics.types import Floats


def chain_of(description: ArmDescription) -> Chain:
    """Return the joints of an arm."""
    return Chain(
        tuple(
            Joint(
                joint.name,
                joint.type,
                joint.alpha_deg,
                joint.a_mm,
                joint.theta_offset_deg,
                joint.d_mm,
                joint.sign,
                *joint.range,
            )
            for joint in description.joint
        )
    )


def loads_of(description: ArmDescription, tool: ToolDescription | None = None) -> tuple[Load, ...]:
    """Return the masses of an arm and of the tool on its flange; none where the description has no [[link]]."""
    chain = chain_of(description)
    loads = [
        Load(
            number if link.joint is None else chain.frame_of(link.joint),
            link.mass_kg,
            point_of(link.centre_mm),
        )
        for number, link in enumerate(description.link, 1)
    ]
    if tool is not None:
        loads.append(Load(len(chain.joints), tool.mass_kg, point_of(tool.centre_mm)))
    return tuple(loads)


def tool_frame(tool: ToolDescription, target: str) -> Floats:
    """Return a target as a frame in that of the flange, with its directions, mm, shape (4, 4).

    Raises:
        ValueError: the tool has no such target.
    """
    frame = np.eye(4)
    frame[:3, 3] = tool.place_mm(target)
    return frame


def point_of(values: list[float]) -> Point:
    """Return three coordinates of a description."""
    x_mm, y_mm, z_mm = values
    return x_mm, y_mm, z_mm
