"""A joint's map with its covariance, and its quantities after ISO 230-2."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.extension import Source, term_values
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.standards.iso230_2 import Uncertain, systematic_of_map

ARCSEC_PER_MDEG = 3.6

_MDEG = np.deg2rad(1e-3)


@dataclass(frozen=True)
class JointMap:
    """Angular positioning deviations of one joint at its nodes, upwards, then downwards.

    Attributes:
        joint: 1 or 2.
        nodes_rad: command angles, rad, shape (m,).
        mean_mdeg: deviations, shape (2m,).
        covariance_mdeg2: of the deviations, shape (2m, 2m).
        left_out: names of terms that depend on something else than the joint's own angle.
    """

    joint: Literal[1, 2]
    nodes_rad: Floats
    mean_mdeg: Floats
    covariance_mdeg2: Floats
    left_out: tuple[str, ...]

    def quantities(self) -> tuple[Uncertain, ...]:
        """Return the systematic quantities of the joint, mdeg."""
        return systematic_of_map(self.mean_mdeg, self.covariance_mdeg2)


def joint_maps(arm: IdentifiedArm) -> tuple[JointMap, ...]:
    """Return the maps of both joints, periodic terms of the joint's own angle included; none for a model without."""
    if arm.layout.model == "conventional":
        return ()
    return _joint_map(arm, 1), _joint_map(arm, 2)


def _joint_map(arm: IdentifiedArm, joint: Literal[1, 2]) -> JointMap:
    layout = arm.layout
    nodes, part = (layout.nodes1_rad, layout.map1) if joint == 1 else (layout.nodes2_rad, layout.map2)
    own: Source = "theta1" if joint == 1 else "theta2"
    sources: dict[Source, Floats | None] = {"theta1": None, "theta2": None, "theta4": None, "elapsed": None}
    values = term_values(layout.terms, {**sources, own: np.tile(nodes, 2)}, 2 * nodes.size)
    design = np.zeros((2 * nodes.size, layout.arm_size))
    design[:, part] = np.eye(2 * nodes.size)
    left_out = []
    for i, term in enumerate(layout.terms):
        if term.target == own and term.source == own:
            design[:, layout.extension.start + i] = values[:, i]
        elif term.target == own:
            left_out.append(term.name)
    return JointMap(
        joint,
        nodes,
        design @ arm.parameters / _MDEG,
        design @ arm.covariance @ design.T / _MDEG**2,
        tuple(left_out),
    )
