"""Links of the emulated bench's arms: what their errors over u depend on.

True arms and radial error motions are the bench's own, scatter, warming and scale those of its budget; the network
and the beam are left out. Half of the first harmonic of a motion turns with the link and lengthens it, which no
distance shows. The bench's motions fall with the order; the budget expects an even spread.

`CATSEYE_LINK_SETS` sets how many arms [60].
"""

import math
import os
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.identification import identify
from catseye.calibration.scara.points import Points
from catseye.simulators.config import STEEL_PER_K, ErrorBudget
from catseye.simulators.world.scara.axis_errors import FlankTable, RadialError
from catseye.simulators.world.scara.truth import TrueArm, draw_truth
from catseye.simulators.world.types import Plane
from tests.campaigns.test_between_nodes import SEQUENCE, commands_of
from tests.campaigns.test_drift import BUDGET, rms
from tests.unit.calibration.scara.paper import NAMES, NODES1_DEG, NODES2_DEG
from tests.unit.simulators.benches import QUIET

SETS = int(os.environ.get("CATSEYE_LINK_SETS", "60"))
BENCH = ErrorBudget()
ORDERS = 5
START_S, ROW_S = 600.0, 2.3
COMMANDS = commands_of(SEQUENCE * len(NAMES))
SERIES = np.repeat(np.arange(len(NAMES)), len(SEQUENCE))

Shift = Callable[[Floats], Plane]
"""Displacement of an axis at command angles in deg, mm."""


def of_bench(rng: np.random.Generator, rms_um: float) -> Shift:
    return RadialError(rng, rms_um).shift_mm


_WORK = 0.2
"""Heat of this work, as a part of that of motion at full speed without a pause: slow, and half of the time."""


def evenly_spread(rng: np.random.Generator, rms_um: float) -> Shift:
    factors = rng.normal(0.0, 1e-3 * rms_um / math.sqrt(ORDERS), (2, 2, ORDERS))

    def shift_mm(theta_deg: Floats) -> Plane:
        angles = np.deg2rad(theta_deg)[:, None] * np.arange(1, ORDERS + 1)
        x, y = (np.cos(angles) @ cosine + np.sin(angles) @ sine for cosine, sine in factors)
        return np.asarray(x + 1j * y)

    return shift_mm


def measured(seed: int, motion: Callable[[np.random.Generator, float], Shift]) -> tuple[Points, TrueArm]:
    truth = draw_truth(seed, replace(QUIET, seed=seed))
    # The bench draws its motions so.
    drawn = np.random.default_rng([seed, 3])
    j1, j2, j4 = (motion(drawn, size_um) for size_um in BENCH.radial_um)
    rng, count = np.random.default_rng([seed, 78]), len(COMMANDS)
    one, both = COMMANDS.theta1_rad, COMMANDS.theta1_rad + COMMANDS.theta2_rad
    one_deg, two_deg = np.rad2deg(one), np.rad2deg(COMMANDS.theta2_rad)
    first = one + FlankTable(truth.theta1_map).deviation_rad(one_deg, COMMANDS.direction1.astype(np.float64))
    second = first + COMMANDS.theta2_rad
    second += FlankTable(truth.theta2_map).deviation_rad(two_deg, COMMANDS.direction2.astype(np.float64))
    warmed = -np.expm1(-(START_S + ROW_S * np.arange(count)) / BENCH.thermal_time_s)
    axis = truth.link1_mm * np.exp(1j * first) + truth.link2_mm * np.exp(1j * second)
    axis *= 1.0 + STEEL_PER_K * BENCH.thermal_k * _WORK * warmed
    place = np.array([complex(*truth.reflectors[name]) for name in NAMES])[SERIES]
    nominal = 325.0 * np.exp(1j * one) + 225.0 * np.exp(1j * both)
    axis += j1(one_deg) + np.exp(1j * one) * j2(two_deg)
    axis += np.exp(1j * both) * j4(np.rad2deg(np.angle(place - nominal) - both))
    axis += 1e-3 * BENCH.repeatability_um * (rng.normal(size=count) + 1j * rng.normal(size=count))
    scale = 1.0 + rng.normal() * 1e-3 / 700.0 * math.hypot(BENCH.wavelength_um, BENCH.correction_um)
    lengths = np.abs(axis - place) * scale + rng.normal(0.0, 1e-3 * BENCH.counter_noise_um, count)
    paths = tuple((name, 0) for name in NAMES)
    return Points(COMMANDS, SERIES, SERIES.copy(), lengths - 400.0, None, NAMES, paths), truth


def errors_of_links(seed: int, motion: Callable[[np.random.Generator, float], Shift]) -> Floats:
    points, truth = measured(seed, motion)
    nodes = np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)
    places = np.array([truth.reflectors[name] for name in NAMES])
    found = identify(points, "error-map", *nodes, 325.0, 225.0, places, BUDGET)
    error = found.parameters[:2] - [truth.link1_mm, truth.link2_mm]
    return np.asarray(error / found.standard_uncertainty[:2])


@pytest.mark.timeout(60 + 20 * SETS)
@pytest.mark.parametrize("motion", [evenly_spread, of_bench])
def test_uncertainties_of_links_are_honest(motion: Callable[[np.random.Generator, float], Shift]) -> None:
    errors = np.array([errors_of_links(seed, motion) for seed in range(SETS)])
    beyond = (np.abs(errors) > 3.0).sum(axis=0)
    one, two = rms([errors[:, 0]]), rms([errors[:, 1]])
    print(f"\n{motion.__name__}, {SETS} arms: z of L1 {one:.2f}, of L2 {two:.2f}; beyond 3 u: {beyond}")  # noqa: T201  # the figure
    assert 0.8 < one < 1.2
    assert 0.8 < two < 1.2
    assert max(beyond) <= 1
