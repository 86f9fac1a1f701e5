"""Six-axis calibration over many emulated sets: accuracy, lack of fit, disturbed sets, choice of the model.

The arm is computed by screws (`tests.unit.calibration.serial_arm.true_arm`), not by the program's model.
`CATSEYE_SIX_AXIS_DRAWS` sets draws [50], `CATSEYE_SIX_AXIS_SETS` disturbed sets [40], `CATSEYE_SIX_AXIS_FIRST` the
first seed of disturbed sets and plants [0].
"""

import os

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.identification import ModelName
from tests.unit.calibration.serial_arm.studies import (
    accuracy,
    chosen_poses,
    disturbed,
    drifts,
    lacks_of_fit,
    plants,
)

DRAWS = int(os.environ.get("CATSEYE_SIX_AXIS_DRAWS", "50"))
SETS = int(os.environ.get("CATSEYE_SIX_AXIS_SETS", "40"))
FIRST = int(os.environ.get("CATSEYE_SIX_AXIS_FIRST", "0"))
PLANTS = 20


def say(text: str) -> None:
    print(f"\n{text}; load {os.getloadavg()[0]:.1f}")  # noqa: T201  # the figures


def rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def test_accuracy_at_chosen_and_random_poses() -> None:
    chosen, drawn = accuracy(chosen_poses(), DRAWS), accuracy(None, DRAWS)
    for name, one in (("38 chosen poses", chosen), ("38 random poses", drawn)):
        say(
            f"{name}, {DRAWS} draws, 1000 unseen poses: mean {one.mean_mm.mean():.4f} mm, maximum "
            f"{one.max_mm.mean():.4f} mm, z {rms(one.z):.3f}"
        )
    assert chosen.mean_mm.mean() <= 0.030
    assert chosen.max_mm.mean() <= 0.075
    assert 0.95 <= rms(np.concatenate([chosen.z, drawn.z])) <= 1.05


def test_lack_of_fit_without_compliance() -> None:
    choice = chosen_poses()
    found, false = (lacks_of_fit(choice, DRAWS, name) for name in ("geometric", "geometric+compliance"))
    say(f"lack of fit in {found:.1%} of {DRAWS} draws without compliance, in {false:.1%} with it")
    assert found >= 0.95
    assert false <= 0.05


def test_disturbed_sets() -> None:
    found = disturbed(SETS, FIRST)
    ratio = found.disturbed_mm.mean() / found.clean_mm.mean()
    say(
        f"{SETS} sets of 100 poses: mean at unseen poses {found.clean_mm.mean():.4f} mm clean, {ratio:.3f} times "
        f"that disturbed; {found.wrong[1]} of {found.wrong[0]} wrong poses named, {found.good[1]} of {found.good[0]} "
        f"good ones; commanded joints taken in {found.commanded}"
    )
    assert ratio <= 1.2
    assert found.wrong[1] >= 0.95 * found.wrong[0]
    assert found.good[1] <= 0.01 * found.good[0]


def test_drift_of_a_base_that_stands_still() -> None:
    sets: dict[ModelName, int] = {"geometric": 300, "geometric+compliance": 300, "maps": 200}
    found = {name: drifts(count, name) for name, count in sets.items()}
    each = ", ".join(f"{found[name]} of {count} with {name}" for name, count in sets.items())
    say(f"drift of a base that stands still reported in {each}")
    # Twice the stated level of 1 % is three standard deviations of so many sets away.
    assert sum(found.values()) <= 0.02 * sum(sets.values())


def test_choice_of_the_model() -> None:
    found = plants(PLANTS, FIRST)
    right = sum(one.taken == one.right for one in found)
    worst = max(one.ratio for one in found)
    say(
        f"{right} of {PLANTS} plants: the right model; largest error over that of the right model {worst:.3f}"
    )
    assert all(one.taken == one.right or one.ratio <= 1.02 for one in found)
