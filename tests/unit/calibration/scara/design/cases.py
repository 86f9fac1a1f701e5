"""Studies that the tests share."""

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.design.sight import Sight
from catseye.calibration.scara.design.study import Study
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.points import Commands
from tests.unit.calibration.scara.design.dense import LINKS, DenseArm

SMALL = DenseArm((-100.0, -60.0, -20.0, 20.0), (20.0, 60.0, 100.0))
SIGMA_MM = 0.0156
WHITE = Budget((Contributor("white", "length", SIGMA_MM),))

RING = np.array([[700.0 * np.cos(a), 700.0 * np.sin(a)] for a in np.deg2rad(np.arange(-110.0, 60.0, 14.0))])
"""Twelve places about the commands of the small arm."""


def study(arm: DenseArm, budget: Budget = WHITE) -> Study:
    """Return the study of an arm whose commands are all its nodes from all directions."""
    rows = np.array(arm.rows())
    commands = Commands(
        np.deg2rad(np.array(arm.nodes1_deg)[rows[:, 0]]),
        np.deg2rad(np.array(arm.nodes2_deg)[rows[:, 1]]),
        rows[:, 2],
        rows[:, 3],
    )
    layout = Layout("error-map", np.deg2rad(arm.nodes1_deg), np.deg2rad(arm.nodes2_deg), (), ())
    return Study(layout, *LINKS, commands, budget)


def seen_by_all(place: Floats, n: int) -> Sight:
    """Return a reflector that every command sees without a break."""
    return Sight(np.asarray(place), 0.0, np.ones(n, dtype=np.bool_), np.zeros(n, dtype=np.int64), 0, "")


def scaled(arm: DenseArm, covariance: Floats) -> Floats:
    """Return a covariance with links as angles at full reach, rad²."""
    scale = np.ones(arm.arm_size)
    scale[:2] = 1.0 / sum(LINKS)
    return np.asarray(covariance * np.outer(scale, scale))
