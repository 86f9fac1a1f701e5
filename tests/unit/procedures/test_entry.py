"""The way in from anywhere: free, inside the limits, and from the point's own sides."""

import math
from itertools import pairwise

import numpy as np
import pytest

from catseye.drivers.roles.pose import Pose, is_at
from catseye.procedures.kit.errors import WayBlockedError
from catseye.procedures.scara.beam.re_aim import AimCorrection
from catseye.procedures.scara.motion.entry import approach, way_in
from catseye.procedures.scara.open_loop.open_loop import OpenLoop
from catseye.procedures.scara.open_loop.open_loop_plan import plan_open_loop
from tests.unit.procedures.benches import PLACES, arm_xy, bench, miss_along
from tests.unit.procedures.troubles import TroubledContext

NODES = (-40.0, -20.0), (20.0, 40.0, 60.0)


def nearest_mm(way: tuple[Pose, ...], place: tuple[float, float]) -> float:
    """Return how near the J4 axis comes to a place."""
    return min(
        math.dist(arm_xy(a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])), place)
        for a, b in pairwise(way)
        for share in np.linspace(0.0, 1.0, 200)
    )


@pytest.mark.parametrize("place", [0, 7, 14, 23])
def test_a_point_is_approached_from_its_directions_while_aimed(place: int) -> None:
    paper = bench(*NODES)
    (part,) = plan_open_loop(paper, reflectors=("P2",)).reflectors
    visit = part.visits[place]
    take_up, node = approach(visit, paper, part.reflector)
    command = visit.command
    assert node == visit.node
    assert (node[0] - take_up[0], node[1] - take_up[1]) == pytest.approx(
        (command.direction1, command.direction2)
    )
    assert float(miss_along(take_up, take_up, PLACES["P2"], 1)[0]) < 1e-9
    assert abs(take_up[3] - node[3]) < 10.0


def test_at_a_j4_limit_the_take_up_is_unaimed() -> None:
    wide = plan_open_loop(bench(*NODES), reflectors=("P2",)).reflectors[0]
    visit = wide.visits[0]
    aimed, node = approach(visit, bench(*NODES), wide.reflector)
    low, high = sorted((node[3], 0.5 * (aimed[3] + node[3])))
    tight = bench(*NODES, j4_limits_deg=(low, high))
    assert approach(visit, tight, wide.reflector)[0][3] == node[3]


def test_a_free_way_is_driven_straight() -> None:
    target: Pose = (-41.0, 19.0, 12.5, 40.0)
    assert way_in((10.0, 50.0, 12.5, 0.0), target, bench()) == (target,)


def test_j3_goes_to_its_height_before_the_arm_turns() -> None:
    target: Pose = (-41.0, 19.0, 12.5, 40.0)
    way = way_in((10.0, 50.0, -80.0, 7.0), target, bench())
    assert way == ((10.0, 50.0, 12.5, 7.0), target)


def test_a_reflector_in_the_way_is_gone_round() -> None:
    obstacle = arm_xy(0.0, 0.0)
    paper = bench(places={"P1": PLACES["P1"], "near": (obstacle[0] + 20.0, obstacle[1])})
    here, target = (-30.0, 0.0, 12.5, 0.0), (30.0, 0.0, 12.5, 50.0)
    assert nearest_mm((here, target), (obstacle[0] + 20.0, obstacle[1])) < 50.0
    way = way_in(here, target, paper)
    assert way[-1] == target
    assert len(way) == 3
    assert nearest_mm((here, *way), (obstacle[0] + 20.0, obstacle[1])) >= 50.0


def test_a_blocked_way_in_names_the_obstacle_and_remedy() -> None:
    here: Pose = (-30.0, 0.0, 12.5, 0.0)
    x, y = arm_xy(*here[:2])
    paper = bench(places={"P1": PLACES["P1"], "near": (x + 20.0, y)})
    with pytest.raises(WayBlockedError) as caught:
        way_in(here, (30.0, 0.0, 12.5, 50.0), paper)
    assert "reflector near" in str(caught.value)
    assert "Jog the arm to where its way is free" in str(caught.value)


def test_an_arm_outside_its_limits_is_not_lifted() -> None:
    with pytest.raises(WayBlockedError, match="jog it inside them first"):
        way_in((175.0, 0.0, -50.0, 0.0), (30.0, 0.0, 12.5, 50.0), bench())


def test_rounding_of_encoders_is_no_jog() -> None:
    assert is_at((1.0, 2.0, 12.5, 4.0), (1.005, 1.99, 12.49, 4.005))
    assert not is_at((1.0, 2.0, 12.5, 4.0), (1.0, 2.0, 12.5, 4.2))


@pytest.mark.parametrize("start", [(150.0, -120.0, 12.5, 300.0), (60.0, 140.0, 12.5, -200.0)])
async def test_a_measurement_begins_wherever_the_arm_stands(start: Pose) -> None:
    context = TroubledContext(pose=start)
    plan = plan_open_loop(bench(*NODES), reflectors=("P2",))
    await OpenLoop().run(context, plan)
    assert len([row for table, row in context.rows if table == "points"]) == 24
    assert context.zeros == 1
    places = list(PLACES.values())
    assert all(nearest_mm((start, *context.moves[:4]), place) > 50.0 for place in places)


async def test_a_resumed_run_enters_its_point_with_take_up() -> None:
    plan = plan_open_loop(bench(*NODES), reflectors=("P2",))
    whole = TroubledContext()
    await OpenLoop().run(whole, plan)
    kept = dict(list(whole.stored.items())[:10])
    later = TroubledContext(stored=kept, pose=(100.0, 100.0, 12.5, 0.0), resumed=True)
    await OpenLoop().run(later, plan)
    visit = plan.reflectors[0].visits[10]
    assert later.moves[1] == visit.node
    command = visit.command
    came_from = (later.moves[1][0] - later.moves[0][0], later.moves[1][1] - later.moves[0][1])
    assert came_from == pytest.approx((command.direction1, command.direction2))


def test_an_aim_offset_survives_one_restart_only() -> None:
    aim = AimCorrection()
    aim.found(0.10, half_window_deg=0.08)
    assert aim.applied((0.0, 0.0, 0.0, 5.0), (-10.0, 10.0))[3] == pytest.approx(5.10)
    aim.restart()
    assert aim.present_deg == pytest.approx(0.10)
    aim.restart()
    assert aim.present_deg == 0.0


def test_an_offset_that_two_scans_found_is_kept() -> None:
    aim = AimCorrection()
    aim.found(0.10, half_window_deg=0.08)
    aim.found(0.11, half_window_deg=0.08)
    aim.restart()
    aim.restart()
    assert aim.present_deg == pytest.approx(0.11)
    aim.found(-0.30, half_window_deg=0.08)
    aim.restart()
    aim.restart()
    assert aim.present_deg == pytest.approx(0.11)


def test_an_offset_never_leads_j4_beyond_its_limits() -> None:
    aim = AimCorrection()
    aim.found(0.5, half_window_deg=0.08)
    assert aim.applied((0.0, 0.0, 0.0, 9.8), (-10.0, 10.0)) == (0.0, 0.0, 0.0, 9.8)
