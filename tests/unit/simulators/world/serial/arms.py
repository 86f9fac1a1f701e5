"""Arms of the bench for tests, from the shipped descriptions."""

from catseye.app.cell.arm import RevoluteJoint, shipped_arm
from catseye.simulators.config import SerialArm, SerialJoint, SerialLoad

TOOL = SerialLoad(6, 20.0, (0.0, 0.0, 145.0))
"""A gripper on the flange, of which the paper says no more than that there is one."""


def serial_arm(name: str, *more: SerialLoad) -> SerialArm:
    """Return a shipped arm, with further loads."""
    described = shipped_arm(name)
    names = [joint.name for joint in described.joint]
    joints = tuple(
        SerialJoint(
            name=joint.name,
            prismatic=False,
            alpha_deg=joint.alpha_deg,
            a_mm=joint.a_mm,
            theta_offset_deg=joint.theta_offset_deg,
            d_mm=joint.d_mm,
            sign=joint.sign,
            low=joint.low_deg,
            high=joint.high_deg,
            speed=joint.speed,
            gear_ratio=joint.gear_ratio,
            encoder_bits=joint.encoder_bits,
        )
        for joint in described.joint
        if isinstance(joint, RevoluteJoint)
    )
    loads = tuple(
        SerialLoad(0 if link.joint in {None, "base"} else names.index(str(link.joint)) + 1, link.mass_kg, xyz)
        for link in described.link
        for xyz in [(link.centre_mm[0], link.centre_mm[1], link.centre_mm[2])]
    )
    return SerialArm(described.name, joints, (*loads, *more))
