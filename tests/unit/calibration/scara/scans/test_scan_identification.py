"""A scan gives the same arm as the solver that holds everything in memory, and refuses what cannot be determined."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.errors import (
    CalibrationError,
    InsufficientPointsError,
    UnidentifiableError,
)
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.errors import MapRangeError
from catseye.calibration.scara.extension import Term, crosstalk, j4_map, thermal_drift
from catseye.calibration.scara.identification import identify
from catseye.calibration.scara.layout import ModelName
from catseye.calibration.scara.points import Points, rows_of_long_segments
from catseye.calibration.scara.radial import RadialBudget
from catseye.calibration.scara.scans.scan_identification import ScanIdentification, identify_scan
from catseye.calibration.scara.scans.source import SlicedPoints
from catseye.calibration.scara.scans.used_rows import used_rows
from tests.unit.calibration.scara.samples import radial_motions
from tests.unit.calibration.scara.scans.scan import (
    NOMINAL_REFLECTORS,
    Arm,
    arm,
    scan,
    to_and_fro,
    true_lengths,
)

TRUTH = arm(1, 10.0)
ROWS = 12_000
REACH_MM = 550.0
SIGMA_MM = np.random.default_rng(3).uniform(0.005, 0.02, ROWS)
POINTS = scan(TRUTH, ROWS, noise_mm=SIGMA_MM, sigma_mm=SIGMA_MM)
LATE = POINTS.rows(
    np.flatnonzero((POINTS.commands.theta2_rad < np.deg2rad(130.0)) | (np.arange(ROWS) > 5000))
)
FLAT = replace(
    TRUTH,
    table1_rad=0.0 * TRUTH.table1_rad,
    table2_rad=np.full_like(TRUTH.table2_rad, -1e-4),
)


def solved(
    points: Points,
    model: ModelName = "error-map",
    budget: Budget | None = None,
    terms: tuple[Term, ...] = (),
    rows: int = 1_700,
    truth: Arm = TRUTH,
) -> ScanIdentification:
    nodes = truth.nodes1_rad, truth.nodes2_rad
    source = SlicedPoints(points, rows)
    return identify_scan(source, model, *nodes, 325.0, 225.0, NOMINAL_REFLECTORS, budget, terms)


def require_same(
    points: Points,
    model: ModelName = "error-map",
    budget: Budget | None = None,
    terms: tuple[Term, ...] = (),
) -> ScanIdentification:
    """Compare with the solver in memory: estimates to 1e-9 mm (angles at full reach), and what is said of them."""
    found = solved(points, model, budget, terms)
    ours = found.identified
    nodes = TRUTH.nodes1_rad, TRUTH.nodes2_rad
    theirs = identify(points, model, *nodes, 325.0, 225.0, NOMINAL_REFLECTORS, budget, terms)
    assert ours.layout.names() == theirs.layout.names()
    unit = in_mm(ours.layout.map1, ours.layout.map2, ours.layout.size)
    # Each takes the weights of shared errors at parameters of its own, some micrometres from the estimate.
    near = 1e-9 if budget is None else 1e-7
    assert np.abs((ours.parameters - theirs.parameters) * unit).max() < near
    assert np.abs((ours.standard_uncertainty - theirs.standard_uncertainty) * unit).max() < 1e-9
    scale = np.outer(theirs.standard_uncertainty, theirs.standard_uncertainty)
    assert np.abs((ours.covariance - theirs.covariance) / scale).max() < 1e-7
    for name in ("n_points", "n_parameters", "dof"):
        assert getattr(ours.fit, name) == getattr(theirs.fit, name)
    for name in ("rms_um", "sigma0_um", "chi2_reduced", "chi2_probability"):
        expected = getattr(theirs.fit, name)
        assert getattr(ours.fit, name) == (
            expected if expected is None else pytest.approx(expected, rel=1e-7)
        )
    assert ours.rejected == theirs.rejected
    return found


def in_mm(map1: slice, map2: slice, size: int) -> Floats:
    unit = np.ones(size)
    unit[map1] = unit[map2] = REACH_MM
    return unit


def test_error_map_of_several_segments_and_a_sigma_per_row() -> None:
    found = require_same(POINTS)
    error = found.identified.parameters[: TRUTH.parameters().size] - TRUTH.parameters()
    normalised = error / found.identified.standard_uncertainty[: error.size]
    assert float(np.sqrt(np.mean(normalised**2))) < 1.3


def test_conventional_model() -> None:
    require_same(scan(FLAT, ROWS, noise_mm=0.01, sigma_mm=0.01), "conventional")


def test_without_stated_sigma_the_scatter_gives_the_uncertainty() -> None:
    found = require_same(scan(TRUTH, ROWS, noise_mm=0.02))
    assert found.identified.fit.sigma0_um == pytest.approx(20.0, rel=0.03)


def test_starting_values_from_few_rows_need_two_iterations() -> None:
    # Half of so many rows give the starting values, see catseye.calibration.scara.scans.used_rows.
    points = scan(TRUTH, 41_000, noise_mm=0.01, sigma_mm=0.01)
    assert require_same(points).identified.fit.iterations == 2


def test_radial_error_motions_widen_the_uncertainties() -> None:
    require_same(POINTS, budget=radial_motions(RadialBudget(0.005, 0.005, 0.010)))


def test_white_contributors_give_the_weights_where_the_points_state_none() -> None:
    budget = Budget(
        (
            Contributor("noise", "length", 0.01),
            Contributor("arm", "angle", 2e-5, axis="j2"),
            Contributor("wavelength", "scale", 1e-6, "common"),
        )
    )
    require_same(scan(TRUTH, ROWS, noise_mm=0.012), budget=budget)


def test_further_terms_by_command_beam_and_time() -> None:
    require_same(POINTS, terms=crosstalk((2,)) + j4_map((3,)) + thermal_drift())


def test_a_stated_share_of_the_measurement_counts() -> None:
    elapsed = np.sort(np.random.default_rng(5).uniform(-0.5, 0.5, ROWS))
    require_same(replace(POINTS, elapsed=elapsed), terms=thermal_drift())


def test_short_segments_are_dropped_with_their_reflector() -> None:
    paths = (*POINTS.dead_paths, ("P3", 7), ("P4", 0))
    dead_path = POINTS.dead_path.copy()
    dead_path[-5:-3], dead_path[-3:-1] = 6, 7
    reflector = np.where(dead_path == 7, 3, POINTS.reflector)
    points = replace(
        POINTS,
        dead_path=dead_path,
        dead_paths=paths,
        reflector=reflector,
        reflector_names=(*POINTS.reflector_names, "P4"),
    )
    nodes, places = (TRUTH.nodes1_rad, TRUTH.nodes2_rad), np.vstack([NOMINAL_REFLECTORS, [[500.0, 500.0]]])
    ours = identify_scan(SlicedPoints(points, 1000), "error-map", *nodes, 325.0, 225.0, places).identified
    theirs = identify(points, "error-map", *nodes, 325.0, 225.0, places)
    assert ours.rejected == theirs.rejected
    assert len(ours.rejected) == 2
    assert ours.layout.names() == theirs.layout.names()
    assert ours.parameters == pytest.approx(theirs.parameters, abs=1e-9)


def test_rows_left_out_are_no_time_on_either_way() -> None:
    dead_path, paths = POINTS.dead_path.copy(), (*POINTS.dead_paths, ("P1", 8), ("P3", 9))
    # Two rows of a segment of their own before all others, and two behind them.
    dead_path[:2], dead_path[-2:] = len(paths) - 2, len(paths) - 1
    points = replace(
        POINTS,
        dead_path=dead_path,
        dead_paths=paths,
        reflector=np.where(
            dead_path == len(paths) - 1, 2, np.where(dead_path == len(paths) - 2, 0, POINTS.reflector)
        ),
    )
    passed = np.concatenate(
        [one.elapsed_share for one in used_rows(SlicedPoints(points, 1000), ignore).blocks()]
    )
    assert passed == pytest.approx(points.rows(rows_of_long_segments(points)).elapsed_share, abs=1e-15)
    assert passed == pytest.approx(np.arange(ROWS - 4) / (ROWS - 5) - 0.5, abs=1e-15)
    require_same(points, terms=thermal_drift())


def ignore(_block: Points, _first: int) -> None:
    """Find nothing wrong with a block."""


def test_size_of_the_blocks_does_not_matter() -> None:
    one, many = solved(POINTS, rows=ROWS), solved(POINTS, rows=137)
    assert many.identified.parameters == pytest.approx(one.identified.parameters, abs=1e-12)
    assert many.residuals.histogram.sum() == one.residuals.histogram.sum() == ROWS


def test_residuals_by_segment_and_their_sample() -> None:
    found = solved(POINTS)
    nodes = TRUTH.nodes1_rad, TRUTH.nodes2_rad
    residuals = identify(POINTS, "error-map", *nodes, 325.0, 225.0, NOMINAL_REFLECTORS).residuals_mm
    for i in range(6):
        own = residuals[POINTS.dead_path == i]
        assert found.residuals.count[i] == own.size
        assert found.residuals.square_mm2[i] == pytest.approx(float(np.sum(own**2)), rel=1e-9)
        assert found.residuals.largest_mm[i] == pytest.approx(float(np.abs(own).max()), abs=1e-9)
    edges = np.linspace(-found.residuals.half_width_mm, found.residuals.half_width_mm, 42)
    expected = np.histogram(np.clip(residuals, edges[0], edges[-1]), edges)[0]
    assert np.abs(found.residuals.histogram - expected).sum() <= 2
    assert 2000 < len(found.identified.points) <= 4000
    assert found.identified.residuals_mm.size == len(found.identified.points)


def test_exact_distances_give_the_arm_back() -> None:
    found = solved(scan(TRUTH, ROWS)).identified
    error = np.abs(found.parameters[: TRUTH.parameters().size] - TRUTH.parameters())
    assert error[:2].max() < 1e-9
    assert error[2:].max() * REACH_MM < 1e-9


def test_an_untouched_node_is_named_and_nothing_else() -> None:
    near = np.abs(POINTS.commands.theta1_rad - TRUTH.nodes1_rad[4]) < np.deg2rad(10.5)
    with pytest.raises(UnidentifiableError) as caught:
        solved(POINTS.select(~near))
    assert caught.value.null_directions == [["Δθ1(-100°, +)"], ["Δθ1(-100°, −)"]]


def test_links_that_cannot_be_separated_are_named() -> None:
    commands = POINTS.commands
    still = replace(commands, theta2_rad=np.full(ROWS, np.deg2rad(70.0)))
    lengths = true_lengths(TRUTH, still, POINTS.reflector)
    points = replace(POINTS, commands=still, displacement_mm=lengths, sigma_mm=None)
    with pytest.raises(UnidentifiableError) as caught:
        identify_scan(
            SlicedPoints(points, 5000),
            "error-map",
            TRUTH.nodes1_rad,
            np.deg2rad([70.0]),
            325.0,
            225.0,
            NOMINAL_REFLECTORS,
        )
    assert any({"L1", "L2"} <= set(names) for names in caught.value.null_directions)


def test_a_direction_only_qr_resolves_is_refused() -> None:
    # θ2 moves by a thousandth of a degree: the singular values lie at 2e-6 and 9e-7 of the largest.
    theta2, direction2 = to_and_fro(np.arange(ROWS) / 40.0, 70.0, 70.001)
    commands = replace(POINTS.commands, theta2_rad=theta2, direction2=direction2)
    exact = true_lengths(FLAT, commands, POINTS.reflector)
    points = replace(POINTS, commands=commands, displacement_mm=exact, sigma_mm=None)
    nodes = TRUTH.nodes1_rad, TRUTH.nodes2_rad
    theirs = identify(points, "conventional", *nodes, 325.0, 225.0, NOMINAL_REFLECTORS)
    assert theirs.parameters[0] == pytest.approx(FLAT.link1_mm, abs=1e-3)
    with pytest.raises(UnidentifiableError) as caught:
        solved(points, "conventional")
    assert {"L1", "L2", "θ20"} <= set(caught.value.null_directions[0])


def test_numbers_of_rows_instead_of_segments_are_refused() -> None:
    rows = np.arange(len(POINTS)) // 3
    paths = tuple((POINTS.reflector_names[POINTS.reflector[3 * k]], k) for k in range(int(rows[-1]) + 1))
    many = replace(POINTS, dead_path=rows, dead_paths=paths)
    assert len(paths) == ROWS // 3
    with pytest.raises(
        CalibrationError, match=rf"{len(paths)} of them dead paths.*as long as the beam is unbroken"
    ):
        solved(many)


def test_too_few_rows() -> None:
    with pytest.raises(InsufficientPointsError, match="cannot determine"):
        solved(POINTS.rows(np.arange(60)))


def test_the_first_row_outside_the_nodes_is_reported() -> None:
    short = replace(TRUTH, nodes2_rad=TRUTH.nodes2_rad[:-1])
    angle = np.rad2deg(LATE.commands.theta2_rad)
    row = 1 + int(np.flatnonzero(angle > 130.0)[0])
    worst = angle[row - 1]
    with pytest.raises(
        MapRangeError, match=rf"θ2 {worst:.4f}° of distance {row} is outside the nodes 0°…130°"
    ):
        solved(LATE, truth=short)


def test_an_error_common_to_a_pose_is_refused() -> None:
    budget = Budget((Contributor("grease", "position", 0.01, "pose"),))
    with pytest.raises(CalibrationError, match="grease"):
        solved(POINTS, budget=budget)


def test_progress_counts_the_rows_of_all_passes() -> None:
    seen: list[tuple[int, int]] = []
    nodes = TRUTH.nodes1_rad, TRUTH.nodes2_rad
    identify_scan(
        SlicedPoints(POINTS, 5000),
        "error-map",
        *nodes,
        325.0,
        225.0,
        NOMINAL_REFLECTORS,
        progress=lambda done, expected: seen.append((done, expected)),
    )
    # So few rows stand for all from the start: the first pass confirms, and the work ends at 100 %.
    assert seen == [(5000, 24_000), (10_000, 24_000), (12_000, 24_000), (12_000, 12_000)]
