"""Least steps from recordings of short series, against what the drivetrain does in the mean of many repeats.

Copies of one emulated joint are stepped at once: drivetrain, encoder and servo in a run-in, in a standstill in
which the joint creeps on, and in decreasing steps with a dwell behind each. The optics of each copy drift and shimmer
by themselves, and their counter rounds. Each recording takes the way of a run's. The true least step is the paper's
rule, written out, on the mean of copies that no instrument sees: what ADR 34 says is stated.

Run as `python -m tests.short_series`. It prints how many intervals hold, by the number of steps and the length of
the standstill. The rule gives whole steps of the series: what it rounds away counts against the intervals of one
joint where its mean error leaves the threshold right at a step. So many arms are tried.

`CATSEYE_SHORT_COPIES` sets how many recordings each [400], `CATSEYE_SHORT_FIRST` the first seed [0];
`CATSEYE_SHORT_ARM` takes all of them on the arm of that seed, and not on 40 arms, seeds 100…139.
"""

import math
import os
import sys
import time
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from catseye.app.results.resolution.evaluation import Asked, Series, evaluated
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.moves import moves_of
from catseye.calibration.resolution.optics import U_ZERO_DEG, AngularOptics
from catseye.calibration.resolution.recording import recording_of
from catseye.calibration.resolution.standstill import standstill
from catseye.procedures.resolution.step_sizes import RATIO
from catseye.simulators.config import ArmOptics
from catseye.simulators.world.serial.optics import Wander
from catseye.simulators.world.serial.truth import draw_joint_truth
from tests.unit.simulators.world.serial.arms import serial_arm
from tests.unit.simulators.world.serial.trials import POSITIONS_DEG, Trials, least_step_deg

COPIES: Final = int(os.environ.get("CATSEYE_SHORT_COPIES", "400"))
FIRST: Final = int(os.environ.get("CATSEYE_SHORT_FIRST", "0"))

ARMS: Final = (
    (int(os.environ["CATSEYE_SHORT_ARM"]),) if "CATSEYE_SHORT_ARM" in os.environ else tuple(range(100, 140))
)

LEAST_HELD: Final = 0.92
"""Of 400 intervals at 95 %, fewer hold once in 200 times."""

ARM: Final = serial_arm("kr210-r2700")
OPTICS: Final = ArmOptics()
DEG: Final = math.pi / 180.0

_REPEATS: Final = 1000
_RATE_HZ: Final = 25.0
_MOTION_S: Final = 0.24
_SETTLING_S: Final = 2.0
"""From the end of the run-in to the begin of the recording."""

_BACK: Final = -1


@dataclass(frozen=True)
class Plan:
    """A series of decreasing steps of one joint at its middle position, backwards.

    Attributes:
        steps: how many.
        first_deg: size of the first one.
        standstill_s: before the first move.
        dwell_s: rest behind each move.
        joint: its name.
        arm: seed of the drivetrains.
    """

    steps: int = 62
    first_deg: float = 0.005
    standstill_s: float = 15.0
    dwell_s: float = 1.5
    joint: str = "A1"
    arm: int = 2

    @property
    def sizes_deg(self) -> Floats:
        """Sizes of the steps, shape (steps,)."""
        return np.asarray(self.first_deg / RATIO ** np.arange(float(self.steps)))

    @property
    def move_times_s(self) -> Floats:
        """When the moves begin, shape (steps,)."""
        return self.standstill_s + (_MOTION_S + self.dwell_s) * np.arange(float(self.steps))

    def copies(self, count: int, seed: int) -> Trials:
        """Return copies of the joint."""
        number = [joint.name for joint in ARM.joints].index(self.joint)
        truth = draw_joint_truth(ARM, self.arm).joints[number]
        middle_deg = POSITIONS_DEG[self.joint][2]
        return Trials(ARM, truth, number, middle_deg, count, seed, self.dwell_s)


@dataclass(frozen=True)
class Found:
    """A stated least step beside the true one.

    Attributes:
        steps_off: steps of the series by which the stated one is too small; NaN for none.
        low: the true one lies below the interval.
        high: it lies above.
        width: of the interval, in steps of the series; infinite where it reaches 0.
    """

    steps_off: float
    low: bool
    high: bool
    width: float


def true_least_step_deg(plan: Plan, repeats: int = _REPEATS) -> float:
    """Return the least step of the mean of many repeats, without an instrument."""
    errors_percent = plan.copies(repeats, 987_654).decaying(_BACK, plan.sizes_deg).mean(axis=1)
    return least_step_deg(errors_percent, sizes_deg=plan.sizes_deg)


def sampled_deg(plan: Plan, count: int, seed: int) -> tuple[Floats, Floats]:
    """Return times and where the links of copies stand, shape (n,) and (n, count)."""
    copies = plan.copies(count, seed)
    copies.run_in(_BACK)
    begins_s = plan.move_times_s
    ends_s = np.append(begins_s[1:], begins_s[-1] + _MOTION_S + plan.dwell_s)
    times_s = np.arange(round(ends_s[-1] * _RATE_HZ)) / _RATE_HZ
    links = [copies.at_rest_deg(_SETTLING_S + times_s[times_s < begins_s[0]])]
    copies.rest(_SETTLING_S + plan.standstill_s)
    for size, begin_s, end_s in zip(plan.sizes_deg, begins_s, ends_s, strict=True):
        since_s = times_s[(times_s >= begin_s) & (times_s < end_s)] - begin_s
        start = copies.drive.link_deg
        copies.step(_BACK * float(size))
        stands = copies.at_rest_deg(np.maximum(since_s - _MOTION_S, 0.0))
        share = 0.5 - 0.5 * np.cos(np.pi * np.clip(since_s / _MOTION_S, 0.0, 1.0))
        links.append(start + share[:, None] * (stands - start))
    return times_s, np.concatenate(links)


def counted_mm(times_s: Floats, links_deg: Floats, seed: int) -> Floats:
    """Return what the optics of one copy count, shape (n,)."""
    rng = np.random.default_rng([seed, 22])
    tripod_rad = Wander(rng, 1e-6 * OPTICS.tripod_urad, (120.0, 3600.0))
    turbulence_mm = Wander(rng, 1e-6 * OPTICS.turbulence_nm, (0.3, 30.0))
    spacing_mm = OPTICS.spacing_mm + OPTICS.u_spacing_mm * rng.standard_normal()
    length_mm = spacing_mm * (np.sin((links_deg - links_deg[0]) * DEG) + tripod_rad.at(times_s))
    # A tenth of the turbulence differs between two beams beside each other.
    length_mm += 0.1 * turbulence_mm.at(times_s)
    length_mm += 1e-6 * OPTICS.noise_nm * rng.standard_normal(times_s.size)
    return np.asarray(1e-6 * OPTICS.resolution_nm * np.round(length_mm / (1e-6 * OPTICS.resolution_nm)))


def series_of(plan: Plan, times_s: Floats, length_mm: Floats) -> Series:
    """Return a recorded series as a run of the program has it."""
    optics = AngularOptics(
        OPTICS.spacing_mm, OPTICS.u_spacing_mm, 1e-3 * OPTICS.distance_mm, u_zero_rad=U_ZERO_DEG * DEG
    )
    recording = recording_of(times_s, optics.angle_rad(length_mm - length_mm[0]), "rad")
    moves = moves_of(plan.move_times_s, _BACK * plan.sizes_deg * DEG, "rad")
    still = standstill(recording.clipped(0.0, plan.standstill_s))
    return Series(recording, moves, optics.over(recording.position), still, confirmed=True)


def found_by(plan: Plan, count: int, first: int = FIRST) -> list[Found]:
    """Evaluate recordings of copies of a joint, each with its own optics."""
    true_deg = true_least_step_deg(plan)
    times_s, links_deg = sampled_deg(plan, count, 1_000_000 + first)
    return [
        _found(series_of(plan, times_s, counted_mm(times_s, links, first + number)), plan, true_deg)
        for number, links in enumerate(links_deg.T)
    ]


def found_on(arms: tuple[int, ...], plan: Plan, count: int, first: int = FIRST) -> list[Found]:
    """Evaluate recordings of a plan, as many on each arm."""
    each = max(1, count // len(arms))
    return [
        one
        for number, arm in enumerate(arms)
        for one in found_by(replace(plan, arm=arm), each, first + number * each)
    ]


def _found(series: Series, plan: Plan, true_deg: float) -> Found:
    least = evaluated(Asked("decaying", plan.joint), [series]).lis
    if least is None:
        return Found(math.nan, True, True, math.inf)
    width = math.log(least.high / least.low) / math.log(RATIO) if least.low > 0.0 else math.inf
    off = math.log(true_deg / least.value) / math.log(RATIO)
    return Found(off, true_deg < least.low, true_deg > least.high, width)


def held_share(found: list[Found]) -> float:
    """Return the share of intervals that hold the true least step."""
    return float(np.mean([not (one.low or one.high) for one in found]))


def plans() -> list[Plan]:
    """Return series by the number of steps, all down to the same one, and by the standstill."""
    last_deg = Plan().sizes_deg[-1]
    by_steps = [Plan(steps, float(last_deg * RATIO ** (steps - 1))) for steps in (30, 40, 50, 62, 80, 109)]
    by_standstill = [Plan(standstill_s=still_s) for still_s in (20.0, 30.0, 60.0)]
    both = [Plan(40, by_steps[1].first_deg, still_s) for still_s in (30.0, 60.0)]
    longer = [Plan(dwell_s=5.0), Plan(standstill_s=60.0, dwell_s=5.0)]
    others = [Plan(62, first_deg, joint=joint) for joint, first_deg in (("A3", 0.01), ("A5", 0.1))]
    return [*by_steps, *by_standstill, *both, *longer, *others]


def main() -> None:
    """Print how many intervals hold for each plan."""
    failed = False
    for plan in plans():
        begun_s = time.monotonic()
        found = found_on(ARMS, plan, COPIES)
        held, off = held_share(found), np.array([one.steps_off for one in found])
        failed |= held < LEAST_HELD
        sys.stdout.write(
            f"{plan.joint} of {len(ARMS)} arm(s): {plan.steps} steps from {plan.first_deg:.3g} deg, standstill "
            f"{plan.standstill_s:g} s, dwell {plan.dwell_s:g} s: {100.0 * held:.1f} % of {len(found)} hold; "
            f"{sum(one.high for one in found)} too small, {sum(one.low for one in found)} too large; "
            f"off by {np.nanmean(off):+.2f} steps in the mean, {np.nanmedian(off):+.1f} in the median; width "
            f"{np.median([one.width for one in found]):.1f} steps; {time.monotonic() - begun_s:.0f} s\n"
        )
        sys.stdout.flush()
    if failed:
        sys.exit(f"fewer than {LEAST_HELD:.0%} of the intervals hold")


if __name__ == "__main__":
    main()
