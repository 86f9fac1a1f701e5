"""Shared errors in scans: against dense matrices of derivatives taken numerically, and the solver in memory."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core import amplitudes
from catseye.calibration.core.errors import BudgetError, UnidentifiableError
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.budget import Budget, Contributor, Kind
from catseye.calibration.scara.identification import Identification, identify
from catseye.calibration.scara.points import Commands, Points
from catseye.calibration.scara.prediction import predict
from catseye.calibration.scara.radial import RadialBudget
from catseye.calibration.scara.scans.scan_identification import identify_scan
from catseye.calibration.scara.scans.source import SlicedPoints
from tests.unit.calibration.scara.samples import radial_motions
from tests.unit.calibration.scara.scans.scan import (
    NAMES,
    NOMINAL_REFLECTORS,
    Arm,
    arm,
    scan,
    true_lengths,
)

TRUTH = arm(4, 20.0)
MOVING = scan(TRUTH, 12_000, noise_mm=0.01, sigma_mm=0.01)
WHITE = Contributor("noise", "length", 0.010)
RIPPLES = (
    Contributor("ripple of J1", "between-nodes", 6e-5, "axis-angle", "j1"),
    Contributor("ripple of J2", "between-nodes", 9e-5, "axis-angle", "j2"),
)
MOTIONS = radial_motions(RadialBudget(0.005, 0.005, 0.010)).contributors
EQUAL = 1e-6
"""The figure of the issue for u on every route, relatively."""


def table(off_nodes: int, seed: int = 1) -> Points:
    """Return a table of commands at nodes, with some between them for each reflector."""
    rng = np.random.default_rng(seed)
    one, two = (
        np.tile(part.ravel(), 3) for part in np.meshgrid(TRUTH.nodes1_rad, TRUTH.nodes2_rad, indexing="ij")
    )
    extra1 = rng.uniform(TRUTH.nodes1_rad[0], TRUTH.nodes1_rad[-1], off_nodes)
    extra2 = rng.uniform(TRUTH.nodes2_rad[0], TRUTH.nodes2_rad[-1], off_nodes)
    one, two = np.tile(np.append(one, extra1), 3), np.tile(np.append(two, extra2), 3)
    series = one.size // 3
    directions = rng.choice([-1, 1], (2, one.size)).astype(np.int64)
    for column in directions:
        # Each command between the nodes is visited from one side by all reflectors.
        column.reshape(3, series)[:, series - off_nodes :] = column[series - off_nodes : series]
    commands = Commands(one, two, directions[0], directions[1])
    reflector = np.repeat(np.arange(3), series)
    lengths = true_lengths(TRUTH, commands, reflector) + rng.normal(0.0, 0.01, one.size)
    displacement = lengths - np.repeat(lengths[::series], series)
    paths = tuple((name, 0) for name in NAMES)
    return Points(commands, reflector, reflector, displacement, None, NAMES, paths)


def in_memory(points: Points, budget: Budget) -> Identification:
    nodes = TRUTH.nodes1_rad, TRUTH.nodes2_rad
    return identify(points, "error-map", *nodes, 325.0, 225.0, NOMINAL_REFLECTORS, budget)


def scanned(points: Points, budget: Budget, rows: int = 97) -> Identification:
    nodes = TRUTH.nodes1_rad, TRUTH.nodes2_rad
    source = SlicedPoints(points, rows)
    found = identify_scan(source, "error-map", *nodes, 325.0, 225.0, NOMINAL_REFLECTORS, budget)
    return found.identified


def require_same_uncertainties(points: Points, budget: Budget, rows: int = 97) -> None:
    ours, theirs = scanned(points, budget, rows), in_memory(points, budget)
    assert ours.standard_uncertainty == pytest.approx(theirs.standard_uncertainty, rel=EQUAL)
    off = np.abs(ours.parameters - theirs.parameters) / theirs.standard_uncertainty
    assert off.max() < 1e-4


def arm_of(values: Floats) -> Arm:
    one, two = TRUTH.nodes1_rad.size, TRUTH.nodes2_rad.size
    ends = np.cumsum([2, 2 * one, 2 * two, 6])
    links, first, second, places, _ = np.split(values, ends)
    return Arm(
        links[0],
        links[1],
        TRUTH.nodes1_rad,
        TRUTH.nodes2_rad,
        first.reshape(2, one),
        second.reshape(2, two),
        places.reshape(3, 2),
    )


def rows_of(points: Points, values: Floats) -> Floats:
    lengths = true_lengths(arm_of(values), points.commands, points.reflector)
    return np.asarray(lengths - values[-3:][points.dead_path])


def slopes(points: Points, values: Floats, ways: Floats) -> Floats:
    """Return numerical derivatives of the distances along ways in the space of the parameters, shape (n, ways)."""
    ends = [(rows_of(points, values + 1e-5 * way), rows_of(points, values - 1e-5 * way)) for way in ways]
    return np.column_stack([(ahead - behind) / 2e-5 for ahead, behind in ends])


def ripple(nodes: Floats, angle: Floats, direction: Ints) -> Floats:
    """Return the covariance of a ripple of rms 1 and unknown order, less its interpolation, shape (n, n)."""
    lower = np.clip(np.searchsorted(nodes, angle, side="right") - 1, 0, nodes.size - 2)
    share = (angle - nodes[lower]) / (nodes[lower + 1] - nodes[lower])
    covariance = np.zeros((angle.size, angle.size))
    for order in range(18, 145):
        wave = np.exp(1j * order * angle) - (1.0 - share) * np.exp(1j * order * nodes[lower])
        wave -= share * np.exp(1j * order * nodes[lower + 1])
        covariance += np.real(np.outer(wave, wave.conj())) / 127.0
    return np.asarray(covariance * (direction[:, None] == direction))


def dense(points: Points, found: Identification) -> tuple[Floats, Floats]:
    """Return standard uncertainties, and what a unit of a common scale moves the estimate by."""
    commands, layout = points.commands, found.layout
    jacobian = slopes(points, found.parameters, np.eye(found.parameters.size))
    # Where its whole map is lifted a joint turns, as a ripple turns it.
    joints = np.zeros((2, found.parameters.size))
    joints[0, layout.map1] = joints[1, layout.map2] = 1.0
    turned = slopes(points, found.parameters, joints)
    scale = points.displacement_mm * 1e-6
    covariance = 0.010**2 * np.eye(len(points)) + np.outer(scale, scale)
    one = ripple(TRUTH.nodes1_rad, commands.theta1_rad, commands.direction1)
    two = ripple(TRUTH.nodes2_rad, commands.theta2_rad, commands.direction2)
    for u, turn, correlated in zip((6e-5, 9e-5), turned.T, (one, two), strict=True):
        covariance += u**2 * np.outer(turn, turn) * correlated
    # The mean of the J1 map is zero.
    constraint = np.zeros((1, found.parameters.size))
    constraint[0, 2 : 2 + 2 * TRUTH.nodes1_rad.size] = 1.0
    free = np.linalg.svd(constraint)[2][1:].T
    weighted = np.linalg.solve(covariance, jacobian @ free)
    known = free @ np.linalg.inv((jacobian @ free).T @ weighted) @ free.T
    return np.sqrt(np.maximum(np.diag(known), 0.0)), known @ jacobian.T @ np.linalg.solve(covariance, scale)


def test_few_commands_between_nodes_count_in_a_scan_too() -> None:
    """Truth: dense covariances, 12 commands in blocks of 97 rows."""
    points = table(12)
    known = tuple(replace(one, spectrum=(1.0,)) for one in RIPPLES)
    budget = Budget((WHITE, Contributor("scale", "scale", 1e-6, "common"), *known))
    for found in (in_memory(points, budget), scanned(points, budget)):
        u, moved = dense(points, found)
        # Derivatives from differences of lengths of 1e3 mm, rounded to 1e-13 mm, over steps of 1e-5.
        assert found.fit.variance_ratio == 1.0
        assert found.standard_uncertainty == pytest.approx(u, rel=EQUAL)
        (taken,) = found.taken_up.values()
        assert taken[:, 0] / u == pytest.approx(moved / u, abs=EQUAL)


@pytest.mark.parametrize("off_nodes", [0, 12, 100, 101])
def test_table_and_scan_of_it_have_one_uncertainty(off_nodes: int) -> None:
    require_same_uncertainties(table(off_nodes), Budget((WHITE, *MOTIONS, *RIPPLES)))


def test_a_joint_that_moves_averages_over_what_is_between_nodes() -> None:
    require_same_uncertainties(MOVING, Budget((*MOTIONS, *RIPPLES)), rows=1_700)


def test_rows_beyond_the_sample_have_one_uncertainty_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(amplitudes, "_MOST_ROWS", 4_000)
    require_same_uncertainties(replace(MOVING, sigma_mm=None), Budget((WHITE, *MOTIONS)), rows=1_700)


def test_predictions_from_a_scan_are_those_from_all_rows() -> None:
    """Three of four rows are left out of the points that a scan keeps."""
    budget = Budget((*MOTIONS, Contributor("scale", "scale", 2e-6, "common")))
    ours, theirs = scanned(MOVING, budget, 1_700), in_memory(MOVING, budget)
    assert len(ours.points) < len(MOVING) / 2
    expected = {one.name: moved for one, moved in theirs.taken_up.items()}
    assert {one.name for one in ours.taken_up} == set(expected) == {"J1", "J2", "J4", "scale"}
    for one, moved in ours.taken_up.items():
        scale = np.abs(expected[one.name]).max()
        assert moved / scale == pytest.approx(expected[one.name] / scale, abs=EQUAL)
    commands = MOVING.commands.select(np.arange(0, 12_000, 1_111))
    predicted = [predict(found.arm, commands, 325.0, 225.0).u_mm for found in (ours, theirs)]
    assert predicted[0] == pytest.approx(predicted[1], rel=EQUAL)


@pytest.mark.parametrize("solve", [in_memory, scanned])
def test_shared_errors_alone_give_no_weights(solve: Callable[[Points, Budget], object]) -> None:
    points = replace(MOVING, sigma_mm=None)
    with pytest.raises(BudgetError, match="states J1, J2, J4, which several distances share, but nothing"):
        solve(points, Budget(MOTIONS))


@pytest.mark.parametrize("solve", [in_memory, scanned])
def test_rows_without_any_error_of_their_own_are_refused(solve: Callable[[Points, Budget], object]) -> None:
    """The first distance of a segment is zero, and so is an error that grows with it."""
    growing = Contributor("growing", "scale", 1e-5)
    with pytest.raises(BudgetError, match=r"growing: .* leaves some distances without an uncertainty"):
        solve(table(0), Budget((growing,)))


def test_a_stated_sigma_replaces_the_white_contributors() -> None:
    budget = Budget((WHITE, *MOTIONS))
    ours, theirs = scanned(MOVING, budget, 1_700), in_memory(MOVING, budget)
    assert ours.budget is not None
    assert theirs.budget is not None
    assert [one.name for one in ours.budget.contributors] == ["J1", "J2", "J4"]
    assert [one.name for one in theirs.budget.contributors] == ["J1", "J2", "J4"]
    names = [one.name for one in ours.model.white(ours.parameters)]
    assert names == ["sigma_mm of the points"]


@pytest.mark.parametrize("u_mm", [30.0, 1000.0])
def test_a_large_shared_error_leaves_nothing_undetermined(u_mm: float) -> None:
    """What all dead paths have in common is uncertain by it, and nothing else is."""
    budget = Budget((Contributor("offset", "length", u_mm, "common"),))
    ours, plain = scanned(MOVING, budget, 1_700), scanned(MOVING, Budget(()), 1_700)
    paths = ours.layout.dead_path
    expected = plain.covariance.copy()
    expected[paths, paths] += u_mm**2
    # Sums of 12 000 rows of 10 µm beside so large an error keep at least four digits.
    assert ours.standard_uncertainty == pytest.approx(np.sqrt(np.diag(expected)), rel=1e-4)


@pytest.mark.parametrize(("kind", "u"), [("length", 100.0), ("scale", 1.0), ("position", 10.0)])
def test_a_large_shared_error_hides_no_null_direction(kind: Kind, u: float) -> None:
    still = replace(MOVING.commands, theta2_rad=np.full(len(MOVING), np.deg2rad(60.0)))
    lengths = true_lengths(TRUTH, still, MOVING.reflector)
    points = replace(MOVING, commands=still, displacement_mm=lengths)
    budget = Budget((Contributor("large", kind, u, "common"),))
    nodes = TRUTH.nodes1_rad, np.deg2rad([60.0])
    with pytest.raises(UnidentifiableError) as caught:
        identify_scan(
            SlicedPoints(points, 5000),
            "error-map",
            *nodes,
            325.0,
            225.0,
            NOMINAL_REFLECTORS,
            budget,
        )
    assert any({"L1", "L2"} <= set(names) for names in caught.value.null_directions)


@pytest.mark.parametrize("u", [1e-3, 0.1])
def test_rounding_of_large_shared_errors_does_not_keep_it_going(u: float) -> None:
    """The sum of squares that is left is a difference: it has the rounding of the white one."""
    budget = Budget((Contributor("scale", "scale", u, "common"),))
    ours, theirs = scanned(MOVING, budget, 1_700), in_memory(MOVING, budget)
    assert ours.fit.iterations <= 3
    assert np.abs((ours.parameters - theirs.parameters) / theirs.standard_uncertainty).max() < 1e-3
    assert ours.standard_uncertainty == pytest.approx(theirs.standard_uncertainty, rel=1e-3)
