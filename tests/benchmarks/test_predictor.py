"""Prediction of 12 directions with 50 draws against a loop over a scalar inverse, with the same numbers.

The loop does for each step and each draw what the paper's tool does: a target, its joints by the scalar inverse of a
textbook, an error for each joint, the arm's frames, and the difference of two places. It takes minutes for a pose, so
it is timed on some steps of all directions, with errors that are the same in all draws.
"""

import time

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.rotations import pose_of
from catseye.calibration.resolution.cartesian_steps import DIRECTIONS
from catseye.calibration.resolution.predictor import PredictionMethod, predict_pose
from tests.benchmarks.test_kinematics import scalar_inverse
from tests.unit.calibration.kinematics.chains import chain
from tests.unit.calibration.resolution.invented_tables import flat

POSE = np.array([20.0, -80.0, 95.0, 15.0, 30.0, -40.0])
PERCENT = {"A1": -12.0, "A2": 5.0, "A3": 30.0, "A4": -60.0, "A5": 25.0, "A6": -15.0}
LOOPED = 10
ROUNDS = 5


def looped(size: float, direction: int, start: Floats, factors: Floats) -> float:
    """Return the error of one step, percent."""
    unit = (1.0 if direction % 2 == 0 else -1.0) * np.eye(6)[direction // 2]
    target = start.copy()
    target[:3, 3] += size * unit[:3]
    target[:3, :3] = pose_of(np.zeros(3), size * unit[3:])[:3, :3] @ start[:3, :3]
    really = POSE + factors * (scalar_inverse(target, POSE) - POSE)
    moved = chain("kr210-r2700").frames(really[None])[-1, 0]
    if direction < 6:
        along = float((moved[:3, 3] - start[:3, 3]) @ unit[:3])
    else:
        turn = moved[:3, :3] @ start[:3, :3].T
        vector = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
        along = float(np.rad2deg(vector) @ unit[3:])
    return 100.0 * (along / size - 1.0)


def test_a_prediction_is_faster_than_a_loop_over_the_inverse() -> None:
    arm, method = chain("kr210-r2700"), PredictionMethod()
    tables, sizes = flat(arm, PERCENT), method.series.sizes()
    start = arm.frames(POSE[None])[-1, 0]
    factors = np.array([1.0 + 0.01 * value for value in PERCENT.values()])
    taken = []
    for _ in range(ROUNDS):
        begun = time.perf_counter()
        found = predict_pose(arm, POSE, tables, method)
        between = time.perf_counter()
        loop = [
            [looped(float(size), direction, start, factors) for size in sizes[direction, :LOOPED]]
            for direction in range(len(DIRECTIONS))
        ]
        taken.append((between - begun, time.perf_counter() - between))
    assert np.abs([one.mean_percent[:LOOPED] for one in found] - np.array(loop)).max() < 1e-4
    ours, theirs = np.min(taken, axis=0) / [method.draws * sizes.size, LOOPED * len(DIRECTIONS)]
    print(  # noqa: T201  # the figure
        f"\n{method.draws} draws of {sizes.size} steps in {len(DIRECTIONS)} directions: {1e6 * ours:.2f} µs each; "
        f"scalar loop {1e6 * theirs:.0f} µs (ratio {theirs / ours:.0f})"
    )
    assert theirs / ours > 50.0
