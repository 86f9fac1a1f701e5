"""The bodies of the arm keep clear of each other and of what stands around: ways judged by an oracle."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.kinematics.bodies import Box
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.motion.clear_way import (
    clear_part,
    clear_ways,
    legs_refusal,
    require_clear_way,
    way_refusal,
)
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.open_loop.open_loop_plan import plan_open_loop
from catseye.procedures.scara.path.path_plan import plan_path
from tests.unit.procedures.benches import arm_xy, bench, with_axes
from tests.unit.procedures.collision_trial import tried

HOME: Pose = (0.0, 0.0, 12.5, 0.0)


def wide_j2() -> ScaraBench:
    """Return a bench whose J2 may turn far beyond that of the paper's arm."""
    return with_axes(bench(), j2_deg=(-178.0, 178.0))


@pytest.mark.parametrize("j2_deg", [175.0, -175.0])
def test_an_arm_folded_onto_its_column_is_refused(j2_deg: float) -> None:
    assert np.hypot(*arm_xy(0.0, j2_deg)) == pytest.approx(103.0, abs=0.5)
    with pytest.raises(PlanError) as caught:
        require_clear_way([HOME, (0.0, j2_deg, 12.5, 0.0)], wide_j2())
    assert "the base column stands in the arm's way: the link 2 runs into it" in str(caught.value)
    assert f"target 1 of 1, J1 0.0°, J2 {j2_deg:.1f}°" in str(caught.value)


def test_a_plan_with_such_a_node_is_refused() -> None:
    folded = replace(wide_j2(), nodes2_deg=(0.0, 90.0, 160.0))
    with pytest.raises(PlanError, match="base column stands in the arm's way"):
        plan_open_loop(folded, reflectors=("P2",))


def test_the_papers_plan_and_path_are_clear() -> None:
    plan = plan_open_loop(bench())
    assert plan.n_points > 1000
    assert len(plan_path(bench(), y_from_mm=-420.0, y_to_mm=420.0).points) == 170


def test_a_box_between_two_targets_is_found_with_its_distance() -> None:
    x, y = arm_xy(20.0, 0.0)
    box = Box("press", (x - 1.0, y - 1.0, 0.0), (x + 1.0, y + 1.0, 300.0))
    boxed = replace(bench(), workspace=replace(bench().workspace, keep_out=(box,)))
    ends: list[Pose] = [HOME, (40.0, 0.0, 12.5, 0.0)]
    assert all(way_refusal([end], boxed) is None for end in ends)
    refusal = way_refusal(ends, boxed)
    assert refusal is not None
    assert "the keep-out box press stands in the arm's way" in refusal


def test_many_ways_are_judged_as_each_by_itself() -> None:
    x, y = arm_xy(20.0, 0.0)
    box = Box("press", (x - 1.0, y - 1.0, 0.0), (x + 1.0, y + 1.0, 300.0))
    workspace = replace(bench().workspace, keep_out=(box,))
    drawn = np.random.default_rng(3).uniform(
        (-90.0, -120.0, 0.0, -90.0), (90.0, 120.0, 25.0, 90.0), (120, 3, 4)
    )
    ways = [[tuple(pose) for pose in way] for way in drawn.tolist()]
    # Benches that are equal remember each other's clear legs.
    each = [way_refusal(way, replace(bench(), workspace=workspace)) is None for way in ways]
    other = replace(workspace, clearance_mm=workspace.clearance_mm + 1e-9)
    assert 20 < sum(each) < 100
    assert clear_ways(ways, replace(bench(), workspace=other)) == each
    assert clear_ways([], bench()) == []


def test_a_distance_below_the_clearance_is_given_in_mm() -> None:
    tall = replace(bench().workspace, table_z_mm=128.5)
    refusal = way_refusal([HOME, (5.0, 0.0, 12.5, 0.0)], replace(bench(), workspace=tall))
    assert refusal is not None
    assert (
        "the table stands in the arm's way: the interferometer head comes within 4.0 mm (5 mm are kept"
        in refusal
    )
    assert "teach pendant" in refusal


def test_the_head_is_checked_where_j4_turns_it() -> None:
    beside = bench(places={"near": (550.0, 72.0), "far": (900.0, 0.0)})
    turned: Pose = (0.0, 0.0, 12.5, -90.0)
    assert way_refusal([HOME, (0.0, 0.0, 12.5, 90.0)], beside) is None
    assert way_refusal([HOME, turned], beside) is not None


def test_a_move_goes_as_far_as_it_is_clear() -> None:
    x, y = arm_xy(40.0, 0.0)
    walled = bench(places={"P1": (x, y)})
    end, obstacle = clear_part(HOME, (170.0, 0.0, 12.5, 0.0), walled)
    assert obstacle is not None
    assert "stand of reflector P1" in obstacle
    assert 30.0 < end[0] < 40.0
    assert way_refusal([HOME, end], walled) is None
    assert clear_part(HOME, (-90.0, 0.0, 12.5, 0.0), walled) == ((-90.0, 0.0, 12.5, 0.0), None)


def test_generated_ways_are_judged_as_the_oracle_does() -> None:
    outcome = tried(seed=11, count=40, check=legs_refusal)
    assert (outcome.collisions, outcome.needless, outcome.misnamed) == ([], [], [])
    assert outcome.accepted > 8
    assert outcome.refused > 8


def test_a_check_of_the_targets_alone_would_be_found_out() -> None:
    def at_targets(start: Pose, legs: Sequence[Sequence[Pose]], scene: ScaraBench) -> str | None:
        for number, target in enumerate([start, *(target for leg in legs for target in leg)]):
            if (text := way_refusal([target], scene)) is not None:
                return text.replace("to target 0 of", f"to target {max(number, 1)} of")
        return None

    assert tried(seed=11, count=40, check=at_targets).collisions != []


@pytest.mark.parametrize("j1_deg", [math.nan, math.inf, 1e9])
def test_joints_that_no_arm_has_are_refused(j1_deg: float) -> None:
    with pytest.raises(PlanError, match="is not a place of an arm"):
        way_refusal([(j1_deg, 0.0, 12.5, 0.0), HOME], bench())
