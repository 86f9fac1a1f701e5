"""The live map against the identification, against made-up errors, and before it can know anything."""

import copy
import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from catseye.calibration.core.errors import ArgumentError, UnidentifiableError
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.errors import MapRangeError
from catseye.calibration.scara.identification import identify
from catseye.calibration.scara.live_map import Changes, Innovation, LiveMap
from catseye.calibration.scara.points import Points
from catseye.calibration.scara.radial import RadialBudget
from tests.unit.calibration.scara.drifting import course
from tests.unit.calibration.scara.paper import (
    NAMES,
    NODES1_DEG,
    NODES2_DEG,
    NOMINAL_REFLECTORS,
    Truth,
    paper_points,
    random_truth,
    sequence,
    true_position,
)
from tests.unit.calibration.scara.reversal import HALF_TURN, AxisMotion, mounted
from tests.unit.calibration.scara.samples import radial_motions
from tests.unit.calibration.scara.test_radial_budget import radial_errors

NODES1, NODES2 = np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)
WHITE_MM = 0.010
BUDGET = RadialBudget(0.005, 0.005, 0.010)
PLACES = {name: (float(x), float(y)) for name, (x, y) in zip(NAMES, NOMINAL_REFLECTORS, strict=True)}


ZERO = Contributor("zero", "length", 0.005, "time", orders=15, spectrum=(1.0, 2.0, 0.5, 1.0))
WARMTH = Contributor("warmth", "links", 1e-5, "time", orders=3, spectrum=(1.0, 1.0))


def live_map(radial: RadialBudget | None = None, changes: Changes | None = None) -> LiveMap:
    return LiveMap(NODES1, NODES2, 325.0, 225.0, PLACES, WHITE_MM, radial, changes)


def add_row(live: LiveMap, points: Points, row: int) -> Innovation | None:
    commands = points.commands
    name, segment = points.dead_paths[points.dead_path[row]]
    return live.add(
        float(commands.theta1_rad[row]),
        float(commands.theta2_rad[row]),
        int(commands.direction1[row]),
        int(commands.direction2[row]),
        name,
        segment,
        float(points.displacement_mm[row]),
        0.0 if points.mount_rad is None else float(points.mount_rad[row]),
    )


@cache
def measured(seed: int, radial: RadialBudget | None) -> Points:
    truth, rng = random_truth(seed), np.random.default_rng(500 + seed)
    noise: Floats = rng.normal(0.0, WHITE_MM, 1056)
    if radial is not None:
        noise = noise + radial_errors(rng, truth, radial, 3)
    return paper_points(truth, noise_mm=noise, sigma_mm=WHITE_MM)


@cache
def campaign(seed: int, *, radial: bool) -> tuple[LiveMap, Points, list[Innovation | None]]:
    """Take in the paper's measurement."""
    budget = BUDGET if radial else None
    points, live = measured(seed, budget), live_map(budget)
    return live, points, [add_row(live, points, row) for row in range(len(points))]


def identified_u(points: Points, radial: RadialBudget | None) -> tuple[Floats, Floats]:
    """Return the stated standard uncertainties of both maps, without the widening by a fit's scatter."""
    names = [NAMES.index(name) for name in points.reflector_names]
    budget = None if radial is None else radial_motions(radial, learnt=True)
    found = identify(points, "error-map", NODES1, NODES2, 325.0, 225.0, NOMINAL_REFLECTORS[names], budget)
    u = found.standard_uncertainty / math.sqrt(found.fit.variance_ratio)
    return u[found.layout.map1], u[found.layout.map2]


@pytest.mark.parametrize("radial", [False, True])
def test_in_the_end_it_knows_as_much_as_the_identification(radial: bool) -> None:
    live, points, _ = campaign(1, radial=radial)
    known = live.known()
    first, second = identified_u(points, BUDGET if radial else None)
    assert known.reason == ""
    assert known.u1_rad == pytest.approx(first.max(), rel=0.01)
    assert known.u2_rad == pytest.approx(second.max(), rel=0.01)


ON_THE_WAY = (352, 500, 704)


@cache
def on_the_way() -> dict[int, LiveMap]:
    """Return what has become of one map after so many points."""
    points, live, reached = measured(2, BUDGET), live_map(BUDGET), {}
    for row in range(max(ON_THE_WAY)):
        add_row(live, points, row)
        if len(live) in ON_THE_WAY:
            reached[len(live)] = copy.deepcopy(live)
    return reached


@pytest.mark.parametrize("count", ON_THE_WAY)
def test_live_uncertainty_matches_identifying_the_points_so_far(count: int) -> None:
    points, known = measured(2, BUDGET), copy.deepcopy(on_the_way()[count]).known()
    first, second = identified_u(points.select(np.arange(len(points)) < count), BUDGET)
    assert (known.u1_rad, known.u2_rad) == pytest.approx((first.max(), second.max()), rel=0.01)


def test_it_knows_how_the_interferometer_is_mounted() -> None:
    motion = AxisMotion.drawn(np.random.default_rng(4), BUDGET.j4_mm, BUDGET.j4_mm)
    whole = mounted(random_truth(4), motion.longer, [0.0, HALF_TURN], WHITE_MM, 4)
    points = replace(whole.select(whole.reflector == 0), sigma_mm=np.full(704, WHITE_MM))
    live, unaware = live_map(BUDGET), live_map(BUDGET)
    for row in range(len(points)):
        add_row(live, points, row)
        add_row(unaware, replace(points, mount_rad=None), row)
    first, second = identified_u(points, BUDGET)
    known, other = live.known(), unaware.known()
    assert (known.u1_rad, known.u2_rad) == pytest.approx((first.max(), second.max()), rel=0.01)
    assert other.u1_rad is not None
    assert other.u1_rad > 1.2 * first.max()


def changing(count: int, rows: int) -> Floats:
    """Return what independent sources of the zero and of both links do to the first distances, mm, in loops."""
    truth, effects = random_truth(2), np.zeros((count, 18))
    octaves = (1.0, 2.0, 2.0, *[0.5] * 4, *[1.0] * 8)
    shares = [[ratio / k**2 for k, ratio in enumerate(octaves, 1)], [1.0, 1 / 4, 1 / 9]]
    whole = [sum(1.0 / k**2 for k in range(1, orders + 1)) for orders in (15, 3)]
    for i in range(count):
        place = truth.reflectors[i // 352]
        row = sequence()[i % 352]
        grown = replace(truth, link1_mm=truth.link1_mm * 1.00001, link2_mm=truth.link2_mm * 1.00001)
        longer = math.dist(true_position(grown, row), place) - math.dist(true_position(truth, row), place)
        column = 0
        for size, parts, total in ((0.005, shares[0], whole[0]), (longer, shares[1], whole[1])):
            for k, share in enumerate(parts, 1):
                effects[i, column] = size * math.sqrt(share / total) * course(k, i / (rows - 1))
                column += 1
    return effects


def dense_u(count: int) -> tuple[float, float]:
    """Return the largest u of either map from the first distances, by matrices of rows by rows."""
    effects = changing(count, 1056)
    reflectors = -(-count // 352)
    jacobian = np.zeros((count, 40 + 3 * reflectors))
    for j in range(reflectors):
        rows = slice(352 * j, min(352 * (j + 1), count))
        block = derivatives(rows.stop - rows.start, 2, j)
        jacobian[rows, :40], jacobian[rows, 40 + 3 * j : 43 + 3 * j] = block[:, :40], block[:, 40:]
    constraint = np.zeros((1, jacobian.shape[1]))
    constraint[0, 2:24] = 1.0
    free = np.linalg.svd(constraint)[2][1:].T
    covariance = WHITE_MM**2 * np.eye(count) + effects @ effects.T
    reduced = jacobian @ free
    known = free @ np.linalg.inv(reduced.T @ np.linalg.solve(covariance, reduced)) @ free.T
    u = np.sqrt(np.diag(known))
    return float(u[2:24].max()), float(u[24:40].max())


@pytest.mark.parametrize("count", [352, 704, 1056])
def test_what_changes_with_time_counts_as_in_dense_matrices(count: int) -> None:
    points, live = measured(2, None), live_map(None, Changes((ZERO, WARMTH), 1056))
    for row in range(count):
        add_row(live, points, row)
    known = live.known()
    # The derivatives are taken at the estimate here and at the truth there.
    assert (known.u1_rad, known.u2_rad) == pytest.approx(dense_u(count), rel=1e-3)


def test_in_the_end_drifts_count_as_in_the_identification() -> None:
    points, budget = measured(2, BUDGET), radial_motions(BUDGET, learnt=True)
    live = live_map(BUDGET, Changes((ZERO, WARMTH), len(points)))
    for row in range(len(points)):
        add_row(live, points, row)
    everything = Budget((*budget.contributors, ZERO, WARMTH))
    found = identify(points, "error-map", NODES1, NODES2, 325.0, 225.0, NOMINAL_REFLECTORS, everything)
    u = found.standard_uncertainty / math.sqrt(found.fit.variance_ratio)
    largest = u[found.layout.map1].max(), u[found.layout.map2].max()
    known = live.known()
    assert (known.u1_rad, known.u2_rad) == pytest.approx(largest, rel=1e-4)


def test_only_what_changes_with_time_is_taken_as_such() -> None:
    with pytest.raises(ArgumentError, match="noise: no contributor that changes with time"):
        Changes((Contributor("noise", "length", 0.01),), 10)


def test_segments_have_dead_paths_of_their_own() -> None:
    whole = measured(3, None)
    number = np.arange(len(whole)) // 44
    paths = tuple((NAMES[i // 8], i) for i in range(24))
    jumps = np.random.default_rng(4).normal(0.0, 100.0, 24)
    points = Points(
        whole.commands, whole.reflector, number, whole.displacement_mm + jumps[number], whole.sigma_mm, NAMES, paths
    )  # fmt: skip
    live = live_map()
    innovations = [add_row(live, points, row) for row in range(len(points))]
    known = live.known()
    first, second = identified_u(points, None)
    assert (known.u1_rad, known.u2_rad) == pytest.approx((first.max(), second.max()), rel=0.01)
    # A segment's first point gives its dead path and nothing else.
    assert all(innovations[row] is None for row in range(0, 1056, 44))
    later = [found.value_mm for found in innovations[352:] if found is not None]
    assert float(np.abs(later).max()) < 0.1


@pytest.mark.parametrize("radial", [False, True])
def test_innovations_are_white_with_the_stated_size(radial: bool) -> None:
    squares, products, early = [], [], []
    for seed in range(2):
        innovations = campaign(seed, radial=radial)[2]
        z = np.array([found.normalised for found in innovations if found is not None])
        squares.append(z**2)
        early.append(z[:100] ** 2)
        products += [z[lag:] * z[:-lag] for lag in (1, 2, 16)]
    # 2 × 990 squares scatter by sqrt(2 / 1980) = 3.2 % about 1, products of neighbours by 2.2 % about 0.
    assert float(np.mean(np.concatenate(squares))) == pytest.approx(1.0, abs=0.08)
    assert float(np.mean(np.concatenate(early))) == pytest.approx(1.0, abs=0.25)
    for lag in range(3):
        assert float(np.mean(np.concatenate(products[lag::3]))) == pytest.approx(0.0, abs=0.06)


def test_unstated_radial_error_motion_enlarges_the_innovations() -> None:
    points, live = measured(5, BUDGET), live_map()
    found = [add_row(live, points, row) for row in range(len(points))]
    z = np.array([one.normalised for one in found if one is not None])
    assert float(np.mean(z**2)) > 1.3


def test_a_blunder_stands_out_at_once() -> None:
    points, live, row = measured(2, BUDGET), copy.deepcopy(on_the_way()[500]), 500
    wrong_mm = np.where(np.arange(len(points)) == row, 0.5, 0.0)
    found = add_row(live, replace(points, displacement_mm=points.displacement_mm + wrong_mm), row)
    assert found is not None
    assert found.value_mm == pytest.approx(0.5, abs=0.05)
    assert found.normalised > 10.0


def test_nothing_is_predicted_that_the_points_before_do_not_determine() -> None:
    innovations = campaign(0, radial=False)[2]
    unpredicted = [row for row, found in enumerate(innovations) if found is None]
    # Each of the 38 nodes is touched for a first time, each reflector brings 3 unknowns, the links are 2 more, and
    # the gauge takes one away: no fewer rows can be without a prediction.
    assert len(unpredicted) >= 38 + 9 + 2 - 1
    touched: set[tuple[str, int, int]] = set()
    for row, (i1, i2, s1, s2) in enumerate(sequence()):
        new = {("θ1", i1, s1), ("θ2", i2, s2)} - touched
        touched |= new
        if new:
            assert innovations[row] is None, (row, new)
    # A point that was predicted is one whose knowledge is finite and in proportion.
    assert max(found.u_mm for found in innovations if found is not None) < 10.0


def derivatives(count: int, seed: int = 7, reflector: int = 0) -> Floats:
    """Return central differences of the first distances by links, tables, place and dead path of one reflector."""
    truth = random_truth(seed)
    vector = np.array([*truth.table_vector(), *truth.reflectors[reflector], 0.0])

    def distances(values: Floats) -> Floats:
        tables = np.split(values[2:40], [11, 22, 30])
        bent = Truth(
            float(values[0]),
            float(values[1]),
            {1: list(tables[0]), -1: list(tables[1])},
            {1: list(tables[2]), -1: list(tables[3])},
            values[40:42].reshape(1, 2),
        )
        rows = sequence()[:count]
        return np.array(
            [math.dist(true_position(bent, row), bent.reflectors[0]) - values[42] for row in rows]
        )

    steps = np.diag(np.where(np.isin(np.arange(43), range(2, 40)), 1e-5, 1e-3))
    columns = [(distances(vector + step) - distances(vector - step)) / (2.0 * step.max()) for step in steps]
    return np.stack(columns, axis=1)


def test_a_map_is_known_once_the_points_determine_it() -> None:
    points, live = measured(7, None), live_map()
    for count in (16, 24, 32, 36, 40, 48, 64):
        for row in range(len(live), count):
            add_row(live, points, row)
        known = live.known()
        jacobian = derivatives(count)
        scale = np.linalg.norm(jacobian, axis=0)
        touched = scale > 0.0
        _, values, right = np.linalg.svd(jacobian[:, touched] / scale[touched])
        rank = int(np.sum(values > 1e-7 * values[0]))
        j2 = np.isin(np.flatnonzero(touched), range(24, 40))
        determined = touched[24:40].all() and float(np.abs(right[rank:, j2]).max(initial=0.0)) < 1e-3
        assert known.u1_rad is None, count
        assert (known.u2_rad is not None) == determined, count
        if determined:
            half = (right[:rank].T / values[:rank])[j2] / scale[touched][j2][:, None]
            largest = WHITE_MM * float(np.linalg.norm(half, axis=1).max())
            assert known.u2_rad == pytest.approx(largest, rel=0.02), count


def test_no_prefix_that_the_identification_refuses_gets_a_number() -> None:
    points, live = measured(7, None), live_map()
    for row in range(352):
        add_row(live, points, row)
        if row % 16 != 15 or row < 42:
            continue
        known = live.known()
        try:
            first, second = identified_u(points.select(np.arange(1056) <= row), None)
        except UnidentifiableError as error:
            loose = {name for names in error.null_directions for name in names}
            assert (known.u1_rad is None) == any(name.startswith("Δθ1") for name in loose), row
            assert (known.u2_rad is None) == any(name.startswith("Δθ2") for name in loose), row
            assert known.reason.startswith("Δθ1 not measured yet: ")
        else:
            assert (known.u1_rad, known.u2_rad) == pytest.approx((first.max(), second.max()), rel=0.01)
            assert row >= 336


def test_what_is_missing_is_named() -> None:
    live = live_map()
    assert live.known().reason == "no distance has been measured yet"
    points = measured(8, None)
    for row in range(352 - 16):
        add_row(live, points, row)
    known = live.known()
    assert known.u2_rad is not None
    assert known.u1_rad is None
    assert known.reason == "Δθ1 not measured yet: Δθ1(-140°, −)"


def test_one_direction_of_j2_alone_is_said() -> None:
    live, points = live_map(), measured(9, None)
    for row in np.flatnonzero(points.commands.direction2 > 0):
        add_row(live, points, int(row))
    known = live.known()
    assert known.u2_rad is None
    assert known.reason.startswith("Δθ2 not measured yet: Δθ2(0°, −), ")
    assert known.reason.endswith(" and 2 more")
    assert known.u1_rad is not None


def test_a_single_j2_angle_cannot_part_links_and_maps() -> None:
    live = LiveMap(NODES1, NODES2[3:4], 325.0, 225.0, PLACES, WHITE_MM)
    points = measured(10, None)
    for row in np.flatnonzero(np.abs(points.commands.theta2_rad - NODES2[3]) < 1e-6):
        add_row(live, points, int(row))
    known = live.known()
    assert known.u2_rad is None
    assert "not separable yet: Δθ2(60°, +), Δθ2(60°, −)" in known.reason


def test_rows_in_another_order_leave_the_same_knowledge() -> None:
    points, forwards, shuffled = measured(1, BUDGET), live_map(BUDGET), live_map(BUDGET)
    order = np.arange(352)
    for live, rows in ((forwards, order), (shuffled, np.random.default_rng(11).permutation(order))):
        for row in rows:
            add_row(live, points, int(row))
    expected, found = forwards.known(), shuffled.known()
    assert (found.u1_rad, found.u2_rad) == pytest.approx((expected.u1_rad, expected.u2_rad), rel=1e-3)


def test_wrong_rows_are_refused_and_leave_no_trace() -> None:
    live, points = live_map(), measured(12, None)
    add_row(live, points, 0)
    with pytest.raises(ValueError, match=r"reflector P9 is not among .* P1, P2, P3"):
        live.add(0.0, 0.0, 1, 1, "P9", 0, 1.0)
    with pytest.raises(ValueError, match="reflector P1 is nan"):
        live.add(0.0, 0.0, 1, 1, "P1", 0, float("nan"))
    with pytest.raises(MapRangeError, match="θ1 114"):
        live.add(2.0, 0.0, 1, 1, "P1", 0, 1.0)
    assert len(live) == 1
    with pytest.raises(ValueError, match="has to be positive"):
        LiveMap(NODES1, NODES2, 325.0, 225.0, PLACES, 0.0)


def test_identical_rows_in_a_segment_carry_no_information() -> None:
    points, live = measured(13, None), live_map()
    for row in np.flatnonzero(points.commands.direction2 > 0):
        add_row(live, points, int(row))
    # Nodes of the other direction, each twice in a segment of its own: nothing is left beside the dead path.
    for i, row in enumerate(np.flatnonzero(points.commands.direction2 < 0)[:8]):
        c = points.commands
        for _ in range(3):
            live.add(c.theta1_rad[row], c.theta2_rad[row], int(c.direction1[row]), -1, "P1", 10 + i, 0.1)
    known = live.known()
    assert known.u2_rad is None
    assert known.reason.startswith("Δθ2 not measured yet: Δθ2(0°, −), ")
