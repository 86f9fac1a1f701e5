"""Plans for arms that stop at sub-steps, round their corners, or are led through set points."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from catseye.drivers.roles.robot import Following
from catseye.procedures.kit.motion.motion_time import way_time_s
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.motion.visits import Visit
from catseye.procedures.scara.open_loop.open_loop_plan import plan_open_loop
from tests.unit.procedures.benches import PLACES, bench, miss_along, scara_axes


def following(way: Following) -> ScaraBench:
    """Return a slice of the paper's bench with an arm that follows in one of the ways."""
    base = bench(nodes1_deg=(-60.0, -40.0, -20.0), nodes2_deg=(20.0, 40.0), places={"P2": PLACES["P2"]})
    return replace(base, arm=replace(base.arm, following=way))


def visits(way: Following) -> tuple[Visit, ...]:
    """Return the visits to the reflector that can be followed."""
    return plan_open_loop(following(way)).reflectors[0].visits


def largest_miss_mm(way: Following) -> float:
    """Return the largest miss of the straight parts of all tracked legs, by trigonometry of the tests' own."""
    found = [
        float(miss_along(start, end, PLACES["P2"]).max())
        for before, visit in pairwise(visits(way))
        if visit.tracked
        for start, end in pairwise([before.moves[-1], *visit.moves])
    ]
    return max(found)


@pytest.mark.parametrize(("way", "limit_mm"), [("stops", 0.2), ("blended", 0.1), ("streamed", 0.005)])
def test_each_way_of_following_has_its_own_room_for_misses(way: Following, limit_mm: float) -> None:
    miss_mm = largest_miss_mm(way)
    assert 0.2 * limit_mm < miss_mm <= limit_mm + 1e-9


def test_a_leg_ends_where_the_arm_has_to_stand_still() -> None:
    for visit in visits("streamed"):
        for before, leg in pairwise(visit.legs):
            start, end = before[-1], leg[-1]
            share = np.linspace(0.0, 1.0, len(leg) + 1)[1:]
            straight = np.array(start[:2]) + share[:, None] * (np.array(end[:2]) - np.array(start[:2]))
            assert np.array([target[:2] for target in leg]) == pytest.approx(straight, abs=1e-9)


def test_all_ways_visit_the_same_nodes_in_the_same_poses() -> None:
    ends = [[visit.moves[-1] for visit in visits(way)] for way in ("stops", "blended", "streamed")]
    assert ends[0] == [pytest.approx(pose, abs=1e-9) for pose in ends[1]]
    assert ends[0] == [pytest.approx(pose, abs=1e-9) for pose in ends[2]]


def test_path_time_depends_on_how_it_is_driven() -> None:
    arm = replace(
        bench().arm,
        axes=scara_axes(speeds=(100.0,) * 3, accelerations=(100.0,) * 3),
        override_percent=10.0,
        follow_speed_deg_s=5.0,
        follow_acceleration_deg_s2=50.0,
    )
    poses = np.array([[0.0] * 4, [10.0, 0.0, 0.0, 0.0], [20.0, 0.0, 0.0, 0.0]])
    # Trapezoids of 10 deg/s and 100 deg/s²: twice 10/10 + 10/100 s, and once 20/10 + 10/100 s.
    assert way_time_s(replace(arm, following="stops"), poses) == pytest.approx(2.2)
    assert way_time_s(replace(arm, following="blended"), poses) == pytest.approx(2.1)
    # Led at 5 deg/s; a ramp that is a squared sine lasts pi/2 times as long as a straight one of 5/50 s.
    assert way_time_s(replace(arm, following="streamed"), poses) == pytest.approx(4.0 + 0.1 * np.pi / 2.0)
