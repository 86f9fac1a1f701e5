"""The interferometer turned on J4's flange: what two mountings separate, and what identification makes of it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.errors import UnidentifiableError
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.budget_effects import effects
from catseye.calibration.scara.extension import Term, j4_map
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.points import Points
from catseye.calibration.scara.reversal import separated_orders
from catseye.calibration.scara.scans.scan_identification import identify_scan
from catseye.calibration.scara.scans.source import SlicedPoints
from tests.unit.calibration.scara.diagnostics.bench import NODES1, NODES2, problem
from tests.unit.calibration.scara.paper import NOMINAL_REFLECTORS, Truth, random_truth
from tests.unit.calibration.scara.reversal import HALF_TURN, AxisMotion, jacobian, mounted

TRUTH = random_truth(8)
WHITE_MM = 0.010
J4 = Contributor("radial error motion of J4", "radial", 0.010, "axis-angle", "j4")
BUDGET = Budget((Contributor("repeatability", "position", WHITE_MM), J4))
SEEN_FROM_P3 = 2
"""The reflector that leaves most to a second mounting: beams to it turn least against link 2."""


def still(_beam: float, _mount: float) -> float:
    return 0.0


def left_over(points: Points, columns: Floats) -> Floats:
    """Return the singular values of unit waves on what links, maps, places and dead paths do not take up."""
    rows, _ = jacobian(points, TRUTH)
    left, values, _ = np.linalg.svd(rows / np.linalg.norm(rows, axis=0), full_matrices=False)
    basis = left[:, values > 1e-9 * values[0]]
    rest = columns - basis @ (basis.T @ columns)
    return np.asarray(np.linalg.svd(rest, compute_uv=False) / math.sqrt(len(points)))


def motion_columns(points: Points, order: int) -> Floats:
    """Return what one order of J4's motion does to beams: cosine and sine in x and in y of link 2."""
    _, beam = jacobian(points, TRUTH)
    j4 = beam - (0.0 if points.mount_rad is None else points.mount_rad)
    return np.column_stack(
        [-along(beam) * wave(order * j4) for along in (np.cos, np.sin) for wave in (np.cos, np.sin)]
    )


@pytest.mark.parametrize("order", [1, 3, 5])
def test_half_a_turn_frees_odd_orders_of_the_maps(order: int) -> None:
    once, turned = mounted(TRUTH, still, [0.0, 0.0]), mounted(TRUTH, still, [0.0, HALF_TURN])
    before, after = (left_over(points, motion_columns(points, order)) for points in (once, turned))
    # A wave that nothing takes up leaves 1/2: cosine and sine along one of two directions. The first order has two
    # combinations that lengthen all beams alike, which are dead paths.
    free = 2 if order == 1 else 4
    assert np.all(after[:free] > before[:free])
    assert after[free - 1] > 0.45
    assert after[free:] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("order", [2, 4])
def test_half_a_turn_leaves_even_orders_as_they_were(order: int) -> None:
    once, turned = mounted(TRUTH, still, [0.0, 0.0]), mounted(TRUTH, still, [0.0, HALF_TURN])
    before, after = (left_over(points, motion_columns(points, order)) for points in (once, turned))
    assert after == pytest.approx(before, abs=1e-9)


def test_only_a_quarter_turn_separates_order_two_from_link_2() -> None:
    half, quarter = mounted(TRUTH, still, [0.0, HALF_TURN]), mounted(TRUTH, still, [0.0, 0.5 * HALF_TURN])
    assert left_over(half, motion_columns(half, 2))[2:] == pytest.approx(0.0, abs=1e-9)
    assert left_over(quarter, motion_columns(quarter, 2)).min() > 0.4


def test_what_j4_adds_to_the_length_separates_from_link_2() -> None:
    once, turned = mounted(TRUTH, still, [0.0, 0.0]), mounted(TRUTH, still, [0.0, HALF_TURN])
    for points, least, most in ((once, 0.0, 1e-9), (turned, 0.6, 0.75)):
        assert points.mount_rad is not None
        j4 = jacobian(points, TRUTH)[1] - points.mount_rad
        found = left_over(points, np.column_stack([np.cos(j4), np.sin(j4)]))
        assert least <= found.min() <= found.max() <= most


def test_effects_are_those_of_a_motion_by_j4s_own_angle() -> None:
    points = mounted(TRUTH, still, [0.0, np.deg2rad(178.7)])
    model = replace(problem(points), budget=BUDGET).solve().model
    values = model.start(TRUTH.link1_mm, TRUTH.link2_mm, TRUTH.reflectors)
    sources = effects(J4, model.geometry(values))
    expected = np.hstack([motion_columns(points, order) for order in range(1, 6)]) * 0.010 / math.sqrt(5.0)
    assert np.abs(sources @ sources.T - expected @ expected.T).max() < 1e-9


@pytest.mark.parametrize("order", [0, 1])
def test_orders_that_no_half_turn_separates_are_refused_by_name(order: int) -> None:
    points = mounted(TRUTH, still, [0.0, HALF_TURN], noise_mm=WHITE_MM)
    # The sine of order 0 is none.
    terms = j4_map((1,)) if order else (Term("length", "theta4", "cos", 0),)
    with pytest.raises(
        UnidentifiableError, match=r"what Δd (cos|sin) 0?θ4.* dead paths, links or maps do as well"
    ):
        problem(points, terms=terms).solve()


def test_a_quarter_turn_identifies_the_first_order() -> None:
    points = mounted(
        TRUTH, lambda beam, mount: 0.02 * math.cos(mount) * math.cos(beam - mount), [0.0, 0.5 * HALF_TURN]
    )
    found = problem(points, terms=j4_map((1,))).solve()
    # Beams were aimed by nominal links and places: their angles differ from the true ones by some 10 mrad.
    assert found.parameters[found.layout.extension] == pytest.approx([0.02, 0.0], abs=3e-4)


def test_a_j4_map_holds_in_both_mountings() -> None:
    motion = AxisMotion.drawn(np.random.default_rng(5), 0.03, 0.0)
    points = mounted(TRUTH, motion.longer, [0.0, HALF_TURN], WHITE_MM, 5)
    terms = j4_map((2, 4, 6))
    found = replace(problem(points, terms=terms), budget=BUDGET).solve()
    true = [value for order in (2, 4, 6) for value in motion.along_first_beam(order)]
    extension = found.layout.extension
    normalised = (found.parameters[extension] - true) / found.standard_uncertainty[extension]
    assert np.abs(normalised).max() < 3.5
    # White scatter alone.
    assert found.standard_uncertainty[extension].max() < 1.5 * WHITE_MM * math.sqrt(2.0 / len(points))


def of_one_reflector(
    seed: int, mounts: list[float], odd_mm: float
) -> tuple[Identification, AxisMotion, Truth]:
    truth = random_truth(seed)
    motion = AxisMotion.drawn(np.random.default_rng(1000 + seed), odd_mm, J4.u)
    points = mounted(truth, motion.longer, mounts, WHITE_MM, seed)
    asked = replace(problem(points), budget=BUDGET).of_rows(points.reflector == SEEN_FROM_P3)
    return asked.solve(), motion, truth


def test_reversal_makes_maps_more_certain_and_more_accurate() -> None:
    """Odd orders three times as large as stated; as many distances in one mounting and in two."""
    errors: dict[str, list[Floats]] = {"once": [], "turned": []}
    us: dict[str, list[Floats]] = {"once": [], "turned": []}
    for seed in range(16):
        for name, mounts in (("once", [0.0, 0.0]), ("turned", [0.0, HALF_TURN])):
            found, _, truth = of_one_reflector(seed, mounts, 3.0 * J4.u)
            errors[name].append(found.parameters[:40] - truth.table_vector())
            us[name].append(found.standard_uncertainty[:40])
    first, links = slice(2, 24), slice(0, 1)
    for part in (first, links):
        u_once, u_turned = (np.array(us[name])[:, part] for name in ("once", "turned"))
        assert np.all(u_turned < u_once)
        assert rms(u_turned) < 0.9 * rms(u_once)
        e_once, e_turned = (np.array(errors[name])[:, part] for name in ("once", "turned"))
        assert rms(e_turned) < 0.95 * rms(e_once)
    # 16 arms with some 10 independent errors each: known to 6 %.
    normalised = np.array(errors["turned"]) / np.array(us["turned"])
    assert rms(normalised) == pytest.approx(1.0, abs=0.2)


def test_even_orders_stay_in_the_uncertainty_of_link_2() -> None:
    once, turned = (of_one_reflector(3, mounts, J4.u)[0] for mounts in ([0.0, 0.0], [0.0, HALF_TURN]))
    # Its second order lengthens beams as link 2 does: u of one of its cosines, at least.
    stated = J4.u / math.sqrt(5.0) / math.sqrt(2.0)
    assert turned.standard_uncertainty[1] > 0.9 * stated
    assert turned.standard_uncertainty[1] == pytest.approx(once.standard_uncertainty[1], rel=0.1)


def test_separated_orders_are_those_of_the_motion() -> None:
    normalised = []
    for seed in range(10):
        truth = random_truth(seed)
        motion = AxisMotion.drawn(np.random.default_rng(seed), 0.03, 0.01)
        points = mounted(truth, motion.longer, [0.0, HALF_TURN], WHITE_MM, seed)
        found = separated_orders(replace(problem(points), budget=BUDGET).solve())
        assert [one.order for one in found] == [2, 4, 6]
        for one in found:
            off = np.array([one.cosine_mm, one.sine_mm]) - motion.along_first_beam(one.order)
            normalised += (off / np.sqrt(np.diag(one.covariance_mm2))).tolist()
            assert one.u_mm < 0.001
    # 60 values.
    assert rms(np.array(normalised)) == pytest.approx(1.0, abs=0.25)


def test_what_j4_adds_to_the_length_shows_its_first_order() -> None:
    cable = Contributor("cable", "length", 0.010, "axis-angle", "j4", orders=3)
    asked = Budget((BUDGET.contributors[0], cable))
    points = mounted(TRUTH, lambda beam, mount: 0.008 * math.cos(beam - mount), [0.0, HALF_TURN], WHITE_MM, 2)
    first, third = separated_orders(replace(problem(points), budget=asked).solve())
    assert (first.order, third.order) == (1, 3)
    assert abs(first.cosine_mm - 0.008) < 3.0 * first.u_mm
    assert third.amplitude_mm < 4.0 * third.u_mm


def test_one_mounting_separates_nothing() -> None:
    found, _, _ = of_one_reflector(1, [0.0, 0.0], J4.u)
    assert separated_orders(found) == ()
    plain = replace(problem(replace(mounted(TRUTH, still, [0.0], WHITE_MM), mount_rad=None)), budget=BUDGET)
    assert separated_orders(plain.solve()) == ()


def test_a_scan_sees_the_mountings_as_tables_do() -> None:
    motion = AxisMotion.drawn(np.random.default_rng(7), 0.03, 0.01)
    points = mounted(TRUTH, motion.longer, [0.0, HALF_TURN], WHITE_MM, 7)
    terms = j4_map((2,))
    whole = replace(problem(points, terms=terms), budget=BUDGET).solve()
    source = SlicedPoints(points, 300)
    scanned = identify_scan(
        source, "error-map", NODES1, NODES2, 325.0, 225.0, NOMINAL_REFLECTORS, BUDGET, terms
    )
    u = whole.standard_uncertainty
    assert (scanned.identified.parameters - whole.parameters) / u == pytest.approx(0.0, abs=0.02)
    assert scanned.identified.standard_uncertainty / u == pytest.approx(1.0, abs=0.02)


def test_which_mounting_counts_as_the_first_is_all_one() -> None:
    motion = AxisMotion.drawn(np.random.default_rng(7), 0.03, 0.01)
    points = mounted(TRUTH, motion.longer, [0.0, HALF_TURN], WHITE_MM, 7)
    assert points.mount_rad is not None
    exchanged = replace(points, mount_rad=HALF_TURN - points.mount_rad)
    one, other = (replace(problem(each), budget=BUDGET).solve() for each in (points, exchanged))
    u = one.standard_uncertainty
    assert (other.parameters - one.parameters) / u == pytest.approx(0.0, abs=1e-6)
    assert other.standard_uncertainty == pytest.approx(u, rel=1e-6)


def rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
