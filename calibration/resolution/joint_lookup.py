"""What tables say of joint increments, and what they leave open."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.resolution.tables import Curve, ExpectedErrors, ResolutionTables

_STILL = 1e-9
"""Part of the largest increment below which a joint stands still: rounding."""

UNITS: Final = {"revolute": "deg", "prismatic": "mm"}
"""Of a joint's values, by its kind."""


@dataclass(frozen=True)
class KnownErrors:
    """Errors of joint increments; zero where they are not known.

    Attributes:
        errors: of each increment, arrays of their shape, (directions, steps, joints).
        lost: what a reversal takes from each, deg or mm, same shape.
        unknown: neither is known, same shape.
    """

    errors: ExpectedErrors
    lost: Floats
    unknown: Bools


class JointLookup:
    """Looks increments up in tables.

    Args:
        chain: the arm.
        pose: where the increments begin, deg or mm, shape (joints,).
        approach: sense of each joint's last motion, 1 or -1, 0 where nobody knows: then a reversal is assumed; shape
            (joints,). None leaves reversals out.
    """

    def __init__(self, chain: Chain, pose: Floats, tables: ResolutionTables, approach: Ints | None) -> None:
        self._chain, self._pose, self._tables, self._approach = chain, pose, tables, approach

    def known(self, increments: Floats) -> KnownErrors:
        """Return the errors of increments, deg or mm, shape (directions, steps, joints)."""
        values, lost = np.zeros((3, *increments.shape)), np.zeros(increments.shape)
        unknown: Bools = np.zeros(increments.shape, dtype=np.bool_)
        least = _STILL * np.abs(increments).max(initial=0.0, axis=-1)
        for joint in range(len(self._chain.joints)):
            for sense in (1, -1):
                where = sense * increments[..., joint] > least
                if not where.any():
                    continue
                curve = self._curve(joint, sense)
                reversal = self._reversal(curve, joint, sense)
                if curve is None or reversal is None:
                    unknown[where, joint] = True
                    continue
                errors = curve.at(np.abs(increments[where, joint]))
                found = np.stack([errors.mean_percent, errors.scatter_percent, errors.u_mean_percent])
                unknown[where, joint] = np.isnan(found[0])
                values[:, where, joint] = np.nan_to_num(found)
                lost[where, joint] = reversal
        return KnownErrors(ExpectedErrors(*values), lost, unknown)

    def why_unknown(self, joint: int, increment: float) -> str:
        """Return why the error of an increment is not known.

        Args:
            joint: number of the joint, from 0.
            increment: deg or mm.
        """
        name, unit = self._chain.joints[joint].name, UNITS[self._chain.joints[joint].kind]
        sense, size = (1 if increment > 0.0 else -1), abs(increment)
        table = self._tables.of(name, sense)
        if table is None:
            return f"the tables hold nothing of {name} in direction {sense:+d}"
        curve = table.curve(float(self._pose[joint]))
        if curve is None:
            ends = f"{table.sectors[0].position:g} … {table.sectors[-1].position:g} {unit}"
            return f"{name} stands at {self._pose[joint]:g} {unit}, and its tables hold {ends}"
        if size < curve.smallest:
            return f"{name} would step {size:.2g} {unit}, and its table begins at {curve.smallest:.2g} {unit}"
        if size > curve.largest:
            return f"{name} would step {size:.2g} {unit}, and its table ends at {curve.largest:.2g} {unit}"
        return f"{name} reverses, and its reversal error at {self._pose[joint]:g} {unit} is not known"

    def _curve(self, joint: int, sense: int) -> Curve | None:
        table = self._tables.of(self._chain.joints[joint].name, sense)
        return None if table is None else table.curve(float(self._pose[joint]))

    def _reversal(self, curve: Curve | None, joint: int, sense: int) -> float | None:
        """Return what a joint loses as it begins to move; None where that is not known."""
        if self._approach is None or self._approach[joint] == sense:
            return 0.0
        return None if curve is None else curve.reversal
