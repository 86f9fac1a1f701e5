"""The beam level: heights at several distances, what hands are asked to do, and the height to measure at."""

import math
from dataclasses import replace

import numpy as np
import pytest

from catseye.procedures.kit.errors import AlignmentError, BeamLostError, PlanError
from catseye.procedures.kit.tasks import TurnScrew
from catseye.procedures.scara.alignment.beam_level import BeamLevel, BeamLevelParams, BeamLevelPlan
from catseye.procedures.scara.bench import ScaraBench
from tests.unit.procedures.benches import NODES1_DEG, NODES2_DEG, PLACES, arm_xy, bench
from tests.unit.procedures.mounts import MountContext, mounted_bench


def planned(base: ScaraBench | None = None, **params: object) -> BeamLevelPlan:
    return BeamLevel().plan(base or mounted_bench(), BeamLevelParams.model_validate(params))


async def levelled(context: MountContext, base: ScaraBench | None = None, **params: object) -> MountContext:
    procedure = BeamLevel()
    await procedure.run(context, planned(base, **params))
    await procedure.teardown(context)
    return context


def test_poses_lie_at_different_distances_to_one_reflector() -> None:
    plan = planned()
    assert len({pose.reflector.name for pose in plan.poses}) == 1
    place = PLACES[plan.poses[0].reflector.name]
    lengths = [math.dist(arm_xy(pose.theta1_deg, pose.theta2_deg), place) for pose in plan.poses]
    assert lengths == pytest.approx([pose.beam_mm for pose in plan.poses])
    assert lengths[0] >= 200.0
    assert np.all(np.diff(lengths) > 100.0)
    assert planned(reflector="P1").poses[0].reflector.name == "P1"
    assert len(planned(poses=2).poses) == 2


@pytest.mark.parametrize("pitch", [1.3, -1.3, 4.0])
async def test_the_pitch_is_taken_away_in_one_turn(pitch: float) -> None:
    context = await levelled(MountContext(pitch_mrad=pitch, height_mm=50.4, offset_mm=0.4, theta40_deg=1.2))
    assert abs(context.pitch_mrad) < 0.1
    assert [screw for screw, _ in context.turned] == ["level"]
    rows = [dict(row) for table, row in context.rows if table == "records" and row["kind"] == "alignment"]
    assert rows[0]["value"] == pytest.approx(pitch, rel=0.03, abs=0.05)
    assert rows[0]["unit"] == "mrad"
    assert rows[0]["quantity"] == "pitch of the beam"


async def test_j3_is_brought_back_or_its_height_given() -> None:
    base = mounted_bench()
    context = await levelled(MountContext(pitch_mrad=1.3, height_mm=50.4))
    assert context.moves[-1][2] == context.pose[2] == base.j3_mm
    assert {move[2] for move in context.moves} - {base.j3_mm}
    assert not any("J3 stands" in text for text in context.warnings)
    # A run that ends early cannot move any more: it says where J3 belongs.
    procedure, dark = BeamLevel(), MountContext(pitch_mrad=1.3, blocked=lambda _pose: True)
    with pytest.raises(BeamLostError, match="turn the level screw back"):
        await procedure.run(dark, planned())
    await procedure.teardown(dark)
    assert any(f"another height than j3_mm = {base.j3_mm:g}" in text for text in dark.warnings)


async def test_the_instruction_gives_up_or_down_and_turns() -> None:
    context = await levelled(MountContext(pitch_mrad=1.0))
    (prompt,) = context.prompts
    assert prompt.id == "level/1"
    # The beam rises by about 1 mrad; one turn clockwise lifts it by 2 mrad.
    assert prompt.text.startswith("Tilt the beam 1.0") or prompt.text.startswith("Tilt the beam 0.9")
    assert " mrad down, 0." in prompt.text
    assert prompt.text.endswith(" turns anticlockwise, then confirm.")
    assert isinstance(prompt.task, TurnScrew)
    assert prompt.task.screw == "level"
    assert prompt.task.turns == pytest.approx(-0.5, abs=0.03)
    down = mounted_bench(level_clockwise="down")
    other = await levelled(MountContext(pitch_mrad=1.0, level_mrad=-2.0), down)
    assert other.prompts[0].text.endswith(" turns clockwise, then confirm.")


def seen_lengths() -> list[float]:
    """Return the lengths of all beams from nodes to reflectors that clear the column, as the test sees it."""
    lengths = []
    for place in PLACES.values():
        for one in NODES1_DEG:
            for two in NODES2_DEG:
                x, y = arm_xy(one, two)
                dx, dy = place[0] - x, place[1] - y
                share = min(1.0, max(0.0, -(x * dx + y * dy) / (dx * dx + dy * dy)))
                if math.hypot(x + share * dx, y + share * dy) > 115.0:
                    facing = math.atan2(-place[1], -place[0])
                    off = math.degrees(math.atan2(-dy, -dx) - facing)
                    if abs((off + 180.0) % 360.0 - 180.0) <= 80.0:
                        lengths.append(math.hypot(dx, dy))
    return lengths


async def test_the_height_to_measure_at_is_given() -> None:
    context = await levelled(MountContext(pitch_mrad=0.1, height_mm=51.3))
    lengths = seen_lengths()
    middle = 0.5 * (min(lengths) + max(lengths))
    result = context.stored["result"]
    assert result["j3_mm"] == pytest.approx(51.3 - 1e-4 * middle, abs=0.03)
    assert "set j3_mm = 51.2" in context.warnings[-1]
    assert "the cell file has 50" in context.warnings[-1]


async def test_a_height_that_is_right_is_not_warned_about() -> None:
    context = await levelled(MountContext(pitch_mrad=0.0, height_mm=50.0))
    assert context.warnings == []
    assert context.stored["result"]["j3_mm"] == pytest.approx(50.0, abs=0.02)
    assert [kind for kind, _ in context.events] == ["height"]


async def test_a_beam_far_from_its_configured_height_is_found() -> None:
    context = await levelled(MountContext(pitch_mrad=-2.0, height_mm=44.0))
    assert abs(context.pitch_mrad) < 0.1
    assert context.stored["result"]["j3_mm"] == pytest.approx(44.0, abs=0.2)


async def test_j3_keeps_inside_its_range() -> None:
    context = await levelled(MountContext(pitch_mrad=3.0, height_mm=46.0))
    heights = [move[2] for move in context.moves]
    assert min(heights) >= 40.0
    assert max(heights) <= 60.0


async def test_only_one_joint_group_moves_at_a_time() -> None:
    context = await levelled(MountContext(pitch_mrad=1.0, pose=(0.0, 0.0, 50.0, 0.0)))
    poses = {(pose.theta1_deg, pose.theta2_deg) for pose in planned().poses}
    assert {move[:2] for move in context.moves} == poses


@pytest.mark.parametrize(("height", "end"), [(59.5, "above 60"), (40.5, "below 40")])
async def test_a_window_cut_off_by_j3s_range_is_refused(height: float, end: str) -> None:
    with pytest.raises(AlignmentError, match=rf"{end} mm.*widen j3_range_mm"):
        await levelled(MountContext(height_mm=height))


async def test_a_beam_that_never_returns_names_what_to_check() -> None:
    with pytest.raises(BeamLostError, match=r"at any height of J3 from 40 to 60 mm.*half_range_deg"):
        await levelled(MountContext(height_mm=75.0))


async def test_a_reversed_screw_is_noticed() -> None:
    context = await levelled(MountContext(pitch_mrad=1.0, level_mrad=-2.0))
    assert abs(context.pitch_mrad) < 0.1
    assert [prompt.id for prompt in context.prompts] == ["level/1", "level-sense/1", "level/2"]
    assert 'level_clockwise = "down"' in context.warnings[0]


def test_what_cannot_be_planned() -> None:
    with pytest.raises(PlanError, match="set j3_range_mm in"):
        planned(bench())
    with pytest.raises(PlanError, match="reflector P9 is not in the cell file"):
        planned(reflector="P9")
    narrow = replace(mounted_bench(), nodes1_deg=(0.0, 1.0), nodes2_deg=(20.0, 21.0))
    with pytest.raises(
        PlanError, match=r"cannot be seen alone from 3 distances that lie 100 mm or more apart"
    ):
        planned(narrow)
    with pytest.raises(PlanError, match="cannot be seen alone"):
        planned(replace(mounted_bench(), reflectors=()))
