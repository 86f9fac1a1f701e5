"""Nested models and grids of nodes on arms whose truth is known."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from catseye.calibration.core.significance import aicc, bic
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.diagnostics.nested_models import ComparedModel, Extension, compare_models
from catseye.calibration.scara.diagnostics.node_spacing import node_spacing
from catseye.calibration.scara.extension import crosstalk, j4_map, periodic, thermal_drift
from catseye.calibration.scara.points import Points
from catseye.calibration.scara.radial import RadialBudget
from tests.unit.calibration.scara.diagnostics.bench import (
    Extra,
    commands_between,
    commands_on_nodes,
    measured,
    problem,
)
from tests.unit.calibration.scara.paper import MDEG, NODES1_DEG, NODES2_DEG, Truth, random_truth
from tests.unit.calibration.scara.samples import radial_motions
from tests.unit.calibration.scara.test_radial_budget import radial_errors

TRUTH = random_truth(10)
EXTENSIONS = [
    Extension("crosstalk", crosstalk()),
    Extension("J4 map", j4_map()),
    Extension("thermal drift", thermal_drift()),
]


def on_nodes(extra: Extra | None = None, seed: int = 1) -> Points:
    return measured(TRUTH, commands_on_nodes(), extra, noise_mm=0.008, sigma_mm=0.008, seed=seed)


def models(points: Points, budget: Budget | None = None) -> dict[str, ComparedModel]:
    posed = replace(problem(points), budget=budget)
    return {one.name: one for one in compare_models(posed, EXTENSIONS)}


def test_only_what_acts_is_significant_and_its_coefficients_are_right() -> None:
    extra = Extra(theta2=lambda p: 3.0 * MDEG * math.sin(p.theta1))
    found = models(on_nodes(extra))
    assert found["error map"].significant
    assert found["error map"].base == "conventional"
    assert [name for name in ("crosstalk", "J4 map", "thermal drift") if found[name].significant] == [
        "crosstalk"
    ]
    values = dict(
        zip([term.name for term in found["crosstalk"].terms], found["crosstalk"].coefficients, strict=True)
    )
    u = dict(zip([term.name for term in found["crosstalk"].terms], found["crosstalk"].u, strict=True))
    assert values["Δθ2 sin θ1"] == pytest.approx(3.0 * MDEG, abs=3.0 * u["Δθ2 sin θ1"])
    assert found["crosstalk"].aicc < found["error map"].aicc
    assert found["all together"].n_parameters == found["error map"].n_parameters + 8 + 10 + 2


def test_f_is_the_textbook_ratio_of_both_fits() -> None:
    points = on_nodes()
    small, large = problem(points).solve(), problem(points, terms=crosstalk()).solve()
    assert small.fit.chi2_reduced is not None
    assert large.fit.chi2_reduced is not None
    gain = small.fit.chi2_reduced * small.fit.dof - large.fit.chi2_reduced * large.fit.dof
    ratio = gain / 8 / large.fit.chi2_reduced
    found = models(points)["crosstalk"]
    assert found.ratio == pytest.approx(ratio, rel=1e-6)
    alone = float(stats.f.sf(ratio, 8, large.fit.dof))
    assert found.probability == pytest.approx(1.0 - (1.0 - alone) ** 3, rel=1e-6)


def test_what_the_budget_states_is_not_significant() -> None:
    extra = Extra(length=lambda p: 0.012 * math.cos(3 * p.beam))
    budget = Budget((Contributor("J4", "radial", 0.010, "axis-angle", "j4"),))
    plain, stated = models(on_nodes(extra))["J4 map"], models(on_nodes(extra), budget)["J4 map"]
    assert plain.significant
    assert not stated.significant
    assert plain.explained_um == pytest.approx(12.0 / math.sqrt(2.0), rel=0.2)


def test_what_is_tested_leaves_its_covariance_alone() -> None:
    """A map of 12 µm beside a stated 1 µm: amplitudes learnt without the map would take it for J4's motion."""
    extra = Extra(length=lambda p: 0.012 * math.cos(3 * p.beam))
    budget = Budget((Contributor("J4", "radial", 0.001, "axis-angle", "j4"),))
    found = models(on_nodes(extra), budget)["J4 map"]
    assert found.significant
    assert not found.as_stated
    at = [term.name for term in found.terms].index("Δd cos 3θ4")
    assert found.coefficients[at] == pytest.approx(0.012, abs=4.0 * found.u[at])


def test_a_map_that_the_budget_explains_is_there_as_stated() -> None:
    extra = Extra(length=lambda p: 0.012 * math.cos(3 * p.beam))
    budget = Budget((Contributor("J4", "radial", 0.010, "axis-angle", "j4"),))
    found = models(on_nodes(extra), budget)["J4 map"]
    assert found.as_stated


def test_all_models_have_one_covariance() -> None:
    """Then nothing that a larger model contains can fit worse, and F follows from both sums of squares."""
    budget = radial_motions(RadialBudget(0.005, 0.005, 0.010))
    for seed in range(3):
        errors = radial_errors(np.random.default_rng(seed), TRUTH, RadialBudget(0.005, 0.005, 0.010), 3)
        points = on_nodes(seed=seed)
        found = models(replace(points, displacement_mm=points.displacement_mm + errors), budget)
        base, rows = found["error map"], len(points)
        for name in ("crosstalk", "thermal drift", "J4 map", "all together"):
            larger, k = found[name], base.n_parameters + 1
            extra = larger.n_parameters - base.n_parameters
            # BIC is n log(S / n) + K log n: both sums of squares are in it.
            gone = math.exp((larger.bic - base.bic - extra * math.log(rows)) / rows)
            assert 0.9 < gone < 1.0
            ratio = (1.0 / gone - 1.0) / extra * (rows - k + 1 - extra)
            assert larger.ratio == pytest.approx(ratio, rel=1e-9)


def test_probabilities_beside_learnt_amplitudes_are_spread() -> None:
    """Sixteen draws: the campaign has two hundred."""
    stated, values = RadialBudget(0.005, 0.005, 0.010), []
    for seed in range(16):
        errors = radial_errors(np.random.default_rng(40 + seed), TRUTH, stated, 3)
        points = on_nodes(seed=40 + seed)
        moved = replace(points, displacement_mm=points.displacement_mm + errors)
        found = compare_models(
            replace(problem(moved), budget=radial_motions(stated)), [Extension("J4 map", j4_map())]
        )
        values.append(found[2].probability)
    assert stats.kstest(values, "uniform").pvalue > 0.01


def test_nothing_is_significant_on_white_noise() -> None:
    for seed in range(4):
        found = models(on_nodes(seed=seed))
        assert not any(one.significant for one in found.values() if one.terms)


def test_what_the_commands_cannot_determine_is_refused_with_reason() -> None:
    found = compare_models(problem(on_nodes()), [*EXTENSIONS, Extension("periodic", periodic(1, (36,)))])
    refused = next(one for one in found if one.name == "periodic")
    assert refused.refused is not None
    assert "measure between the nodes" in refused.refused
    together = next(one for one in found if one.name == "all together")
    assert not together.refused
    assert not together.significant


def test_information_criteria_against_their_definitions() -> None:
    # Burnham and Anderson: n log(RSS/n) + 2K + 2K(K+1)/(n−K−1), K counts the variance.
    assert aicc(50.0, 20, 3) == pytest.approx(20 * math.log(2.5) + 8 + 40 / 15)
    assert bic(50.0, 20, 3) == pytest.approx(20 * math.log(2.5) + 4 * math.log(20))
    assert aicc(1.0, 5, 3) == math.inf


def straight_truth() -> Truth:
    one, two = [0.1 * MDEG * node for node in NODES1_DEG], [0.2 * MDEG * node for node in NODES2_DEG]
    return replace(TRUTH, map1={1: one, -1: one}, map2={1: two, -1: two})


def test_coarse_nodes_are_recommended_where_the_maps_are_straight() -> None:
    points = measured(straight_truth(), commands_on_nodes(), noise_mm=0.01, sigma_mm=0.01)
    found = node_spacing(problem(points))
    assert found.by_aicc.nodes1_rad.size == 5
    assert found.by_bic.nodes2_rad.size == 4
    assert not found.between1
    assert found.grids[0].name == "J1 every node (11), J2 every node (8)"
    assert found.by_aicc.nodes1_rad[-1] == pytest.approx(np.deg2rad(60.0))


def test_all_nodes_are_needed_for_a_jagged_map() -> None:
    points = measured(TRUTH, commands_on_nodes(), noise_mm=0.01, sigma_mm=0.01)
    found = node_spacing(problem(points))
    for best in (found.by_aicc, found.by_bic, found.by_prediction):
        assert best is found.grids[0]


def test_finer_nodes_are_judged_where_commands_stand_between_them() -> None:
    extra = Extra(theta1=lambda p: 6.0 * MDEG * math.cos(18.0 * p.theta1))
    points = measured(TRUTH, commands_between(7.3, 17.1), extra, noise_mm=0.004, sigma_mm=0.004)
    found = node_spacing(problem(points))
    assert found.between1
    assert found.by_aicc.nodes1_rad.size == 21
    assert found.by_aicc.nodes2_rad.size == 8


def test_a_finest_grid_that_nothing_determines_is_refused_alone() -> None:
    """Commands of J2 every 17.1° leave some of its nodes every 10° untouched."""
    points = measured(TRUTH, commands_between(13.3, 17.1), noise_mm=0.008, sigma_mm=0.008)
    found = node_spacing(replace(problem(points), budget=radial_motions(RadialBudget(0.005, 0.005, 0.010))))
    assert found.between2
    assert "no point touches" in str(found.grids[-1].refused)
    assert np.isfinite(found.grids[0].aicc)
