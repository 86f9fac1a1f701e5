"""From joint tests to Cartesian steps: an arm of known joint errors is tested, modelled, predicted, then measured.

Every joint is tested once in each direction at five positions; between these its errors differ. Runs along six
directions at three poses are judged by the paper's rule. All but models and prediction is written independently.

`CATSEYE_PREDICTED_RUNS` sets the runs of each direction [5].
"""

import os

import numpy as np

from catseye.calibration.resolution.cartesian_steps import DIRECTIONS
from catseye.calibration.resolution.joint_model import JointModel, table_of
from catseye.calibration.resolution.measured_steps import MeasuredSteps
from catseye.calibration.resolution.tables import JointTable, ResolutionTables
from tests.unit.calibration.resolution.invented_arm import JOINTS, SERIES_DEG, step_errors
from tests.unit.calibration.resolution.test_predictor import POSES, measured_lis, named

RUNS = int(os.environ.get("CATSEYE_PREDICTED_RUNS", "5"))
TESTED_DEG = (-150.0, -75.0, 0.0, 75.0, 150.0)


def table(joint: int, direction: int, rng: np.random.Generator) -> JointTable:
    errors = [step_errors(joint, at, SERIES_DEG, rng) for at in TESTED_DEG]
    steps = MeasuredSteps(
        JOINTS[joint],
        direction,
        np.repeat(TESTED_DEG, SERIES_DEG.size),
        np.tile(SERIES_DEG, len(TESTED_DEG)),
        np.concatenate(errors),
    )
    return table_of(JointModel(steps), {})


def test_measured_steps_lie_in_the_predicted_intervals() -> None:
    rng = np.random.default_rng(1)
    tables = ResolutionTables(table(joint, way, rng) for joint in range(len(JOINTS)) for way in (1, -1))
    hits: list[bool] = []
    widths: list[float] = []
    for pose in POSES:
        found = named(tables, pose)
        for direction in DIRECTIONS[:6]:
            least = found[direction].least
            assert least.low is not None
            assert least.high is not None
            widths.append(least.high / least.low)
            runs = [measured_lis(pose, direction, found[direction].steps, rng) for _ in range(RUNS)]
            hits += [least.low <= run <= least.high for run in runs]
    share = float(np.mean(hits))
    print(f"\n{share:.1%} of {len(hits)} runs inside; high / low {np.median(widths):.2f}")  # noqa: T201  # the figure
    assert share >= 0.9
