"""Plateaus of a made recording."""

import numpy as np
import pytest

from catseye.procedures.serial_arm.plateaus import plateaus


def recording(
    levels: list[float], still_s: float = 2.0, moving_s: float = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    rate = 20.0
    values: list[float] = []
    for before, after in zip([levels[0], *levels], levels, strict=False):
        values += np.linspace(before - 0.6, after, int(rate * moving_s)).tolist()
        values += [after] * int(rate * still_s)
    noise = np.random.default_rng(1).normal(0.0, 0.0005, len(values))
    return np.arange(len(values)) / rate, np.array(values) + noise


def test_every_standstill_gives_its_mean() -> None:
    levels = [0.1, -0.25, 0.4, 0.0, 0.33]
    assert plateaus(*recording(levels), least_s=1.0) == pytest.approx(levels, abs=0.001)


def test_short_halts_are_no_plateaus() -> None:
    assert plateaus(*recording([0.1, 0.2], still_s=0.5), least_s=1.0) == []
