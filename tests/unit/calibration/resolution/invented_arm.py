"""An arm whose joint errors are known functions: it is measured joint by joint, and moves its tool.

Written without anything of what it judges, but for the arm's lengths: places come from products of exponentials.
"""

import math

import numpy as np

from catseye.calibration.core.types import Floats
from tests.unit.calibration.kinematics.screws import ARMS

KR210 = ARMS["kr210-r2700"]
JOINTS = ("A1", "A2", "A3", "A4", "A5", "A6")
ONSETS_DEG = (2e-4, 4e-4, 6e-4, 2.5e-3, 2e-3, 3e-3)
"""Step of each joint below which errors grow."""

SECTORS = (-150.0, -100.0, -50.0, 0.0, 50.0, 100.0, 150.0)
SERIES_DEG: Floats = 0.1 / 1.072267 ** np.arange(109.0)


def mean_percent(joint: int, position_deg: float, step_deg: float) -> float:
    """Return the expected error: a little too far for large steps, nothing moves in the smallest."""
    onset: float = ONSETS_DEG[joint] * (1.0 + 0.2 * math.sin(math.radians(2.0 * position_deg + 40.0 * joint)))
    return 1.5 - 101.5 * math.exp(-step_deg / (0.7 * onset))


def scatter_percent(joint: int, step_deg: float) -> float:
    small: float = (ONSETS_DEG[joint] / step_deg) ** 0.9
    return 0.3 + 8.0 * small


def step_errors(joint: int, position_deg: float, steps_deg: Floats, rng: np.random.Generator) -> Floats:
    """Return the errors of one test of a joint, in percent."""
    return np.array(
        [
            mean_percent(joint, position_deg, step) + scatter_percent(joint, step) * rng.normal()
            for step in map(float, steps_deg)
        ]
    )


def moved_mm(pose_deg: Floats, increments_deg: Floats, rng: np.random.Generator) -> Floats:
    """Return how the flange is displaced by a motion, one joint after the other, with the errors of the joints."""
    really = [
        step * (1.0 + 0.01 * (mean_percent(joint, float(pose_deg[joint]), abs(step)) + noise))
        for joint, step in enumerate(map(float, increments_deg))
        for noise in [scatter_percent(joint, abs(step)) * rng.normal()]
    ]
    moved: Floats = KR210.forward(pose_deg + really)[:3, 3] - KR210.forward(pose_deg)[:3, 3]
    return moved


def least_step(steps: Floats, errors_percent: Floats, threshold: float) -> float:
    """Return the least increment step by the paper's rule, as the paper puts it."""
    found = math.nan
    for k, step in enumerate(steps):
        window = errors_percent[max(0, k - 5) : k + 6]
        if abs(sum(window) / len(window)) > threshold:
            break
        found = float(step)
    return found
