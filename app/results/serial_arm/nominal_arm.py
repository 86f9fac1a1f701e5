"""Arm and tool of their descriptions as the calibration takes them."""

from dataclasses import replace
from typing import Final

from catseye.app.cell.arm import ArmDescription
from catseye.app.cell.serial_arm import chain_of, loads_of
from catseye.app.cell.tool import ToolDescription
from catseye.calibration.serial_arm.arm import SerialArm, Target


def serial_arm_of(description: ArmDescription, tool: ToolDescription | None) -> SerialArm:
    """Return the nominal arm with the targets of its tool; without a tool it has none."""
    targets = [] if tool is None else tool.target
    return SerialArm(
        chain_of(description),
        loads_of(description, tool),
        tuple(Target(one.name, (one.x_mm, one.y_mm, one.z_mm), one.u_mm) for one in targets),
    )


def with_unknown_targets(arm: SerialArm, names: list[str]) -> SerialArm:
    """Return the arm with targets of which nobody knows where they are."""
    return replace(arm, targets=tuple(Target(name, (0.0, 0.0, 0.0), None) for name in names))


FLANGE: Final = "flange"
"""Name of the flange's own frame among targets; an empty target of a table means it."""


def with_flange(arm: SerialArm) -> SerialArm:
    """Return the arm with the flange itself behind its targets."""
    if FLANGE in {target.name for target in arm.targets}:
        return arm
    return arm.with_targets((*arm.targets, Target(FLANGE, (0.0, 0.0, 0.0))))
