"""Tables of constant errors, and of the invented arm's own."""

from collections.abc import Mapping

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.resolution.tables import ExpectedErrors, JointTable, ResolutionTables, Sector
from tests.unit.calibration.resolution.invented_arm import (
    JOINTS,
    SECTORS,
    SERIES_DEG,
    mean_percent,
    scatter_percent,
)

WIDE = np.array([1e-15, 10.0])
"""From below what any joint adds to a step of the tool: a joint does not follow steps below its table."""


def flat(
    chain: Chain,
    percent: Mapping[str, float] | None = None,
    *,
    commands: Floats = WIDE,
    reversal: float | None = None,
    scatter: float = 0.0,
    u_mean: float = 0.0,
) -> ResolutionTables:
    """Return tables of errors that are the same for all steps; joints that are not named have none."""
    errors = percent or {}
    ones = np.ones(commands.size)
    return ResolutionTables(
        JointTable(joint.name, direction, sectors)
        for joint in chain.joints
        for expected in [ExpectedErrors(errors.get(joint.name, 0.0) * ones, scatter * ones, u_mean * ones)]
        for sectors in [tuple(Sector(at, commands, expected, reversal) for at in (joint.low, joint.high))]
        for direction in (1, -1)
    )


def of_the_invented_arm() -> ResolutionTables:
    """Return what an endless number of tests would say of the arm at its sectors."""
    steps = SERIES_DEG[::-1]
    return ResolutionTables(
        JointTable(name, direction, tuple(_sector(joint, at, steps) for at in SECTORS))
        for joint, name in enumerate(JOINTS)
        for direction in (1, -1)
    )


def _sector(joint: int, at: float, steps: Floats) -> Sector:
    means = np.array([mean_percent(joint, at, float(step)) for step in steps])
    scatter = np.array([scatter_percent(joint, float(step)) for step in steps])
    return Sector(at, steps, ExpectedErrors(means, scatter, np.zeros(steps.size)))
