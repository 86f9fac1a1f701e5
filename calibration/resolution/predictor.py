"""Cartesian resolution from that of the joints (resolution paper, section 5.1): step errors through the kinematics.

Every commanded step of the tool is split into the joint increments that make it exactly; each increment gets an
error drawn from its joint's tables, and the arm's motion with these says how far the tool goes. A draw stands for one
run of a measurement, so the interval holds what one run finds, and not the expectation alone.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, Self

import numpy as np

from catseye.calibration.core.arguments import require_count, require_finite, require_positive, require_shape
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.joint_ranges import beyond_text, ranges_of, within
from catseye.calibration.resolution.cartesian_steps import DIRECTIONS, CartesianSteps, StepSeries
from catseye.calibration.resolution.least_step import moving_mean, steps_within
from catseye.calibration.resolution.tables import ResolutionTables

UNKNOWN_PART = 0.5
"""Part of the threshold that joints without known errors may contribute at worst."""

FEWEST_DRAWS = 40
"""An interval of 95 % lies within the extremes of so many draws."""


@dataclass(frozen=True)
class PredictionMethod:
    """How a prediction is made.

    Attributes:
        threshold_percent: largest error of a step that counts as made.
        draws: runs that are simulated.
        seed: of the draws.
        series: commanded steps.
    """

    threshold_percent: float = 10.0
    draws: int = 50
    seed: int = 1
    series: StepSeries = field(default_factory=StepSeries)

    def __post_init__(self) -> None:
        require_positive(self.threshold_percent, "threshold_percent")
        require_count(self.draws, "draws", FEWEST_DRAWS)
        require_count(self.seed, "seed", 0)


@dataclass(frozen=True)
class PredictedStep:
    """The least increment step of a direction.

    Attributes:
        lis: where the mean error leaves the threshold, mm or deg; None where the reason says why it is not known.
        low: lower end of the 95 % interval of what one run of a measurement finds, 0 where runs keep within the
            threshold as far as steps are covered; None where nothing is known.
        high: upper end of it, which may be known without `lis`; None where it is not known.
        reason: why a number is missing; empty when none is.
    """

    lis: float | None
    low: float | None
    high: float | None
    reason: str


@dataclass(frozen=True)
class DirectionPrediction:
    """What is predicted of one direction.

    Attributes:
        direction: one of `DIRECTIONS`.
        steps: those that the tables cover, by decreasing size, shape (n,).
        mean_percent: error along the direction, of the step, mean of the draws, shape (n,).
        std_percent: standard deviation of a single step, shape (n,).
        across_percent: motion across the direction, root mean square, shape (n,).
        least: the least increment step.
    """

    direction: str
    steps: Floats
    mean_percent: Floats
    std_percent: Floats
    across_percent: Floats
    least: PredictedStep

    @classmethod
    def without_steps(cls, direction: str, reason: str) -> Self:
        """Return that no step of a direction is covered, and why."""
        none = np.zeros(0)
        return cls(direction, none, none, none, none, _no_step(reason))


def predict_pose(
    chain: Chain,
    pose: Floats,
    tables: ResolutionTables,
    method: PredictionMethod | None = None,
    tool: Floats | None = None,
    approach: Ints | None = None,
    number: int = 0,
) -> Sequence[DirectionPrediction]:
    """Return what is predicted of all directions at a pose.

    Args:
        chain: the arm.
        pose: joints, deg or mm, shape (joints,).
        tables: step errors of the joints.
        method: 50 draws, threshold 10 %, steps from 1 mm and 0.03° without one.
        tool: the tool centre point in the last frame, shape (4, 4); that frame itself without one.
        approach: sense of each joint's last motion, 1 or -1, 0 where nobody knows, which counts as a reversal; shape
            (joints,). A joint that reverses loses its reversal error at each step. None leaves reversals out.
        number: of the pose, which has draws of its own.

    Raises:
        ArgumentError: the pose does not fit the arm.
    """
    require_shape(pose, (len(chain.joints),), "pose")
    require_finite(pose, "pose")
    method = method or PredictionMethod()
    if not within(pose, *ranges_of(chain)).all():
        return [DirectionPrediction.without_steps(one, beyond_text(chain, pose)) for one in DIRECTIONS]
    steps = CartesianSteps(chain, pose, tables, method.series, tool, approach)
    seeds = np.random.SeedSequence(method.seed, spawn_key=(number,)).spawn(len(DIRECTIONS))
    return [
        _predicted(steps, direction, method, np.random.default_rng(seed))
        for direction, seed in enumerate(seeds)
    ]


def _predicted(
    steps: CartesianSteps, direction: int, method: PredictionMethod, rng: np.random.Generator
) -> DirectionPrediction:
    covered = steps.open_percent[direction] <= UNKNOWN_PART * method.threshold_percent
    count = int(np.cumprod(covered).sum())
    if not count:
        largest = f"{steps.sizes[direction, 0]:.2g} {unit_of(DIRECTIONS[direction])}"
        why = f"at the first step, {largest}: {steps.why_open(direction, 0)}"
        return DirectionPrediction.without_steps(DIRECTIONS[direction], why)
    draws = steps.draw(direction, count, method.draws, rng)
    sizes = steps.sizes[direction, :count]
    why_end = "the series ends" if count == covered.size else steps.why_open(direction, count)
    return DirectionPrediction(
        DIRECTIONS[direction],
        sizes,
        draws.along_percent.mean(axis=1),
        draws.along_percent.std(axis=1),
        np.sqrt(np.mean(draws.across_percent**2, axis=1)),
        _least_step(sizes, draws.along_percent, method, unit_of(DIRECTIONS[direction]), why_end),
    )


def _least_step(
    sizes: Floats, errors_percent: Floats, method: PredictionMethod, unit: str, why_end: str
) -> PredictedStep:
    """Return the least increment step of the mean, and where those of single runs lie.

    Ends of the interval lie half a step of the series beyond those of the runs: a measurement has steps of its own.

    Args:
        sizes: by decreasing size, shape (n,).
        errors_percent: of the steps, shape (n, draws).
        why_end: why there are no smaller steps.
    """
    threshold = method.threshold_percent
    mean = moving_mean(errors_percent.mean(axis=1))
    expected = int(steps_within(mean, threshold))
    if not expected:
        text = f"the error is {mean[0]:+.0f} % at the first step, {sizes[0]:.2g} {unit}: the least step is larger"
        return _no_step(text)
    runs = steps_within(moving_mean(errors_percent.T), threshold)
    fewest, most = np.quantile(runs, [0.025, 0.975], method="weibull")
    fewest, most = min(math.floor(fewest), expected), max(math.ceil(most), expected)
    half = math.sqrt(method.series.ratio)
    end = f"within ±{threshold:g} % down to {sizes[-1]:.2g} {unit}, where {why_end}"
    said = (
        (end, expected == sizes.size),
        (f"runs are {end}", expected < most == sizes.size),
        (f"runs are beyond ±{threshold:g} % at the first step, {sizes[0]:.2g} {unit}", not fewest),
    )
    return PredictedStep(
        float(sizes[expected - 1]) if expected < sizes.size else None,
        float(sizes[most - 1]) / half if most < sizes.size else 0.0,
        float(sizes[fewest - 1]) * half if fewest else None,
        "; ".join(text for text, is_so in said if is_so),
    )


def unit_of(direction: str) -> Literal["deg", "mm"]:
    """Return the unit of the steps of a direction."""
    return "deg" if "R" in direction else "mm"


def _no_step(reason: str) -> PredictedStep:
    return PredictedStep(None, None, None, reason)
