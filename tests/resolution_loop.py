"""The whole loop on the emulated bench's own plant: recordings of all joints, models, prediction, measured steps.

No engine and no socket: the plant, its optics and their noise in virtual time. The joints' recordings are those that
are shipped, or those of another arm; steps of the tool are measured at three poses in six directions, with other
random numbers each time.

Run as `python -m tests.resolution_loop`. It prints each run beside what was predicted and how many lie inside, and
fails below 90 %. Where only an upper end is predicted, a measured step up to it counts as inside.

`CATSEYE_LOOP_RUNS` sets the runs of each direction [5], `CATSEYE_LOOP_ARM` the seed of the arm [that of the shipped
recordings]; another arm is recorded first, which takes minutes.
"""

import math
import os
import sys
from collections.abc import Iterator
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
WANTED = 0.9
"""Of the measured steps inside the 95 % intervals."""

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
    """Return what is predicted at a pose, by direction."""
    found = predict_pose(chain_of(shipped_arm(ARM)), np.array(POSES[number]), tables, number=number + 1)
    return {one.direction: one.least for one in found}


def measured_mm(run: int) -> Iterator[tuple[str, str, float | None]]:
    """Yield pose, direction and least step of each, mm; None where a series gives none."""
    truth = arm_truth(ARM_SEED)
    for number, place in enumerate(PLAN.places):
        series = recorded(truth, PLAN, place, 10_000 * (ARM_SEED + 1) + 100 * run + number)
        for test in evaluate_series(series, f"run {run}", 10.0):
            sense = "+" if test.direction == 1 else "-"
            yield place.name, f"{sense}{test.joint}", None if test.lis is None else test.lis.value


def is_inside(value: float | None, least: PredictedStep) -> bool | None:
    """Return whether a measured step lies in its interval; None where nothing is predicted."""
    if least.lis is least.high is None:
        return None
    return value is not None and (least.low or 0.0) <= value <= (least.high or math.inf)


def main() -> None:
    """Print every measured step with its interval, and how many lie inside."""
    with TemporaryDirectory() as folder:
        tables = ResolutionTables(model_arm(results(Path(folder)), InThisProcess()).tables)
    intervals = {f"P{number + 1}": predicted(tables, number) for number in range(len(POSES))}
    found: list[bool | None] = []
    for run in range(RUNS):
        for pose, direction, value in measured_mm(run):
            least = intervals[pose][direction]
            found.append(is_inside(value, least))
            print(  # noqa: T201  # the table of the campaign
                f"{run} {pose} {direction} measured {value} mm, inside {found[-1]}, predicted {least}",
                flush=True,
            )
    judged = [one for one in found if one is not None]
    print(f"{sum(judged)} of {len(judged)} inside, {len(found) - len(judged)} without a prediction")  # noqa: T201  # the figure
    if not judged or sum(judged) < WANTED * len(judged):
        sys.exit(f"fewer than {WANTED:.0%} lie inside")


if __name__ == "__main__":
    main()
