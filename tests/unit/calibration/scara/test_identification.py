"""The solver on the paper's layout: exact recovery, honest uncertainties, null directions by name."""

import numpy as np
import pytest

from catseye.calibration.core.errors import InsufficientPointsError, UnidentifiableError
from catseye.calibration.scara.errors import MapRangeError
from catseye.calibration.scara.identification import identify
from catseye.calibration.scara.points import Points
from tests.unit.calibration.scara.paper import (
    MDEG,
    NODES1_DEG,
    NODES2_DEG,
    NOMINAL_REFLECTORS,
    Truth,
    paper_points,
    random_truth,
    sequence,
)
from tests.unit.calibration.scara.samples import identified

NODES1, NODES2 = np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)


@pytest.mark.parametrize("seed", range(5))
def test_noise_free_points_give_the_arm_back(seed: int) -> None:
    truth = random_truth(seed)
    result = identified(paper_points(truth))
    error = result.parameters[:40] - truth.table_vector()
    assert np.abs(error[:2]).max() < 1e-8
    assert np.abs(error[2:]).max() / MDEG < 1e-8
    assert result.parameters[result.layout.reflectors] == pytest.approx(truth.reflectors.ravel(), abs=1e-9)
    assert result.fit.iterations <= 6


@pytest.mark.parametrize(
    ("chosen", "largest1_mdeg", "largest2_mdeg"),
    [([0, 1, 2], 0.90, 1.5), ([0, 2], 1.0, 1.8), ([1], 2.7, 2.8)],
)
def test_largest_standard_deviations_of_the_paper_layout(
    chosen: list[int], largest1_mdeg: float, largest2_mdeg: float
) -> None:
    points = paper_points(random_truth(0), sigma_mm=0.0156)
    points = points.select(np.isin(points.reflector, chosen))
    result = identify(points, "error-map", NODES1, NODES2, 325.0, 225.0, NOMINAL_REFLECTORS[chosen])
    u = result.standard_uncertainty
    assert u[result.layout.map1].max() / MDEG == pytest.approx(largest1_mdeg, rel=0.02)
    assert u[result.layout.map2].max() / MDEG == pytest.approx(largest2_mdeg, rel=0.02)
    if len(chosen) == 3:
        assert 2.2 < 1e3 * u[0] < 2.7
        assert 2.1 < 1e3 * u[1] < 2.35


def test_without_stated_sigma_the_fit_scatter_gives_the_uncertainty() -> None:
    truth = random_truth(4)
    noise = np.random.default_rng(5).normal(0.0, 0.02, 1056)
    free = identified(paper_points(truth, noise_mm=noise))
    stated = identified(paper_points(truth, noise_mm=noise, sigma_mm=0.02))
    assert free.fit.sigma0_um == pytest.approx(20.0, rel=0.07)
    ratio = free.standard_uncertainty / stated.standard_uncertainty
    assert ratio == pytest.approx(np.full(ratio.size, free.fit.sigma0_um / 20.0), rel=1e-3)


def test_systematic_errors_cause_lack_of_fit_and_widen_uncertainty() -> None:
    truth = random_truth(7)
    noise = np.random.default_rng(8).normal(0.0, 0.010, 1056)
    # An error of 12 µm that depends on the pose and the reflector only: repeats do not average it out.
    rows = sequence()
    place = {key: i for i, key in enumerate(sorted({(a, b) for a, b, _, _ in rows}))}
    common = np.random.default_rng(9).normal(0.0, 0.012, (3, len(place)))
    systematic = np.array([common[j, place[(a, b)]] for j in range(3) for a, b, _, _ in rows])
    white = identified(paper_points(truth, noise_mm=noise, sigma_mm=0.0156))
    both = identified(paper_points(truth, noise_mm=noise + systematic, sigma_mm=0.0156))
    assert white.fit.lack_of_fit is not None
    assert both.fit.lack_of_fit is not None
    assert not white.fit.lack_of_fit.significant
    assert both.fit.lack_of_fit.significant
    assert both.fit.lack_of_fit.systematic_um == pytest.approx(12.0, rel=0.15)
    assert both.fit.lack_of_fit.pure_um == pytest.approx(10.0, rel=0.1)
    error = (both.parameters[:40] - truth.table_vector()) / both.standard_uncertainty[:40]
    assert float(np.sqrt(np.mean(error**2))) < 1.25


def test_conventional_model_finds_links_and_offset() -> None:
    truth = random_truth(10)
    flat = Truth(
        truth.link1_mm,
        truth.link2_mm,
        {1: [0.0] * 11, -1: [0.0] * 11},
        {1: [-5.55 * MDEG] * 8, -1: [-5.55 * MDEG] * 8},
        truth.reflectors,
    )
    result = identified(paper_points(flat), "conventional")
    assert result.parameters[:3] == pytest.approx([flat.link1_mm, flat.link2_mm, -5.55 * MDEG], abs=1e-10)


def test_dead_path_of_each_segment() -> None:
    truth = random_truth(11)
    points = paper_points(truth)
    second = np.arange(352) >= 100
    dead_path = np.where(np.tile(second, 3) & (points.reflector == 1), 3, points.dead_path)
    displacement = points.displacement_mm - np.where(dead_path == 3, 77.5, 0.0)
    split = Points(
        points.commands, points.reflector, dead_path, displacement, None, points.reflector_names,
        (*points.dead_paths, ("P2", 1)),
    )  # fmt: skip
    result = identified(split)
    assert result.parameters[:40] == pytest.approx(truth.table_vector(), abs=1e-10)
    zero = result.parameters[result.layout.dead_path]
    assert zero[3] - zero[1] == pytest.approx(77.5, abs=1e-9)


def test_short_segment_is_dropped_with_a_sentence() -> None:
    points = paper_points(random_truth(12))
    dead_path = points.dead_path.copy()
    dead_path[-2:] = 3
    split = Points(
        points.commands, points.reflector, dead_path, points.displacement_mm, None, points.reflector_names,
        (*points.dead_paths, ("P3", 1)),
    )  # fmt: skip
    result = identified(split)
    assert result.rejected == ["segment 1 of reflector P3 dropped: 2 distance(s), fewer than 3"]
    assert result.fit.n_points == 1054


def test_one_direction_never_used_names_its_table() -> None:
    points = paper_points(random_truth(0))
    with pytest.raises(UnidentifiableError, match="no point touches") as caught:
        identified(points.select(points.commands.direction2 > 0))
    assert sorted(caught.value.null_directions) == sorted([[f"Δθ2({a:g}°, −)"] for a in NODES2_DEG])


def test_untouched_node_is_named_and_nothing_else() -> None:
    points = paper_points(random_truth(0))
    kept = points.select(np.abs(points.commands.theta1_rad - NODES1[4]) > 0.01)
    with pytest.raises(UnidentifiableError) as caught:
        identified(kept)
    assert caught.value.null_directions == [["Δθ1(-60°, +)"], ["Δθ1(-60°, −)"]]


def test_single_theta2_cannot_separate_the_links() -> None:
    points = paper_points(random_truth(0))
    chosen = points.select(np.abs(points.commands.theta2_rad - NODES2[3]) < 0.01)
    with pytest.raises(UnidentifiableError) as caught:
        identify(chosen, "error-map", NODES1, NODES2[3:4], 325.0, 225.0, NOMINAL_REFLECTORS)
    assert any({"L1", "L2"} <= set(names) for names in caught.value.null_directions)


def test_one_reflector_identifies_the_paper_layout() -> None:
    assert identified(paper_points(random_truth(1), reflectors=1)).fit.n_parameters == 42


def test_gauge_holds_and_a_turn_of_everything_changes_no_distance() -> None:
    truth = random_truth(2)
    turn = 20.0 * MDEG
    turned = Truth(
        truth.link1_mm,
        truth.link2_mm,
        {s: [value + turn for value in truth.map1[s]] for s in (1, -1)},
        truth.map2,
        truth.reflectors @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]),
    )
    result = identified(paper_points(turned))
    assert float(np.mean(result.parameters[result.layout.map1])) == pytest.approx(0.0, abs=1e-15)
    assert result.parameters[:40] == pytest.approx(truth.table_vector(), abs=1e-12)


def test_points_outside_the_nodes_are_refused() -> None:
    points = paper_points(random_truth(0))
    with pytest.raises(MapRangeError, match="θ2 140"):
        identify(points, "error-map", NODES1, NODES2[:-1], 325.0, 225.0, NOMINAL_REFLECTORS)


def test_too_few_points() -> None:
    points = paper_points(random_truth(0))
    with pytest.raises(InsufficientPointsError, match="cannot determine"):
        identified(points.select(np.arange(len(points)) < 30))
