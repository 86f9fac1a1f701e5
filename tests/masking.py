"""How often reversals mask what a joint resolves in one direction: tests by ISO 230 beside decaying tests.

Each joint of each arm is tested at one of K1 … K5 by three times ten equal steps of growing size, and by the decaying
test in one direction, with the noise of an interferometer. Run as `python -m tests.masking`; it prints a row for each
joint, and fails where A1, whose play the resolution paper sees mask its steps (Fig. 4), does not show it.

`CATSEYE_RESOLUTION_SEEDS` sets how many arms [50], `CATSEYE_RESOLUTION_FIRST` the first seed [0].
"""

import math
import os
import sys
from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.decaying import DecayingTest, decaying_test
from catseye.calibration.resolution.iso import IsoTest, iso_amplitude, iso_test
from catseye.simulators.world.serial.truth import draw_joint_truth
from tests.unit.calibration.resolution.measured import decaying_steps, measured_steps
from tests.unit.calibration.resolution.staircase import DEG
from tests.unit.simulators.world.serial.arms import TOOL, serial_arm
from tests.unit.simulators.world.serial.trials import POSITIONS_DEG, STEPS_DEG, Trials

FIRST: Final = int(os.environ.get("CATSEYE_RESOLUTION_FIRST", "0"))
SEEDS: Final = range(FIRST, FIRST + int(os.environ.get("CATSEYE_RESOLUTION_SEEDS", "50")))

ARM: Final = serial_arm("kr210-r2700", TOOL)
NAMES: Final = tuple(joint.name for joint in ARM.joints)

SIZES_DEG: Floats = np.geomspace(2e-4, 5e-2, 17)
"""Of the equal steps, by a factor of 1.41 each."""

U_STEP_DEG: Final = 2e-6
"""Noise of a step by the interferometer: 0.035 µrad."""

EQUAL_STEPS: Final = np.repeat([1.0, -1.0, 1.0], 10)

_SHOWN: Final = "A1"
_WANTED: Final = 0.9


@dataclass(frozen=True)
class Compared:
    """One joint, tested both ways.

    Attributes:
        iso_deg: least step after ISO 230; beyond the largest size where that fails.
        between_deg: the same without the steps behind a reversal.
        one_way_deg: least step in one direction.
        one_way_high_deg: upper end of its 95 % interval.
    """

    iso_deg: float
    between_deg: float
    one_way_deg: float
    one_way_high_deg: float

    @property
    def masked(self) -> bool:
        """The steps behind a reversal are what the test by ISO 230 fails on."""
        return self.between_deg < self.iso_deg

    @property
    def hidden(self) -> bool:
        """The test by ISO 230 states more than the joint makes in one direction, beyond the uncertainty of that."""
        return self.iso_deg > self.one_way_high_deg


def compared(seed: int, joint: int) -> Compared:
    """Test a joint of an arm both ways."""
    equal, one_way = by_equal_steps(seed, joint), in_one_direction(seed, joint).least_step
    if one_way is None:
        raise ValueError(f"{NAMES[joint]} of arm {seed} makes no step within the threshold")
    return Compared(
        _deg(equal.least_step), _deg(equal.between_reversals), one_way.value / DEG, one_way.high / DEG
    )


def _deg(least_rad: float | None) -> float:
    return math.inf if least_rad is None else least_rad / DEG


def trial(seed: int, joint: int) -> Trials:
    """Return a joint at its place."""
    truth = draw_joint_truth(ARM, seed).joints[joint]
    position_deg = POSITIONS_DEG[NAMES[joint]][seed % 5]
    return Trials(ARM, truth, joint, position_deg, seed=5000 + len(NAMES) * seed + joint)


def by_equal_steps(seed: int, joint: int) -> IsoTest:
    """Test a joint by three times ten equal steps of each size."""
    tried, noise = trial(seed, joint), np.random.default_rng([seed, joint, 1])
    found = []
    for size in SIZES_DEG.tolist():
        tried.run_in(1)
        command = size * EQUAL_STEPS
        targets = float(tried.drive.motor_deg[0]) + np.cumsum(command)
        places = [float(tried.drive.link_deg[0])]
        places += [float(tried.go(np.array([target]))[0]) for target in targets]
        seen = np.array(places) + noise.normal(0.0, U_STEP_DEG / math.sqrt(2.0), len(places))
        found.append(iso_amplitude(measured_steps(command * DEG, seen * DEG, U_STEP_DEG * DEG)))
    return iso_test(found)


def in_one_direction(seed: int, joint: int) -> DecayingTest:
    """Test a joint by decaying steps."""
    errors = trial(seed, joint).decaying(1)[:, 0]
    noise = np.random.default_rng([seed, joint, 2]).normal(0.0, U_STEP_DEG, errors.shape)
    return decaying_test(
        decaying_steps(STEPS_DEG * DEG, errors + 100.0 * noise / STEPS_DEG, U_STEP_DEG * DEG), seed=seed
    )


def row_of(found: list[Compared]) -> tuple[str, ...]:
    """Return the figures of a joint: how often, and by how much in the middle."""
    ratios = [one.iso_deg / one.one_way_deg for one in found]
    return (
        f"{sum(one.masked for one in found)} of {len(found)}",
        f"{sum(one.hidden for one in found)} of {len(found)}",
        f"{np.median([one.iso_deg for one in found]):.2g}°",
        f"{np.median([one.one_way_deg for one in found]):.2g}°",
        f"{np.median(ratios):.2g} ({np.quantile(ratios, 0.1):.2g}…{np.quantile(ratios, 0.9):.2g})",
    )


def main() -> None:
    """Print the table of all joints."""
    sys.stdout.write(
        "joint | masked behind reversals | above the interval in one direction | ISO | one way | ratio\n"
    )
    for joint, name in enumerate(NAMES):
        found = [compared(seed, joint) for seed in SEEDS]
        sys.stdout.write(" | ".join((name, *row_of(found))) + "\n")
        sys.stdout.flush()
        if name == _SHOWN and sum(one.hidden for one in found) < _WANTED * len(found):
            sys.exit(
                f"{name}: what it makes in one direction is hidden in fewer than {_WANTED:.0%} of the arms"
            )


if __name__ == "__main__":
    main()
