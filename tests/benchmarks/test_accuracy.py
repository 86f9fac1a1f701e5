"""Figures of the solver on the paper's layout: recovery, and the honesty of the uncertainties."""

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.distance_model import distance_model
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.radial import RadialBudget, radial_effects
from tests.unit.calibration.scara.paper import (
    MDEG,
    NODES1_DEG,
    NODES2_DEG,
    NOMINAL_REFLECTORS,
    paper_points,
    random_truth,
)
from tests.unit.calibration.scara.samples import identified, radial_motions

NODES = np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)
SEEDS = 60
RADIAL = RadialBudget(0.005, 0.005, 0.010)


def test_recovery_from_noise_free_points() -> None:
    worst_map, worst_link = 0.0, 0.0
    for seed in range(10):
        truth = random_truth(seed)
        found = identified(paper_points(truth))
        error = np.abs(found.parameters[:40] - truth.table_vector())
        worst_link, worst_map = max(worst_link, error[:2].max()), max(worst_map, error[2:].max() / MDEG)
    print(f"\nnoise-free: map to {worst_map:.1e} mdeg, links to {worst_link:.1e} mm (limits 1e-8)")  # noqa: T201  # the figure
    assert worst_map < 1e-8
    assert worst_link < 1e-8


def test_white_noise() -> None:
    truth, errors, chi2 = random_truth(3), [], []
    for seed in range(SEEDS):
        noise = np.random.default_rng(seed).normal(0.0, 0.0156, 1056)
        points = paper_points(truth, noise_mm=noise, sigma_mm=0.0156)
        found = identified(points)
        errors.append((found.parameters[:40] - truth.table_vector()) / found.standard_uncertainty[:40])
        chi2.append(found.fit.chi2_reduced)
    rms, mean = float(np.sqrt(np.mean(np.square(errors)))), float(np.mean(np.array(chi2, dtype=np.float64)))
    print(f"\nwhite noise, {SEEDS} seeds: normalised errors {rms:.3f} rms, χ²/dof {mean:.3f} (0.9…1.1)")  # noqa: T201  # the figure
    assert 0.9 < rms < 1.1
    assert 0.9 < mean < 1.1


def systematic() -> Floats:
    points = paper_points(random_truth(3))
    layout = Layout("error-map", *NODES, points.reflector_names, points.dead_paths)
    model = distance_model(layout, points)
    start = model.start(325.0, 225.0, NOMINAL_REFLECTORS)
    return radial_effects(points, model.beam(start)[1], RADIAL)


def test_radial_error_motions() -> None:
    truth, effects = random_truth(3), systematic()
    with_budget: list[Floats] = []
    without: list[Floats] = []
    ratios: list[float] = []
    for seed in range(SEEDS):
        rng = np.random.default_rng(seed)
        noise = rng.normal(0.0, 0.010, 1056) + effects @ rng.standard_normal(effects.shape[1])
        points = paper_points(truth, noise_mm=noise, sigma_mm=0.010)
        for budget, collected in ((radial_motions(RADIAL), with_budget), (None, without)):
            found = identified(points, budget=budget)
            collected.append((found.parameters[:40] - truth.table_vector()) / found.standard_uncertainty[:40])
        assert found.fit.lack_of_fit is not None
        ratios.append(found.fit.lack_of_fit.ratio)
        assert found.fit.lack_of_fit.significant
    stated, white = (float(np.sqrt(np.mean(np.square(one)))) for one in (with_budget, without))
    figure = f"normalised errors {stated:.2f} rms with the stated budget, {white:.2f} as if white"
    print(f"\nradial error motions, {SEEDS} seeds: {figure}; lack of fit F = {np.mean(ratios):.1f}")  # noqa: T201  # the figure
    assert 0.9 < stated < 1.1
