"""Robust estimates against scipy's general solver, stated efficiencies, and contaminated distances."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy import integrate, optimize, stats

from catseye.calibration.core.robust import TUNING, Loss, loss_weight
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.diagnostics.robust import robust_fit
from catseye.calibration.scara.distance_model import distance_model
from catseye.calibration.scara.points import Points
from tests.unit.calibration.scara.diagnostics.bench import commands_on_nodes, measured, problem
from tests.unit.calibration.scara.paper import MDEG, random_truth

LOSSES: list[Loss] = ["huber", "soft-l1"]
TRUTH = random_truth(2)


@cache
def clean() -> Points:
    return measured(TRUTH, commands_on_nodes(), sigma_mm=0.01)


def noisy(seed: int, share: float, size_mm: float = 0.5) -> Points:
    rng = np.random.default_rng(seed)
    points = clean()
    error = rng.normal(0.0, 0.01, len(points))
    wrong = rng.random(len(points)) < share
    error[wrong] += rng.uniform(0.2, 1.0, int(wrong.sum())) * size_mm
    return replace(points, displacement_mm=points.displacement_mm + error)


@pytest.mark.parametrize("loss", LOSSES)
def test_minimum_is_the_one_that_scipy_finds(loss: Loss) -> None:
    identified = problem(noisy(1, 0.08)).solve()
    found = robust_fit(identified, loss)
    model, basis = distance_model(identified.layout, identified.points), identified.layout.gauge_basis()
    start = identified.parameters

    def residuals(step: Floats) -> Floats:
        return model.residuals(start + basis @ step) / 0.01

    def jacobian(step: Floats) -> Floats:
        return np.asarray(model.jacobian(start + basis @ step) @ basis / 0.01, dtype=np.float64)

    peer = optimize.least_squares(
        residuals,
        np.zeros(basis.shape[1]),
        jac=jacobian,
        loss="huber" if loss == "huber" else "soft_l1",
        f_scale=TUNING[loss] * found.scale,
        x_scale="jac",
        xtol=1e-15,
        ftol=1e-15,
        gtol=1e-12,
        max_nfev=400,
    )
    difference = model.residuals(found.identified.parameters) - 0.01 * residuals(peer.x)
    assert float(np.abs(difference).max()) < 2e-6


@pytest.mark.parametrize("loss", LOSSES)
def test_tuning_gives_95_percent_efficiency_for_normal_errors(loss: Loss) -> None:
    def influence(x: float) -> float:
        return x * float(loss_weight(np.array([x]), loss)[0])

    k = TUNING[loss]
    knots = [-k, k] if loss == "huber" else [0.0]
    square = integrate.quad(lambda x: influence(x) ** 2 * stats.norm.pdf(x), -9, 9, points=knots)[0]
    # The mean slope of the influence, by parts: the mean of x times the influence.
    slope = integrate.quad(lambda x: influence(x) * x * stats.norm.pdf(x), -9, 9, points=knots)[0]
    assert slope**2 / square == pytest.approx(0.95, abs=2e-4)


@pytest.mark.parametrize("loss", LOSSES)
def test_contaminated_distances_hardly_move_the_estimate(loss: Loss) -> None:
    worst: dict[str, list[float]] = {"squares": [], "robust": []}
    for share in (0.0, 0.05, 0.15):
        identified = problem(noisy(3, share)).solve()
        found = robust_fit(identified, loss).identified
        for name, one in (("squares", identified), ("robust", found)):
            error = one.parameters[:40] - TRUTH.table_vector()
            worst[name].append(float(np.sqrt(np.mean(error[2:] ** 2))) / MDEG)
    assert worst["robust"][0] < 1.1 * worst["squares"][0]
    assert worst["squares"][1] > 4.0 * worst["squares"][0]
    assert worst["robust"][1] < 1.5 * worst["robust"][0]
    assert worst["robust"][2] < 0.25 * worst["squares"][2]


@pytest.mark.parametrize("loss", LOSSES)
def test_sandwich_covariance_agrees_with_repeated_draws(loss: Loss) -> None:
    errors = []
    for seed in range(15):
        found = robust_fit(problem(noisy(100 + seed, 0.05)).solve(), loss).identified
        u = found.standard_uncertainty[:40]
        errors.append((found.parameters[:40] - TRUTH.table_vector()) / u)
    assert float(np.std(errors)) == pytest.approx(1.0, abs=0.12)


def test_scale_of_clean_normal_errors_is_their_standard_deviation() -> None:
    fits = [robust_fit(problem(noisy(seed, 0.0)).solve(), "huber").identified.fit for seed in range(8)]
    # The scale of one draw of 1056 has a relative standard deviation of 0.037.
    assert float(np.mean([fit.sigma0_um for fit in fits])) == pytest.approx(10.0, rel=0.04)
    assert fits[0].chi2_reduced is None


def test_what_counts_little_is_reported_but_not_rejected() -> None:
    found = robust_fit(problem(noisy(9, 0.05)).solve(), "huber").identified
    loss = found.fit.robust
    assert found.rejected == []
    assert loss is not None
    far = np.abs(found.residuals_mm) > 2.0 * TUNING["huber"] * 1e-3 * loss.sigma_um
    assert loss.counted_little == int(far.sum()) > 0
    assert loss.half == pytest.approx(2.69)


def stated() -> Budget:
    return Budget(
        (
            Contributor("readings", "length", 0.01),
            Contributor("J1", "radial", 0.005, "axis-angle", "j1", orders=1),
            Contributor("poses", "position", 0.004, "pose"),
        )
    )


@pytest.mark.parametrize("loss", LOSSES)
def test_contributions_add_up_to_the_covariance(loss: Loss) -> None:
    points = replace(noisy(5, 0.05, 2.0), sigma_mm=None)
    found = robust_fit(replace(problem(points), budget=stated()).solve(), loss)
    parts = found.contributions
    assert parts.names == ("scatter of the distances", "J1", "poses")
    assert parts.covariance == pytest.approx(found.identified.covariance, rel=1e-12, abs=1e-24)


def test_a_systematic_part_matches_the_robust_fits_shift() -> None:
    points = replace(noisy(5, 0.1, 0.2), sigma_mm=None)
    first = replace(problem(points), budget=stated()).solve()
    asked = replace(problem(points), budget=first.budget)
    parts = robust_fit(first, "soft-l1").contributions
    square = np.zeros(parts.variances.shape[1])
    for effect in parts.errors.shared[0].effects_mm.T:
        one, other = (
            robust_fit(
                replace(
                    asked, points=replace(points, displacement_mm=points.displacement_mm + sign * effect)
                ).solve(),
                "soft-l1",
            ).identified.parameters
            for sign in (0.1, -0.1)
        )
        square += ((one - other) / 0.2) ** 2
    # The scale of the scatter follows the shift too, which the sandwich leaves out: some hundredths of the whole u.
    whole = np.sqrt(parts.variances.sum(axis=0)[:40])
    assert np.abs((np.sqrt(parts.variances[1][:40]) - np.sqrt(square[:40])) / whole).max() < 0.03


def test_noise_free_distances_stay_exact() -> None:
    found = robust_fit(problem(clean()).solve(), "soft-l1").identified
    assert found.parameters[:40] == pytest.approx(TRUTH.table_vector(), abs=1e-9)
