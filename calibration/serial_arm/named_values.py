"""An arm with the values of parameters by their names, as result files have them."""

import re
from collections.abc import Mapping
from typing import Final, Literal

import numpy as np

from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.rotations import pose_of
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.geometry import Geometry
from catseye.calibration.serial_arm.parameters import (
    FRAME_PARTS,
    BaseFrame,
    Harmonic,
    MapNode,
    Parameter,
    Reversal,
    TargetPlace,
    base_parameters,
    compliance_parameters,
    link_parameters,
)

_WAVE: Final = re.compile(r"(cos|sin)([0-9.]+)_deg")
_NODE: Final = re.compile(r"(map|reversal)_(-?[0-9.]+)_deg")


def geometry_of(arm: SerialArm, values: Mapping[str, float]) -> Geometry:
    """Return an arm with values of its parameters.

    Args:
        arm: nominal, with its targets.
        values: absolute, by name; the parameters of the geometry are in their order.

    Raises:
        ArgumentError: the arm does not have a parameter.
    """
    known = {
        one.name: one for one in (*base_parameters(), *link_parameters(arm), *compliance_parameters(arm))
    }
    parameters = [known.get(name) or _further(arm, name) for name in values]
    at = [0.0 if isinstance(one.role, BaseFrame) else values[one.name] for one in parameters]
    return Geometry(arm, _base(values), parameters, np.array(at))


def _further(arm: SerialArm, name: str) -> Parameter:
    """Return a parameter of a target, a map, a reversal or a harmonic by its name."""
    owner, _, kind = name.rpartition(".")
    targets = [target.name for target in arm.targets]
    unit = kind.rpartition("_")[2]
    wave = _WAVE.fullmatch(kind)
    if owner in targets and kind in FRAME_PARTS:
        part = FRAME_PARTS[FRAME_PARTS.index(kind)]
        return Parameter(name, unit, TargetPlace(targets.index(owner), part), 0.0)
    node = _NODE.fullmatch(kind)
    if owner in arm.joint_names and node is not None:
        of_map = MapNode(arm.joint_names.index(owner), float(node[2]), node[1] == "reversal")
        return Parameter(name, unit, of_map, 0.0)
    if owner in arm.joint_names and kind.startswith("reversal_"):
        return Parameter(name, unit, Reversal(arm.joint_names.index(owner)), 0.0)
    if owner in arm.joint_names and wave is not None:
        phase: Literal["cos", "sin"] = "cos" if wave[1] == "cos" else "sin"
        return Parameter(name, unit, Harmonic(arm.joint_names.index(owner), float(wave[2]), phase), 0.0)
    raise ArgumentError(
        f"the result has a parameter {name}, which its arm with the joints {', '.join(arm.joint_names)} and the "
        f"targets {', '.join(targets) or 'none'} does not have: use the arm that it was identified for"
    )


def _base(values: Mapping[str, float]) -> Floats:
    place = np.array([values.get(f"base.{part}", 0.0) for part in FRAME_PARTS])
    return pose_of(place[:3], place[3:])
