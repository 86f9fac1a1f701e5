"""Least steps from recordings of emulated joints, against what their drivetrains do in the mean of many repeats.

Each joint of each arm is recorded at one of K1 … K5 in both directions: the plant, its optics with their drift,
turbulence and noise, in virtual time. The recordings take the way of a run's: standstill, plateaus, step errors,
least step with its interval. The true one is the paper's rule on the mean of repeats that no instrument sees.

Run as `python -m tests.recorded_least_steps`. It prints each least step beside the true one, the bias, and how many
intervals hold.

`CATSEYE_RECORDED_ARMS` sets how many arms [8], `CATSEYE_RECORDED_FIRST` the first seed [100], an arm that no other
figure was chosen on.
"""

import math
import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.app.results.resolution.recorded_runs import evaluate_series
from catseye.calibration.resolution.decaying import THRESHOLD_PERCENT
from catseye.calibration.resolution.least_step import moving_mean, steps_within
from catseye.procedures.resolution.campaign_plan import CampaignPlan
from catseye.procedures.resolution.resolution import Resolution, ResolutionParams
from catseye.procedures.resolution.step_sizes import RATIO
from catseye.simulators.world.serial.repeated_steps import RepeatedSteps
from tests.shipped_recordings import JOINTS, POSITIONS, chosen
from tests.virtual_bench import BENCH, arm_truth, emulation, recorded, serial_arm

ARMS: Final = int(os.environ.get("CATSEYE_RECORDED_ARMS", "8"))
FIRST: Final = int(os.environ.get("CATSEYE_RECORDED_FIRST", "100"))

REPEATS: Final = 300
LEAST_HELD: Final = 0.88
"""Of 95 % intervals: 96 hold fewer once in 500 times."""


@dataclass(frozen=True)
class Found:
    """A least step from a recording beside the true one.

    Attributes:
        name: of joint, direction and position.
        least_deg: stated; None for none.
        low_deg: end of its 95 % interval.
        high_deg: the other end.
        true_deg: of the mean of many repeats.
    """

    name: str
    least_deg: float | None
    low_deg: float
    high_deg: float
    true_deg: float

    @property
    def held(self) -> bool:
        """The interval holds the true one."""
        return self.low_deg <= self.true_deg <= self.high_deg

    @property
    def steps_off(self) -> float:
        """Steps of the series by which the stated one is too small."""
        return (
            math.nan if self.least_deg is None else math.log(self.true_deg / self.least_deg) / math.log(RATIO)
        )


def plan_of(joint: str, position: str, **params: object) -> CampaignPlan:
    """Return the plan of the decaying test of a joint at a position."""
    return Resolution().plan(BENCH, ResolutionParams.model_validate({**chosen(joint, [position]), **params}))


def found_at(joint: str, plan: CampaignPlan, seed: int) -> Iterator[Found]:
    """Record the series of a plan's only place on the arm of a seed; yield what their evaluation states."""
    truth, (place,) = arm_truth(seed), plan.places
    number = JOINTS.index(joint)
    series = recorded(truth, plan, place, 1_000_000 + len(JOINTS) * seed + number)
    for test in evaluate_series(series, f"arm {seed}", THRESHOLD_PERCENT):
        sizes_deg = np.abs([move.command for move in test.moves])
        copies = RepeatedSteps(
            serial_arm(emulation(seed)), truth.joints[number], number, np.array(place.pose), REPEATS, seed
        )
        errors = copies.mean_errors_percent(sizes_deg, test.direction or 1, plan.dwell_s)
        true_deg = float(sizes_deg[int(steps_within(moving_mean(errors), THRESHOLD_PERCENT)) - 1])
        name = f"arm {seed} {joint}{'+' if test.direction == 1 else '-'} {place.name}"
        if test.lis is None:
            yield Found(name, None, math.inf, -math.inf, true_deg)
        else:
            yield Found(name, test.lis.value, test.lis.low, test.lis.high, true_deg)


def main() -> None:
    """Print all least steps, their bias, and how many intervals hold the true one."""
    found: list[Found] = []
    for seed in range(FIRST, FIRST + ARMS):
        for joint in JOINTS:
            for one in found_at(joint, plan_of(joint, POSITIONS[seed % len(POSITIONS)]), seed):
                found.append(one)
                sys.stdout.write(
                    f"{one.name}: {one.least_deg} deg ({one.low_deg:.2g} ... {one.high_deg:.2g}), true "
                    f"{one.true_deg:.2g}, held {one.held}\n"
                )
                sys.stdout.flush()
    held = float(np.mean([one.held for one in found]))
    bias = float(np.nanmedian([one.steps_off for one in found]))
    sys.stdout.write(
        f"{len(found)} recordings: median bias {bias:+.1f} steps of the series, {100.0 * held:.1f} % within 95 % "
        "intervals\n"
    )
    if held < LEAST_HELD or abs(bias) > 1.0:
        sys.exit(f"fewer than {LEAST_HELD:.0%} are held, or the bias is above 1 step of the series")


if __name__ == "__main__":
    main()
