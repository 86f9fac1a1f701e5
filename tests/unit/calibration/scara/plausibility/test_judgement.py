"""Sound measurements pass the gate, classic mistakes are refused and named."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.errors import BudgetError, CalibrationError, ConvergenceError
from catseye.calibration.scara.budget import Budget
from catseye.calibration.scara.layout import ModelName
from catseye.calibration.scara.plausibility.bounds import Bounds
from catseye.calibration.scara.plausibility.findings import (
    AngleSignReversed,
    AnglesInRadians,
    DisplacementScaled,
    DisplacementSignReversed,
    LinksExchanged,
    Mistake,
    MountingForgotten,
    MountingInRadians,
    MountingOff,
    NamesExchanged,
    OtherLinks,
    PlaceOff,
    PlacesMirrored,
    ReflectorMoved,
    RowsShifted,
    Verdict,
    ZeroLost,
)
from catseye.calibration.scara.plausibility.judgement import judge
from catseye.calibration.scara.scans.scan_identification import identify_scan
from catseye.calibration.scara.scans.source import SlicedPoints
from tests.unit.calibration.scara.plausibility.tables import (
    LOST_AT,
    MISTAKES,
    SOUND_BENCHES,
    Faults,
    Table,
    measured,
    table_2,
)


def verdict(table: Table, budget: Budget | None = None, model: ModelName = "error-map") -> Verdict:
    problem = table.problem(budget, model)
    try:
        found = problem.solve()
    except CalibrationError:
        return judge(problem, None)
    return judge(problem, found)


@pytest.mark.parametrize("number", range(len(SOUND_BENCHES)))
def test_a_sound_measurement_passes(number: int) -> None:
    table = measured(100 + number, SOUND_BENCHES[number])
    assert not verdict(table, table_2()).implausible


@pytest.mark.parametrize("model", ["conventional", "error-map"])
def test_a_sound_measurement_without_a_budget_passes(model: ModelName) -> None:
    assert not verdict(measured(7), None, model).implausible


@pytest.mark.parametrize("sigma_mm", [1e-3, 1e-5, 1e-9])
def test_a_sigma_far_too_small_is_no_implausible_arm(sigma_mm: float) -> None:
    problem = measured(7, Faults(radial=3.0)).problem(None)
    stated = replace(problem.points, sigma_mm=np.full(len(problem.points), sigma_mm))
    problem = replace(problem, points=stated)
    assert not judge(problem, problem.solve()).implausible


@pytest.mark.parametrize("sigma_mm", [1e-7, 1e-9])
def test_a_sigma_that_is_nothing_beside_shared_errors_is_refused(sigma_mm: float) -> None:
    problem = measured(7).problem(table_2())
    stated = replace(problem.points, sigma_mm=np.full(len(problem.points), sigma_mm))
    with pytest.raises(BudgetError, match=r"sigma_mm is as small as .* Is it in m"):
        replace(problem, points=stated).solve()


def named(mistake: Mistake, name: str) -> bool:
    """Return whether a mistake is the one of that name."""
    match mistake:
        case AngleSignReversed(joints):
            return name == {(1,): "sign of θ1", (2,): "sign of θ2", (1, 2): "sign of both"}[joints]
        case DisplacementSignReversed():
            return name == "sign of the displacement"
        case AnglesInRadians(joints):
            return name == "radians for degrees" and joints == (1, 2)
        case DisplacementScaled(factor):
            # Links and places of the drawn benches leave the scale open by a few tenths of a percent.
            units = {"metres": 1e3, "inches": 25.4, "counts": 0.000158247, "a scale 5 % off": 1.0 / 1.05}
            return name in units and abs(factor / units[name] - 1.0) < 0.005
        case LinksExchanged():
            return name == "L1 and L2 exchanged"
        case OtherLinks(link1_mm, link2_mm):
            off_mm = max(abs(link1_mm - 325.0), abs(link2_mm - 225.0))
            return name == "links of another arm" and off_mm < 1.0
        case RowsShifted(rows):
            return name == "rows shifted by one" and rows == 1
        case NamesExchanged(first, second):
            return name == "names exchanged" and {first, second} == {"P1", "P2"}
        case PlacesMirrored(mirror):
            return name == "places mirrored" and mirror == "y"
        case ZeroLost(reflector, _, _, row, _):
            return name == "a zero lost inside a segment" and (reflector, row) == ("P2", LOST_AT)
        case ReflectorMoved() | MountingForgotten() | MountingInRadians() | MountingOff():
            return False


@pytest.mark.parametrize("name", MISTAKES)
def test_a_classic_mistake_is_refused_and_named(name: str) -> None:
    found = verdict(MISTAKES[name](measured(11, Faults(radial=3.0, drift_mm=0.02))), table_2())
    assert found.implausible
    assert any(named(mistake, name) for mistake in found.mistakes)


def test_mirrored_places_and_two_reversed_signs_are_alike() -> None:
    mirrored, signs = (verdict(MISTAKES[name](measured(12))) for name in ("places mirrored", "sign of both"))
    assert set(mirrored.mistakes) == set(signs.mistakes)
    assert set(mirrored.mistakes) == {PlacesMirrored("y"), AngleSignReversed((1, 2))}


def moved_by(table: Table, by_mm: tuple[float, float], row: int) -> Table:
    """Return a table whose P3 was moved before a row: distances grow by what lies along the beam."""
    later = (table.reflector == 2) & (np.arange(len(table.displacement)) >= row)
    a, b = np.radians(table.theta_deg[:, 0]), np.radians(table.theta_deg.sum(axis=1))
    x, y = (325.0 * f(a) + 225.0 * f(b) for f in (np.cos, np.sin))
    away = np.hypot(640.0 - x, 380.0 - y)
    moved = np.hypot(640.0 + by_mm[0] - x, 380.0 + by_mm[1] - y)
    return replace(table, displacement=table.displacement + np.where(later, moved - away, 0.0))


def test_a_reflector_moved_in_the_middle_is_named() -> None:
    found = verdict(moved_by(measured(13), (0.6, -0.8), 900), table_2())
    (mistake,) = found.mistakes
    assert isinstance(mistake, ReflectorMoved)
    assert (mistake.reflector, mistake.row) == ("P3", 900)
    # 156 distances of 10 µm with radial error motions locate the rest of a series to about 30 µm.
    assert mistake.by_mm == pytest.approx((0.6, -0.8), abs=0.1)


def test_a_small_jump_without_a_broken_bound_is_named() -> None:
    table = measured(14)
    later = (table.reflector == 1) & (np.arange(len(table.displacement)) >= LOST_AT)
    found = verdict(replace(table, displacement=table.displacement + 0.3 * later), table_2())
    assert found.breaks == ()
    (mistake,) = found.mistakes
    assert isinstance(mistake, ZeroLost)
    assert mistake.row == LOST_AT
    assert mistake.jump_mm == pytest.approx(0.3, abs=0.02)


def test_a_zero_lost_in_a_long_table_is_named() -> None:
    one = measured(3, Faults(breaks=1))
    times = 20
    table = replace(
        one,
        theta_deg=np.tile(one.theta_deg, (times, 1)),
        direction=np.tile(one.direction, (times, 1)),
        reflector=np.tile(one.reflector, times),
        segment=np.concatenate([one.segment + 2 * number for number in range(times)]),
        displacement=np.tile(one.displacement, times),
    )
    row = 5000
    later = (np.arange(times * 1056) >= row) & (table.reflector == table.reflector[row])
    later &= table.segment == table.segment[row]
    spoiled = replace(table, displacement=table.displacement - later * table.displacement[row])
    assert not verdict(table, table_2()).implausible
    (mistake,) = verdict(spoiled, table_2()).mistakes
    assert isinstance(mistake, ZeroLost)
    # Of more than 20 000 distances some are left out.
    assert row <= mistake.row < row + 5
    assert mistake.jump_mm == pytest.approx(-table.displacement[row], abs=0.1)


def test_rows_are_numbered_as_they_were_given() -> None:
    """Two distances of a segment of their own are left out, and count all the same."""
    table = measured(14)
    later = (table.reflector == 1) & (np.arange(len(table.displacement)) >= LOST_AT)
    segment = table.segment.copy()
    segment[10:12] = 7
    spoiled = replace(table, segment=segment, displacement=table.displacement + 0.3 * later)
    problem = spoiled.problem(table_2())
    for found in (None, problem.solve()):
        (mistake,) = judge(problem, found).mistakes
        assert isinstance(mistake, ZeroLost)
        assert (mistake.reflector, mistake.segment) == ("P2", 0)
        assert (mistake.after, mistake.row) == (LOST_AT - 1, LOST_AT)


def test_a_zero_lost_in_a_scan_is_located() -> None:
    table = measured(14, Faults(off_nodes=True))
    row = LOST_AT + 40
    later = (table.reflector == 1) & (np.arange(len(table.displacement)) >= row)
    many = np.repeat(np.arange(len(later)), 12)
    rng = np.random.default_rng(2)
    spoiled = Table(
        table.theta_deg[many],
        table.direction[many],
        table.reflector[many],
        table.segment[many],
        (table.displacement - 5.0 * later)[many] + rng.normal(0.0, 0.01, many.size),
        table.rough_mm,
    )
    problem = spoiled.problem(None)
    nodes = problem.nodes1_rad, problem.nodes2_rad
    source = SlicedPoints(problem.points, 1_000)
    found = identify_scan(source, "error-map", *nodes, 325.0, 225.0, problem.reflectors_mm).identified
    assert len(found.points) < 4_001 < many.size
    (mistake,) = judge(replace(problem, points=found.points), found).mistakes
    assert isinstance(mistake, ZeroLost)
    assert mistake.reflector == "P2"
    assert mistake.jump_mm == pytest.approx(-5.0, abs=0.1)
    assert mistake.after < 12 * row <= mistake.row
    assert mistake.row - mistake.after < 12


def test_misfit_that_nothing_explains_is_not_refused() -> None:
    table = measured(15)
    noise = np.random.default_rng(1).normal(0.0, 0.3, len(table.displacement))
    found = verdict(replace(table, displacement=table.displacement + noise), table_2())
    assert not found.implausible
    assert found.rms_mm == pytest.approx(0.3, rel=0.1)


@pytest.mark.parametrize("angle_deg", range(0, 360, 90))
def test_places_600_mm_off_do_not_silently_decide(angle_deg: int) -> None:
    table = measured(16)
    step = 600.0 * np.array([np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))])
    found = verdict(replace(table, rough_mm=table.rough_mm + step), table_2())
    assert found.implausible


def with_two_angles_of_j2(table: Table, nodes_deg: tuple[float, float]) -> Table:
    kept = np.isin(table.theta_deg[:, 1], nodes_deg)
    return replace(
        table,
        theta_deg=table.theta_deg[kept],
        direction=table.direction[kept],
        reflector=table.reflector[kept],
        segment=table.segment[kept],
        displacement=table.displacement[kept],
        nodes_deg=(table.nodes_deg[0], nodes_deg),
    )


@pytest.mark.parametrize("nodes_deg", [(0.0, 60.0), (20.0, 100.0), (0.0, 140.0)])
@pytest.mark.parametrize("off_mm", [0.0, 10.0, 50.0])
def test_two_angles_of_j2_do_not_let_the_start_decide(nodes_deg: tuple[float, float], off_mm: float) -> None:
    table = with_two_angles_of_j2(measured(5), nodes_deg)
    problem = replace(table, rough_mm=table.rough_mm + np.array([off_mm, -off_mm])).problem(None)
    try:
        found = problem.solve()
    except ConvergenceError:
        # The same arm near what was known, and the reason why no other one is found.
        assert judge(problem, None).vague
        return
    judged = judge(problem, found)
    assert judged.mistakes == ()
    assert judged.vague
    # What the start made of the arm is told apart from the other arm that fits as well.
    assert bool(judged.breaks) == bool(judged.others)


def test_bounds_are_those_that_were_given() -> None:
    table = measured(17, Faults(rough_mm=0.0))
    problem = replace(table, rough_mm=table.rough_mm + np.array([30.0, 0.0])).problem(table_2())
    found = problem.solve()
    assert not judge(problem, found).implausible
    breaks = judge(problem, found, Bounds(place_mm=20.0)).breaks
    assert {one.reflector for one in breaks if isinstance(one, PlaceOff)} == {"P1", "P2", "P3"}
    assert all(isinstance(one, PlaceOff) and one.off_mm == pytest.approx(30.0, abs=1.0) for one in breaks)
