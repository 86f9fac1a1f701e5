"""What drives the joints of an arm, from its description."""

from catseye.app.cell.arm import ArmDescription
from catseye.app.results.resolution.result import Actuation


def actuation_of(description: ArmDescription) -> list[Actuation]:
    """Return what drives the joints that turn, as far as the description says it."""
    return [
        Actuation(joint=joint.name, gear_ratio=joint.gear_ratio, encoder_bits=joint.encoder_bits)
        for joint in description.joint
        if joint.type == "revolute" and joint.gear_ratio is not None and joint.encoder_bits is not None
    ]
