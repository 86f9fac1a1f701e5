"""Search: where to look from, the middle of the return window, and what the sightings give."""

import math
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.errors import PlanError, ReflectorNotFoundError
from catseye.procedures.scara.beam.beam_scan import find_return, half_window_deg, scan_offsets_deg
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.search.reflector_search import ReflectorSearch, SearchParams
from catseye.procedures.scara.search.search_plan import SearchPlan, plan_search
from tests.unit.procedures.benches import IdealContext, arm_xy, bench, clearance_mm, with_optics

TRUE_PLACES = {"P1": (657.0, -409.0), "P2": (669.0, 12.0), "P3": (646.0, 391.0)}
TRUE_THETA40 = 1.4
POSE: Pose = (10.0, 30.0, 12.5, 0.0)


def looking_from(pose: Pose, centre_deg: float, half_deg: float) -> IdealContext:
    """Return a bench whose beam returns at exactly the J4 angles centre ± half."""
    return IdealContext(
        places={"wall": (0.0, 0.0)},
        acceptance_mm=math.inf,
        blocked=lambda at: at[:3] != pose[:3] or abs(at[3] - centre_deg) > half_deg,
    )


def sees_backwards(context: IdealContext) -> IdealContext:
    """Let the beam return whatever its direction: only the window decides."""
    context.places = {"one side": (1e5, 0.0), "other side": (-1e5, 0.0)}
    return context


@pytest.mark.parametrize("centre", [0.0, 0.31, -2.7, 3.9, -3.99])
async def test_the_middle_of_the_window_is_found(centre: float) -> None:
    context = sees_backwards(looking_from(POSE, centre, 0.085))
    window = await find_return(context, POSE, 4.0, 0.08, (-360.0, 360.0))
    assert window is not None
    assert window.centre_deg == pytest.approx(centre, abs=0.002)
    assert window.lower_deg == pytest.approx(centre - 0.085, abs=0.002)
    assert window.upper_deg == pytest.approx(centre + 0.085, abs=0.002)
    assert window.signal == 0.75
    assert context.pose == (*POSE[:3], window.centre_deg)


@pytest.mark.parametrize("begins", range(2, 24))
@pytest.mark.parametrize("lasts", [1, 4, 12])
async def test_what_passes_through_the_beam_feigns_no_edge(begins: int, lasts: int) -> None:
    """A person stands in the beam for some of the looks; the middle is right or there is none."""
    context = sees_backwards(looking_from(POSE, 0.31, 0.085))
    window_only, there = context.blocked, set(range(begins, begins + lasts))
    context.blocked = lambda at: window_only(at) or len(context.moves) in there
    window = await find_return(context, POSE, 4.0, 0.08, (-360.0, 360.0))
    if lasts == 1 and begins != 6:
        # The sixth look is the only one of the scan at which the beam would return.
        assert window is not None
    if window is not None:
        assert window.centre_deg == pytest.approx(0.31, abs=0.25 * 0.085)
        assert context.pose == (*POSE[:3], window.centre_deg)


async def test_only_j4_moves_while_scanning() -> None:
    context = sees_backwards(looking_from(POSE, 1.0, 0.085))
    await find_return(context, POSE, 4.0, 0.08, (-360.0, 360.0))
    assert {move[:3] for move in context.moves} == {POSE[:3]}


async def test_a_window_wider_than_expected_is_measured_whole() -> None:
    context = sees_backwards(looking_from(POSE, 0.4, 0.5))
    window = await find_return(context, POSE, 4.0, 0.08, (-360.0, 360.0))
    assert window is not None
    assert window.centre_deg == pytest.approx(0.4, abs=0.002)


async def test_nothing_is_found_where_nothing_returns() -> None:
    context = sees_backwards(looking_from(POSE, 5.0, 0.085))
    assert await find_return(context, POSE, 4.0, 0.08, (-360.0, 360.0)) is None
    turned = [move[3] for move in context.moves]
    # All of ±4° is covered: no gap is wide enough to hide a window.
    assert min(turned) <= -4.0
    assert max(turned) >= 4.0
    assert max(np.diff(sorted(turned))) < 2 * 0.08


async def test_the_scan_keeps_inside_the_limits_of_j4() -> None:
    pose: Pose = (10.0, 30.0, 12.5, 178.0)
    context = sees_backwards(looking_from(pose, 176.0, 0.085))
    context.j4_limits_deg = (-179.0, 179.0)
    window = await find_return(context, pose, 4.0, 0.08, (-179.0, 179.0))
    assert window is not None
    assert window.centre_deg == pytest.approx(176.0, abs=0.002)


@pytest.mark.parametrize("sign", [1.0, -1.0])
async def test_a_window_cut_off_by_j4s_limits_has_no_middle(sign: float) -> None:
    pose: Pose = (10.0, 30.0, 12.5, 178.9 * sign)
    context = sees_backwards(looking_from(pose, 178.97 * sign, 0.085))
    context.j4_limits_deg = (-179.0, 179.0)
    assert await find_return(context, pose, 4.0, 0.08, (-179.0, 179.0)) is None


def test_the_expected_window_follows_from_acceptance_and_length() -> None:
    assert half_window_deg(1.0, 1000.0) == pytest.approx(math.degrees(0.001), rel=1e-5)
    assert half_window_deg(2.0, 1.0) == 90.0


def test_offsets_go_from_the_middle_outwards() -> None:
    assert scan_offsets_deg(1.0, 0.4) == pytest.approx([0.0, 0.4, -0.4, 0.8, -0.8, 1.2, -1.2])


def by_reflector(plan: SearchPlan) -> dict[str, list[tuple[float, float]]]:
    found: dict[str, list[tuple[float, float]]] = {}
    for pose in plan.poses:
        found.setdefault(pose.reflector.name, []).append((pose.theta1_deg, pose.theta2_deg))
    return found


def test_search_poses_see_their_reflector_and_are_spread() -> None:
    plan = plan_search(bench(), poses=8)
    assert {name: len(poses) for name, poses in by_reflector(plan).items()} == {"P1": 8, "P2": 8, "P3": 8}
    for pose in plan.poses:
        here, there = arm_xy(pose.theta1_deg, pose.theta2_deg), (pose.reflector.x_mm, pose.reflector.y_mm)
        assert clearance_mm(here, there) > 115.0
        assert pose.beam_mm == pytest.approx(math.dist(here, there))
        world = math.degrees(math.atan2(there[1] - here[1], there[0] - here[0]))
        off = pose.j4_deg - (world - pose.theta1_deg - pose.theta2_deg)
        assert abs((off + 180.0) % 360.0 - 180.0) < 1e-9
        assert -360.0 <= pose.j4_deg <= 360.0
    for poses in by_reflector(plan).values():
        xy = [arm_xy(*pose) for pose in poses]
        assert min(math.dist(a, b) for a, b in combinations(xy, 2)) > 150.0
        # Seen from the first reflector's side and from afar: the workspace is 1100 mm wide.
        assert max(math.dist(a, b) for a, b in combinations(xy, 2)) > 700.0


def test_no_other_reflector_stands_inside_a_scan() -> None:
    plan = plan_search(bench(), half_range_deg=6.0)
    for pose in plan.poses:
        x, y = arm_xy(pose.theta1_deg, pose.theta2_deg)
        own = math.atan2(pose.reflector.y_mm - y, pose.reflector.x_mm - x)
        for other in bench().reflectors:
            if other.name == pose.reflector.name:
                continue
            off = math.degrees(math.atan2(other.y_mm - y, other.x_mm - x) - own)
            assert abs((off + 180.0) % 360.0 - 180.0) > 6.0


def test_two_reflectors_in_one_direction_are_refused() -> None:
    twins = bench(places={"P1": (650.0, -400.0), "P2": (651.0, -401.0)})
    with pytest.raises(PlanError, match=r"reflector P1 .* can be told from the others at only 0 "):
        plan_search(twins)


def test_a_search_needs_four_poses() -> None:
    with pytest.raises(PlanError, match="at least 4 poses"):
        plan_search(bench(), poses=3)


def test_a_search_keeps_inside_narrow_j4_limits() -> None:
    plan = plan_search(bench(j4_limits_deg=(-180.0, 180.0)))
    assert all(-180.0 <= pose.j4_deg <= 180.0 for pose in plan.poses)
    with pytest.raises(PlanError, match=r"widen \[robot.limits_deg\] j4"):
        plan_search(bench(j4_limits_deg=(-20.0, 20.0)))


def solution(context: IdealContext) -> dict[str, tuple[float, float]]:
    places = context.stored["solve"]["reflectors"]
    assert isinstance(places, list)
    return {str(p["name"]): (p["x_mm"], p["y_mm"]) for p in places if isinstance(p, dict)}  # type: ignore[misc]  # plain JSON


def number(value: object) -> float:
    assert isinstance(value, float)
    return value


async def searched(context: IdealContext, base: ScaraBench | None = None, **params: float) -> IdealContext:
    procedure = ReflectorSearch()
    plan = procedure.plan(base or bench(), SearchParams.model_validate(params))
    await procedure.run(context, plan)
    await procedure.teardown(context)
    return context


async def test_a_search_finds_where_the_reflectors_really_are() -> None:
    context = await searched(IdealContext(places=TRUE_PLACES, theta40_deg=TRUE_THETA40))
    result = context.stored["solve"]
    assert number(result["theta40_deg"]) == pytest.approx(TRUE_THETA40, abs=0.003)
    for name, place in solution(context).items():
        assert math.dist(place, TRUE_PLACES[name]) < 0.15
    assert number(result["rms_deg"]) < 0.002
    assert [kind for kind, _ in context.events] == ["aim"]
    assert context.warnings == []
    assert len([row for table, row in context.rows if table == "search"]) == 24
    assert len(context.progressed) == 24
    done_s, total_s, _ = context.progressed[-1]
    assert done_s == total_s
    # A look takes some seconds, not one.
    assert 24 * 5.0 < total_s < 24 * 60.0


async def test_errors_of_the_aim_show_in_the_stated_uncertainty() -> None:
    errors = []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        wrong: dict[tuple[float, float], float] = {}

        def error(
            one: float,
            two: float,
            rng: np.random.Generator = rng,
            wrong: dict[tuple[float, float], float] = wrong,
        ) -> float:
            return wrong.setdefault((one, two), float(rng.normal(0.0, 0.01)))

        context = await searched(IdealContext(TRUE_PLACES, TRUE_THETA40, j4_error_deg=error))
        result = context.stored["solve"]
        u = number(result["u_theta40_deg"])
        assert 0.001 < u < 0.02
        errors.append((number(result["theta40_deg"]) - TRUE_THETA40) / u)
        places = result["reflectors"]
        assert isinstance(places, list)
        for place in places:
            assert isinstance(place, dict)
            x, y = TRUE_PLACES[str(place["name"])]
            errors.append((number(place["x_mm"]) - x) / number(place["u_x_mm"]))
            errors.append((number(place["y_mm"]) - y) / number(place["u_y_mm"]))
    assert 0.6 < float(np.sqrt(np.mean(np.square(errors)))) < 1.5


async def test_an_aim_that_would_not_hold_is_refused() -> None:
    context = IdealContext(
        TRUE_PLACES, TRUE_THETA40, j4_error_deg=lambda one, two: 0.6 * math.sin(37.0 * one + 11.0 * two)
    )
    with pytest.raises(ReflectorNotFoundError, match=r"mm only \(k = 2\).*param poses"):
        await searched(context)


async def test_a_reflector_that_is_missing_is_named_with_the_remedy() -> None:
    places = {name: place for name, place in TRUE_PLACES.items() if name != "P2"}
    context = IdealContext(places, TRUE_THETA40)
    with pytest.raises(
        ReflectorNotFoundError, match=r"reflector P2 was found from 0 pose\(s\), 3 are needed.*half_range_deg"
    ):
        await searched(context)
    assert len(context.warnings) == 8
    assert all("reflector P2 not found within ±" in text for text in context.warnings)


async def test_a_reflector_beyond_the_range_is_not_found() -> None:
    context = IdealContext(TRUE_PLACES, theta40_deg=12.0)
    with pytest.raises(ReflectorNotFoundError, match=r"reflector P\d was found from \d pose"):
        await searched(context)


async def test_a_wider_range_finds_a_beam_that_is_far_off() -> None:
    context = await searched(IdealContext(TRUE_PLACES, theta40_deg=-9.0), half_range_deg=12.0)
    assert number(context.stored["solve"]["theta40_deg"]) == pytest.approx(-9.0, abs=0.003)


async def test_a_search_respects_j4_limits_near_the_rough_aim() -> None:
    plan = plan_search(bench())
    limit = max(pose.j4_deg for pose in plan.poses) + 0.2
    base = bench(j4_limits_deg=(-360.0, limit))
    context = IdealContext(TRUE_PLACES, theta40_deg=-2.0, j4_limits_deg=(-360.0, limit))
    await searched(context, base)
    assert number(context.stored["solve"]["theta40_deg"]) == pytest.approx(-2.0, abs=0.01)


async def test_sightings_that_are_stored_are_not_looked_for_again() -> None:
    first = await searched(IdealContext(TRUE_PLACES, TRUE_THETA40))
    stored = {name: row for name, row in first.stored.items() if name != "solve"}
    again = await searched(IdealContext(TRUE_PLACES, TRUE_THETA40, stored=dict(stored)))
    assert again.ran == ["solve"]
    assert again.moves == []
    assert again.stored["solve"] == first.stored["solve"]


async def test_the_aim_limit_includes_the_planned_miss() -> None:
    def error(one: float, two: float) -> float:
        return 0.02 * math.sin(37.0 * one + 11.0 * two)

    context = await searched(IdealContext(TRUE_PLACES, TRUE_THETA40, j4_error_deg=error), most_poses=8)
    worst = number(context.events[0][1]["worst_uncertainty_mm"])
    room = 1.0 - 2.0 * worst
    assert 0.2 < room < 1.0
    tight = with_optics(bench(), max_miss_mm=room + 0.01)
    with pytest.raises(ReflectorNotFoundError, match="lower max_miss_mm"):
        await searched(IdealContext(TRUE_PLACES, TRUE_THETA40, j4_error_deg=error), tight, most_poses=8)
    loose = with_optics(bench(), max_miss_mm=room - 0.01)
    await searched(IdealContext(TRUE_PLACES, TRUE_THETA40, j4_error_deg=error), loose, most_poses=8)


def test_a_single_reflector_can_be_searched() -> None:
    alone = replace(bench(), reflectors=bench().reflectors[1:2])
    assert len(plan_search(alone).poses) == 8
