"""The planned measurement, checked move by move with trigonometry of its own."""

import copy
import math
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.errors import PlanError, PlanLimitError
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.open_loop.open_loop import OpenLoop, OpenLoopParams
from catseye.procedures.scara.open_loop.open_loop_plan import OpenLoopPlan, ReflectorPlan, plan_open_loop
from tests.unit.procedures.benches import (
    PLACES,
    arm_xy,
    bench,
    clearance_mm,
    miss_along,
    with_optics,
)


@cache
def papers_plan() -> OpenLoopPlan:
    return plan_open_loop(bench())


def legs(part: ReflectorPlan, tracked: bool) -> list[tuple[Pose, Pose]]:
    """Return the straight moves of the visits that keep the beam, or of all."""
    found: list[tuple[Pose, Pose]] = []
    for before, visit in pairwise(part.visits):
        if visit.tracked or not tracked:
            found += pairwise([before.moves[-1], *visit.moves])
    return found


def between(start: Pose, end: Pose, share: float) -> tuple[float, float]:
    return start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])


def can_be_seen(one_deg: float, two_deg: float, reflector: Reflector, column_mm: float) -> bool:
    here, there = arm_xy(one_deg, two_deg), (reflector.x_mm, reflector.y_mm)
    arriving = math.degrees(math.atan2(here[1] - there[1], here[0] - there[0]))
    off = abs((arriving - reflector.facing_deg + 180.0) % 360.0 - 180.0)
    return clearance_mm(here, there) > column_mm and off <= 80.0 and 50.0 <= math.dist(here, there) <= 5000.0


def targets_a_point(plan: OpenLoopPlan) -> float:
    return sum(len(visit.moves) for part in plan.reflectors for visit in part.visits) / plan.n_points


def test_the_papers_layout_in_figures() -> None:
    plan = papers_plan()
    assert [part.reflector.name for part in plan.reflectors] == ["P1", "P2", "P3"]
    for part in plan.reflectors:
        assert len(part.visits) + len(part.blind) == 352
        assert 0.0 <= len(part.blind) / 352 <= 0.035
    assert plan.n_points == sum(len(part.visits) for part in plan.reflectors)
    assert 3.0 <= targets_a_point(plan) <= 4.5
    # Half a millimetre of miss takes about 2.4 targets a move, and each of 44 sweeps takes up once more.
    coarse = plan_open_loop(with_optics(bench(), max_miss_mm=0.5))
    assert 2.2 <= targets_a_point(coarse) <= 3.2


@pytest.mark.parametrize("index", range(3))
def test_the_beam_stays_on_the_reflector_between_the_points_too(index: int) -> None:
    part = papers_plan().reflectors[index]
    worst = 0.0
    for start, end in legs(part, tracked=True):
        worst = max(worst, float(miss_along(start, end, PLACES[part.reflector.name]).max()))
    assert worst <= 0.2005
    assert worst > 0.1


def test_a_visits_stated_miss_is_that_of_its_moves() -> None:
    part = papers_plan().reflectors[0]
    for before, visit in pairwise(part.visits):
        if not visit.tracked:
            assert math.isnan(visit.miss_mm)
            continue
        own = max(miss_along(a, b, PLACES["P1"]).max() for a, b in pairwise([before.moves[-1], *visit.moves]))
        assert visit.miss_mm == pytest.approx(own, rel=0.02, abs=1e-9)


def test_every_target_is_aimed_and_has_its_stated_length() -> None:
    for part in papers_plan().reflectors:
        place = PLACES[part.reflector.name]
        for visit in part.visits:
            for target in visit.moves:
                assert float(miss_along(target, target, place, 1)[0]) < 1e-9
                assert target[2] == 12.5
            assert visit.beam_mm == pytest.approx(math.dist(arm_xy(*visit.moves[-1][:2]), place))


def test_a_visit_ends_at_its_node() -> None:
    for part in papers_plan().reflectors:
        for visit in part.visits:
            node = (visit.command.theta1_deg, visit.command.theta2_deg)
            assert visit.moves[-1][:2] == pytest.approx(node, abs=1e-9)


def test_j4_keeps_its_limits_without_jumps_while_tracking() -> None:
    for part in papers_plan().reflectors:
        angles = [target[3] for visit in part.visits for target in visit.moves]
        assert min(angles) >= -360.0
        assert max(angles) <= 360.0
        # Straight at the reflector from close by, J4 may turn fast, but never by a large part of a turn.
        assert max(abs(b[3] - a[3]) for a, b in legs(part, tracked=True)) < 60.0


def test_every_tracked_leg_keeps_the_line_of_sight_free() -> None:
    for part in papers_plan().reflectors:
        for start, end in legs(part, tracked=True):
            for share in np.linspace(0.0, 1.0, 21):
                assert can_be_seen(*between(start, end, float(share)), part.reflector, 114.0)


def test_blind_commands_are_exactly_those_without_sight() -> None:
    for part in papers_plan().reflectors:
        assert len(part.blind) + len(part.visits) == 352
        for command in part.blind:
            assert not can_be_seen(command.theta1_deg, command.theta2_deg, part.reflector, 115.0)
        for visit in part.visits:
            assert can_be_seen(visit.command.theta1_deg, visit.command.theta2_deg, part.reflector, 115.0)


def test_a_leg_is_untracked_only_where_sight_is_interrupted() -> None:
    for part in papers_plan().reflectors:
        assert not part.visits[0].tracked
        for before, visit in pairwise(part.visits):
            stops = [before.moves[-1], *visit.moves]
            free = all(
                can_be_seen(*between(a, b, float(share)), part.reflector, 115.0)
                for a, b in pairwise(stops)
                for share in np.linspace(0.0, 1.0, 101)
            )
            if visit.tracked:
                assert visit.command.index == before.command.index + 1
            else:
                assert not free
        assert part.planned_breaks == sum(not visit.tracked for visit in part.visits) - 1


def test_warnings_name_the_blind_commands_and_the_breaks() -> None:
    plan = papers_plan()
    for part in plan.reflectors:
        texts = [text for text in plan.warnings if part.reflector.name in text]
        assert any(f"{len(part.blind)} commands are blind" in text for text in texts) == bool(part.blind)
        assert any(f"{part.planned_breaks} time(s)" in text for text in texts) == bool(part.planned_breaks)


def test_without_subdivision_the_beam_would_be_missed_by_millimetres() -> None:
    plan = plan_open_loop(bench(), subdivide=False)
    for part in plan.reflectors:
        own = [float(miss_along(a, b, PLACES[part.reflector.name]).max()) for a, b in legs(part, True)]
        stated = [visit.miss_mm for visit in part.visits if visit.tracked]
        assert 1.9 < float(np.median(stated)) < 3.1
        assert 10.0 < max(stated) < 35.0
        assert max(own) == pytest.approx(max(stated), rel=0.02)


def test_without_take_up_each_visit_is_one_straight_way() -> None:
    plan = plan_open_loop(bench(), subdivide=False, take_up=False, reflectors=("P2",))
    (part,) = plan.reflectors
    assert len(part.visits) + len(part.blind) == 352
    assert all(len(visit.moves) == 1 for before, visit in pairwise(part.visits) if visit.tracked)


def test_chosen_reflectors_keep_the_order_of_the_choice() -> None:
    plan = OpenLoop().plan(bench(), OpenLoopParams(reflectors=["P3", "P1"]))
    assert [part.reflector.name for part in plan.reflectors] == ["P3", "P1"]


def test_planning_is_pure() -> None:
    given = bench()
    before = copy.deepcopy(given)
    first, second = plan_open_loop(given, reflectors=("P1",)), plan_open_loop(given, reflectors=("P1",))
    assert given == before
    assert repr(first) == repr(second)


def test_the_zero_direction_of_the_beam_turns_j4_against_it() -> None:
    nodes = ((-40.0, -20.0), (20.0, 40.0))
    straight = plan_open_loop(bench(*nodes), reflectors=("P2",))
    turned = plan_open_loop(with_optics(bench(*nodes), theta40_deg=7.5), reflectors=("P2",))
    for a, b in zip(straight.reflectors[0].visits, turned.reflectors[0].visits, strict=True):
        assert b.moves[-1][3] == pytest.approx(a.moves[-1][3] - 7.5, abs=1e-9)


def narrow() -> ScaraBench:
    return bench(j4_limits_deg=(-180.0, 180.0))


def test_narrow_j4_limits_make_a_planned_break_where_j4_rewinds() -> None:
    wide, tight = papers_plan(), plan_open_loop(narrow())
    for part, free in zip(tight.reflectors, wide.reflectors, strict=True):
        angles = [target[3] for visit in part.visits for target in visit.moves]
        assert min(angles) >= -180.0
        assert max(angles) <= 180.0
        assert {c.index for c in part.blind} == {c.index for c in free.blind}
        assert max(abs(b[3] - a[3]) for a, b in legs(part, tracked=True)) < 60.0
        for start, end in legs(part, tracked=True):
            assert float(miss_along(start, end, PLACES[part.reflector.name], 20).max()) <= 0.2005
    # World direction about 0, θ1 + θ2 from -140° to 200°: J4 needs more than one turn over the grid.
    assert sum(p.planned_breaks for p in tight.reflectors) > sum(p.planned_breaks for p in wide.reflectors)
    jumps = [
        abs(b.moves[0][3] - a.moves[-1][3])
        for part in tight.reflectors
        for a, b in pairwise(part.visits)
        if not b.tracked
    ]
    assert max(jumps) > 180.0


def test_j4_limits_that_no_branch_fits_are_refused() -> None:
    with pytest.raises(PlanLimitError, match=r"widen \[robot.limits_deg\] j4 or move the reflector"):
        plan_open_loop(bench(j4_limits_deg=(-60.0, 60.0)))


@pytest.mark.parametrize(
    ("place", "parts"),
    [
        ((-200.0, 0.0), ["reflector P1", "can be seen from only", "base column", "put the reflector"]),
        ((100.0, 0.0), ["reflector P1", "field", "correct its place in the cell file"]),
        ((9000.0, 0.0), ["can be seen from only 0 of 352", "beam's range (50…5000 mm)"]),
    ],
)
def test_a_reflector_that_few_commands_see_is_refused(place: tuple[float, float], parts: list[str]) -> None:
    with pytest.raises(PlanError) as caught:
        plan_open_loop(bench(places={"P1": place}))
    for part in parts:
        assert part in str(caught.value)


@pytest.mark.parametrize("place", [(300.0, 100.0), (340.0, -420.0), (0.0, -540.0)])
def test_a_visible_reflector_in_the_arms_way_is_refused(place: tuple[float, float]) -> None:
    nodes = [(one, two) for one in bench().nodes1_deg for two in np.linspace(0.0, 140.0, 141)]
    assert min(math.dist(arm_xy(*node), place) for node in nodes) < 50.0
    with pytest.raises(PlanError) as caught:
        plan_open_loop(bench(places={"P1": (650.0, -400.0), "P2": place}), reflectors=("P1",))
    assert "reflector P2" in str(caught.value)
    assert "stands in the arm's way" in str(caught.value)
    assert "out of the arm's reach" in str(caught.value)


def test_a_reflector_that_cannot_be_followed_closely_enough_is_refused() -> None:
    # The arm passes the reflector in 12 mm; the beam turns by half a turn there.
    passing = bench((-20.0, 20.0), (0.0, 10.0), {"P1": (562.0, 0.0)})
    close = with_optics(passing, beam_min_mm=1.0, max_miss_mm=1e-6)
    with pytest.raises(PlanError, match=r"reflector P1 cannot be kept within 1e-06 mm .* raise max_miss_mm"):
        plan_open_loop(close)


def test_an_unknown_reflector_is_named_with_those_that_are_known() -> None:
    with pytest.raises(PlanError, match=r"reflector P9 is not in the cell file; known: P1, P2, P3"):
        plan_open_loop(bench(), reflectors=("P9",))


def test_a_take_up_beyond_the_limits_is_refused() -> None:
    with pytest.raises(PlanLimitError, match=r"take-up position before a node needs J2 = -145\.2°"):
        plan_open_loop(bench((0.0, 20.0), (-144.2, 0.0)))


def test_the_expected_time_is_motion_settling_and_dwell() -> None:
    plan = plan_open_loop(bench((0.0, 20.0), (40.0, 60.0)), reflectors=("P1",), subdivide=False)
    assert plan.duration_s == pytest.approx(sum(v.duration_s for v in plan.reflectors[0].visits))
    for before, visit in pairwise(plan.reflectors[0].visits):
        motion = 0.0
        for start, end in pairwise([before.moves[-1], *visit.moves]):
            times = []
            for n, top, ramp in ((0, 420.0, 2000.0), (1, 720.0, 4000.0), (3, 3000.0, 15000.0)):
                way, speed = abs(end[n] - start[n]), 0.2 * top
                peak = min(speed, math.sqrt(way * ramp))
                # Ramp up to the peak, cruise over what is left, ramp down.
                times.append(2 * peak / ramp + (way - peak**2 / ramp) / peak if way else 0.0)
            motion += max(times)
        assert visit.duration_s == pytest.approx(motion + 0.5 + 0.25)


def test_the_bench_aims_at_what_a_search_found() -> None:
    aimed = bench().aimed({"P1": (655.0, -402.0)}, 1.25)
    assert (aimed.reflectors[0].x_mm, aimed.reflectors[0].y_mm) == (655.0, -402.0)
    assert aimed.reflectors[1:] == bench().reflectors[1:]
    assert aimed == replace(
        aimed,
        optics=replace(bench().optics, theta40_deg=1.25),
        arm=bench().arm,
        nodes1_deg=bench().nodes1_deg,
    )
