"""The whole loop on the emulated bench's own plant: recordings of all joints, models, prediction, measured steps.

No engine and no socket: the plant, its optics and their noise in virtual time. The joints' recordings are those that
are shipped, or those of another arm; steps of the tool are measured at three poses in six directions, with other
random numbers each time.

Run as `python -m tests.resolution_loop`. It prints each run beside what was predicted, and judges nothing yet: five
runs of each direction have still to be made (docs/evidence.md). A measured step up to an upper end counts as inside.

`CATSEYE_LOOP_RUNS` sets the runs of each direction [5], `CATSEYE_LOOP_ARM` the seed of the arm [that of the shipped
recordings]; another arm is recorded first, which takes minutes.
"""

import math
import os
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from catseye.app.cell.arm import shipped_arm
from catseye.app.cell.serial_arm import chain_of
from catseye.app.cluster.share import InThisProcess
from catseye.app.results.resolution.modelling import model_arm
from catseye.app.results.resolution.recorded_runs import evaluate_series
from catseye.app.results.resolution.shipped import shipped_file
from catseye.calibration.resolution.predictor import PredictedStep, predict_pose
from catseye.calibration.resolution.tables import ResolutionTables
from catseye.procedures.resolution.cartesian import CartesianParams, ResolutionCartesian
from tests.shipped_recordings import JOINTS, SEED, result_text
from tests.virtual_bench import ARM, BENCH, arm_truth, recorded

RUNS = int(os.environ.get("CATSEYE_LOOP_RUNS", "5"))
ARM_SEED = int(os.environ.get("CATSEYE_LOOP_ARM", str(SEED)))
POSES = (
    (20.0, -80.0, 70.0, 30.0, 50.0, 10.0),
    (-60.0, -100.0, 100.0, -40.0, -60.0, 45.0),
    (100.0, -60.0, 50.0, 60.0, 70.0, -90.0),
)
PLAN = ResolutionCartesian().plan(
    BENCH,
    # From 0.3 mm on: larger steps are made without an error that matters, and take the longest.
    CartesianParams(poses_deg=[list(pose) for pose in POSES], first_mm=0.3, steps=80),
)


def results(folder: Path) -> list[Path]:
    """Return the results of the joints' tests, those of another arm recorded now."""
    if ARM_SEED == SEED:
        return [shipped_file(ARM, joint) for joint in JOINTS]
    paths = [folder / f"{joint}.json" for joint in JOINTS]
    for joint, path in zip(JOINTS, paths, strict=True):
        path.write_text(result_text(joint, ARM_SEED), encoding="utf-8")
    return paths


def predicted(tables: ResolutionTables, number: int) -> dict[str, PredictedStep]:
    found = predict_pose(chain_of(shipped_arm(ARM)), np.array(POSES[number]), tables, number=number + 1)
    return {one.direction: one.least for one in found}


def measured_mm(run: int) -> dict[tuple[str, str], float]:
    """Return the least step of each pose and direction, mm."""
    truth, found = arm_truth(ARM_SEED), {}
    for number, place in enumerate(PLAN.places):
        series = recorded(truth, PLAN, place, 10_000 * (ARM_SEED + 1) + 100 * run + number)
        for test in evaluate_series(series, f"run {run}", 10.0):
            if test.lis is not None:
                found[place.name, f"{'+' if test.direction == 1 else '-'}{test.joint}"] = test.lis.value
    return found


def main() -> None:
    """Print every measured step with its interval, and how many lie inside."""
    with TemporaryDirectory() as folder:
        tables = ResolutionTables(model_arm(results(Path(folder)), InThisProcess()).tables)
    intervals = {f"P{number + 1}": predicted(tables, number) for number in range(len(POSES))}
    inside: list[bool] = []
    unpredicted = 0
    for run in range(RUNS):
        for (pose, direction), value in measured_mm(run).items():
            least = intervals[pose][direction]
            if least.lis is least.high is None:
                unpredicted += 1
            else:
                inside.append((least.low or 0.0) <= value <= (least.high or math.inf))
            print(f"{run} {pose} {direction} measured {value:.5f} mm, predicted {least}", flush=True)  # noqa: T201
    print(f"{sum(inside)} of {len(inside)} inside, {unpredicted} without a prediction")  # noqa: T201


if __name__ == "__main__":
    main()
