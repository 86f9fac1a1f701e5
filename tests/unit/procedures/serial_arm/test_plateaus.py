"""Plateaus of a bar's recording, made by hand."""

from itertools import pairwise

import numpy as np
import pytest

from catseye.procedures.serial_arm.plateaus import plateaus

LEVELS = [0.1, -0.05, -0.05, 0.02, 0.3]


def recording(ramp_s: float, noise_mm: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return 20 readings a second: levels of 2 s, and four arcs of 0.06 mm between each and the next."""
    arc = 0.06 * np.abs(np.sin(np.linspace(0.0, 4.0 * np.pi, int(20 * ramp_s))))
    parts = [np.full(40, LEVELS[0])]
    for before, after in pairwise(LEVELS):
        parts += [np.linspace(before, after, len(arc)) - arc, np.full(40, after)]
    values = np.concatenate(parts)
    values = values + noise_mm * np.random.default_rng(3).standard_normal(len(values))
    return 0.05 * np.arange(len(values)), values


@pytest.mark.parametrize("ramp_s", [0.3, 2.0, 6.0])
def test_slow_ways_between_places_are_no_plateaus(ramp_s: float) -> None:
    assert plateaus(*recording(ramp_s), 1.0) == pytest.approx(LEVELS, abs=1e-9)


def test_noise_neither_cuts_nor_shifts_a_plateau() -> None:
    found = plateaus(*recording(2.0, 0.0005), 1.0)
    # 24 readings in the middle of a plateau: 0.1 µm, and five times that.
    assert found == pytest.approx(LEVELS, abs=5e-4)


def test_a_short_stop_is_no_plateau() -> None:
    t_s = 0.05 * np.arange(100, dtype=np.float64)
    values = np.where(np.arange(100) < 50, 0.0, np.where(np.arange(100) < 65, 0.1, 0.2))
    assert plateaus(t_s, values, 1.0) == pytest.approx([0.0, 0.2])


def test_longer_plateaus_are_told_from_stops_on_the_way() -> None:
    lasting = [40, 20, 22, 42, 21, 40]
    values = np.concatenate([np.full(count, 0.1 * number) for number, count in enumerate(lasting)])
    t_s = 0.1 * np.arange(len(values), dtype=np.float64)
    assert plateaus(t_s, values, 1.0, places=3) == pytest.approx([0.0, 0.3, 0.5])
    # Nobody knows which four are meant.
    assert len(plateaus(t_s, values, 1.0, places=4)) == 6
