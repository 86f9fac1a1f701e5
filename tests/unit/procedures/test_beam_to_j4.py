"""The beam to the J4 axis: what is measured, what hands are asked, and what is noticed when they do otherwise."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from catseye.procedures.kit.errors import (
    AlignmentError,
    BeamLostError,
    NoBeamError,
    NotPlacedError,
    PlanError,
    PlanLimitError,
)
from catseye.procedures.kit.tasks import ClearBeam, PlaceReflector, TurnScrew
from catseye.procedures.scara.alignment.beam_to_j4 import BeamToJ4, BeamToJ4Params, BeamToJ4Plan
from catseye.procedures.scara.alignment.screws import Observed, Screw, respond
from catseye.procedures.scara.bench import Reflector, ScaraBench
from tests.unit.procedures.benches import PLACES, arm_xy, bench, with_optics
from tests.unit.procedures.mounts import MountContext, mounted_bench


def planned(base: ScaraBench | None = None, **params: object) -> BeamToJ4Plan:
    return BeamToJ4().plan(base or mounted_bench(), BeamToJ4Params.model_validate(params))


async def aligned(context: MountContext, base: ScaraBench | None = None, **params: object) -> MountContext:
    procedure = BeamToJ4()
    await procedure.run(context, planned(base, **params))
    await procedure.teardown(context)
    return context


def records(context: MountContext, kind: str) -> list[dict[str, object]]:
    return [dict(row) for table, row in context.rows if table == "records" and row["kind"] == kind]


def test_the_pose_is_the_nearest_that_leaves_room() -> None:
    plan = planned()
    assert plan.pose.reflector.name == "P2"
    # At full stretch towards P2 the J4 axis stands at x = 550 mm; poses are chosen from a grid.
    assert 680.0 - 550.0 <= plan.pose.beam_mm < 140.0
    assert planned(reflector="P3").pose.reflector.name == "P3"
    far = planned(with_optics(mounted_bench(), beam_min_mm=400.0))
    assert far.pose.beam_mm >= 430.0


def test_j4_turns_up_and_down_over_most_of_the_window() -> None:
    up, down = planned(turns=21).offsets
    assert up[0] == -0.8
    assert up[-1] == 0.8
    assert len(up) == 21
    assert down == up[::-1]


@pytest.mark.parametrize("offset", [0.83, -0.83, 2.4, -2.4])
async def test_the_offset_is_taken_away_in_one_turn(offset: float) -> None:
    context = await aligned(MountContext(offset_mm=offset))
    assert abs(context.offset_mm) < 0.03
    assert [screw for screw, _ in context.turned] == ["stage"]
    before, after = records(context, "alignment")
    assert before["value"] == pytest.approx(offset, abs=0.02)
    assert before["quantity"] == "offset of the beam from the J4 axis"
    assert before["unit"] == "mm"
    assert before["round"] == 1
    assert after["value"] == pytest.approx(context.offset_mm, abs=0.02)
    assert str(after["instruction"]).startswith("move the stage ")
    result = context.stored["result"]
    assert result["offset_mm"] == after["value"]
    assert result["u_mm"] == after["u"]
    assert "run reflector-search again" in context.warnings[-1]


async def test_the_instruction_gives_side_direction_and_turns() -> None:
    context = await aligned(MountContext(offset_mm=0.43, noise_mm=0.0))
    (prompt,) = context.prompts
    assert prompt.id == "stage/1"
    assert prompt.kind == "confirm"
    assert prompt.text == "Move the stage 0.43 mm towards −y, 0.86 turns anticlockwise, then confirm."
    assert prompt.task == TurnScrew(screw="stage", turns=-0.86)
    # Hands are at the mount: the arm moves after a "yes", so that it takes a key of its own.
    assert prompt.motion
    offsets = [live for live in context.shown if live.name == "offset of the beam from the J4 axis"]
    assert (offsets[0].low, offsets[0].high, offsets[0].unit) == (-0.1, 0.1, "mm")
    assert offsets[0].text == "move the stage 0.43 mm towards −y, 0.86 turns anticlockwise"
    assert not offsets[0].accepted
    assert offsets[-1].accepted
    assert offsets[-1].text == ""
    assert "signal" in {live.name for live in context.shown}
    (asked, *_) = (live for live in context.shown if live.name == "stage screw, turns to make")
    assert (asked.value, asked.unit) == (prompt.task.turns, "turns")
    assert asked.text.startswith("anticlockwise")


async def test_the_live_mark_is_the_verdict_with_u() -> None:
    # The offset lies within the tolerance of 0.1 mm, but not with its uncertainty: the screw is turned.
    context = await aligned(MountContext(offset_mm=0.095, noise_mm=0.0))
    assert context.prompts
    first = next(live for live in context.shown if live.name == "offset of the beam from the J4 axis")
    assert abs(first.value) < 0.1 < abs(first.value) + first.expanded
    assert not first.accepted
    assert first.text


async def test_a_stage_that_moves_the_other_way_clockwise() -> None:
    base = mounted_bench(stage_clockwise="-y", stage_mm_per_turn=0.25)
    context = await aligned(MountContext(offset_mm=0.44, stage_mm=-0.25, noise_mm=0.0), base)
    assert context.prompts[0].text == "Move the stage 0.44 mm towards −y, 1.76 turns clockwise, then confirm."
    assert abs(context.offset_mm) < 0.03


async def test_the_time_left_includes_manual_work_per_round() -> None:
    context = await aligned(MountContext(offset_mm=0.43), max_rounds=8)
    done_s, total_s, _ = context.progressed[0]
    assert done_s / total_s == 1 / 8
    # Somebody walks to the screw and back: a round takes no second.
    assert total_s - done_s > 7 * 20.0


async def test_a_beam_that_is_aligned_is_left_alone() -> None:
    context = await aligned(MountContext(offset_mm=0.02))
    assert context.prompts == []
    assert context.warnings == []
    assert abs(float(str(context.stored["result"]["offset_mm"])) - 0.02) < 0.01


async def test_the_count_is_not_broken_while_j4_turns() -> None:
    context = await aligned(MountContext(offset_mm=0.5))
    # One zero a round, and every distance after it was measured on that count.
    assert context.zeros == 2
    assert context.measurements == 2 * 42


async def test_a_reversed_screw_is_noticed_and_compensated() -> None:
    context = await aligned(MountContext(offset_mm=0.43, stage_mm=-0.5, noise_mm=0.0))
    assert abs(context.offset_mm) < 0.05
    assert [prompt.id for prompt in context.prompts] == ["stage/1", "stage-sense/1", "stage/2"]
    warning = context.warnings[0]
    assert "grew from 0.43 to 0.86 mm: the screw acts the other way; turn it clockwise" in warning
    assert 'stage_clockwise = "-y"' in warning
    assert context.prompts[1].choices == ("reversed", "turned the wrong way")
    assert context.prompts[2].text.startswith("Move the stage 0.86 mm towards −y, 1.7")
    assert context.prompts[2].text.endswith(" turns clockwise, then confirm.")


async def test_a_turn_the_wrong_way_is_no_reversed_screw() -> None:
    wrong = iter([-1.0, 1.0, 1.0])
    context = MountContext(offset_mm=0.43, noise_mm=0.0, answers={"stage-sense/1": "turned the wrong way"})
    context.hands = lambda turns: turns * next(wrong)
    await aligned(context)
    assert abs(context.offset_mm) < 0.05
    assert context.prompts[2].text.endswith("1.72 turns anticlockwise, then confirm.")


async def test_another_pitch_of_the_screw_is_noticed() -> None:
    context = await aligned(MountContext(offset_mm=1.2, stage_mm=0.25))
    assert abs(context.offset_mm) < 0.05
    assert len(context.turned) == 2
    assert "0.25 mm a turn instead of 0.5" in context.warnings[0]
    assert "Set stage_mm_per_turn = 0.25" in context.warnings[0]


async def test_a_screw_that_is_not_turned_is_noticed() -> None:
    lazy = iter([0.0, 1.0, 1.0])
    context = MountContext(offset_mm=0.6)
    context.hands = lambda turns: turns * next(lazy)
    await aligned(context)
    assert abs(context.offset_mm) < 0.05
    assert "the stage screw was hardly turned" in context.warnings[0]


async def test_a_slipping_screw_ends_with_the_table_of_rounds() -> None:
    context = MountContext(offset_mm=0.604, hands=lambda _turns: 0.0, noise_mm=0.0)
    with pytest.raises(AlignmentError) as caught:
        await aligned(context, max_rounds=3)
    text = str(caught.value)
    assert "after 3 rounds" in text
    assert all(f"round {number}: +0.60" in text for number in (1, 2, 3))
    assert len(context.turned) == 2
    assert "result" not in context.stored


async def test_an_operator_who_declines_ends_it() -> None:
    context = MountContext(offset_mm=0.6, answers={"stage/1": "no"})
    with pytest.raises(AlignmentError, match="the operator did not turn the stage screw"):
        await aligned(context)


async def test_noise_that_hides_the_tolerance_is_reported() -> None:
    with pytest.raises(AlignmentError, match="measure at more positions"):
        await aligned(MountContext(offset_mm=0.05, noise_mm=0.01))


async def test_radial_error_of_j4_counts_in_the_uncertainty() -> None:
    context = await aligned(MountContext(offset_mm=0.01, noise_mm=0.0))
    # Five harmonics of equal size with 10 µm rms together: their slopes are 10 µm times sqrt(mean of 1, 4 … 25).
    assert context.stored["result"]["u_mm"] == pytest.approx(0.010 * math.sqrt(55 / 5), rel=0.01)


async def test_an_offset_is_accepted_with_its_expanded_uncertainty() -> None:
    """With U = 0.066 mm of J4's radial error 0.05 mm are not within 0.1 mm, though they are with u = 0.033 mm."""
    context = await aligned(MountContext(offset_mm=0.05, noise_mm=0.0))
    assert [screw for screw, _ in context.turned] == ["stage"]
    assert abs(context.offset_mm) < 0.01


async def test_a_run_interrupted_at_the_screw_measures_before_turning() -> None:
    first = MountContext(offset_mm=0.6, answers={"stage/1": "no"})
    with pytest.raises(AlignmentError):
        await aligned(first)
    # The hands had turned the screw already when the process died.
    again = MountContext(offset_mm=first.offset_mm, stored=dict(first.stored), resumed=True)
    assert set(again.stored) == {"stage/1/measure"}
    await aligned(again)
    assert again.turned == []
    assert abs(again.offset_mm) < 0.05
    assert "interrupted while the stage screw was to be turned" in again.warnings[0]
    assert again.ran[0] == "stage/1/turn"
    assert "stage/2/measure" in again.ran


async def test_a_run_that_is_resumed_later_asks_as_usual() -> None:
    first = await aligned(MountContext(offset_mm=1.2, stage_mm=0.25))
    kept = {key: row for key, row in first.stored.items() if key in {"stage/1/measure", "stage/1/turn"}}
    again = MountContext(offset_mm=0.6, stage_mm=0.25, noise_mm=0.0, stored=kept, resumed=True)
    await aligned(again)
    assert [prompt.id for prompt in again.prompts] == ["stage/2"]
    assert again.prompts[0].text.startswith("Move the stage 0.60 mm towards −y, 2.39 turns anticlockwise")


async def test_a_beam_lost_during_the_turns_begins_them_anew() -> None:
    context = await aligned(MountContext(offset_mm=0.02, breaks_at={7}))
    assert context.zeros == 2
    with pytest.raises(BeamLostError, match="lost 3 times"):
        await aligned(MountContext(offset_mm=0.02, breaks_at={5, 12, 20}))


async def test_a_measurement_disturbed_by_hands_is_repeated() -> None:
    context = await aligned(
        MountContext(offset_mm=0.02, breaks_at={5, 12, 20}, answers={"stage/beam/1": "retry"})
    )
    (prompt,) = context.prompts
    assert prompt.text.startswith("Clear the beam to the reflector")
    assert "the beam was lost 3 times while J4 turned" in prompt.text
    assert prompt.task == ClearBeam()
    assert (prompt.motion, prompt.safe_answer) == (True, "stop")
    assert prompt.target == (
        planned().pose.theta1_deg,
        planned().pose.theta2_deg,
        50.0,
        planned().pose.j4_deg,
    )
    assert abs(float(str(context.stored["result"]["offset_mm"]))) < 0.05


async def test_a_missing_beam_is_asked_about_three_times_only() -> None:
    context = MountContext(height_mm=58.0, answers={f"stage/beam/{n}": "retry" for n in range(1, 9)})
    with pytest.raises(BeamLostError, match=r"does not return the beam within ±15°"):
        await aligned(context)
    assert [prompt.id for prompt in context.prompts] == ["stage/beam/1", "stage/beam/2", "stage/beam/3"]


async def test_zeroing_without_a_beam_is_retried() -> None:
    class Dark(MountContext):
        async def zero(self, dead_path_mm: float) -> None:
            await super().zero(dead_path_mm)
            if self.zeros < 3:
                raise NoBeamError("'Z' refused: E03")

    context = await aligned(Dark(offset_mm=0.02))
    assert (context.zeros, context.prompts) == (3, [])


async def test_no_return_at_all_names_what_to_check() -> None:
    with pytest.raises(BeamLostError, match=r"does not return the beam within ±15°.*beam-level"):
        await aligned(MountContext(height_mm=58.0))


async def test_something_else_that_moves_is_reported() -> None:
    # The reflector is twice as far as the cell file has it, in the same direction.
    pose = planned().pose
    x, y = arm_xy(pose.theta1_deg, pose.theta2_deg)
    moved = {"P2": (2.0 * 680.0 - x, -y)}
    context = await aligned(MountContext(offset_mm=0.02, places=moved))
    assert "something else moves" in context.warnings[0]


async def test_a_reflector_that_is_carried_is_asked_for() -> None:
    base = with_optics(mounted_bench(), one_reflector=True)
    context = await aligned(MountContext(offset_mm=0.02), base)
    assert context.prompts[0].task == PlaceReflector(reflector="P2")
    with pytest.raises(NotPlacedError):
        await aligned(MountContext(answers={"place/P2": "no"}), base)


def test_poses_that_cannot_be() -> None:
    with pytest.raises(PlanError, match="reflector P9 is not in the cell file; known: P1, P2, P3"):
        planned(reflector="P9")
    with pytest.raises(PlanError, match="both theta1_deg and theta2_deg"):
        planned(theta1_deg=10.0)
    with pytest.raises(PlanLimitError, match="J2 = 150"):
        planned(theta1_deg=-60.0, theta2_deg=150.0)
    with pytest.raises(PlanError, match="cannot be seen alone"):
        planned(with_optics(bench(), beam_min_mm=3000.0, beam_max_mm=4000.0))
    here = planned(theta1_deg=10.0, theta2_deg=20.0, reflector="P2").pose
    assert here.beam_mm == pytest.approx(math.dist(arm_xy(10.0, 20.0), PLACES["P2"]))


SCREW = Screw(
    "stage", "move the stage", "offset", "mm", 0.5, "towards +y", "towards −y", "stage_clockwise", ("+y", "-y"),
    "stage_mm_per_turn", 0.1,
)  # fmt: skip  # one screw a line


@pytest.mark.parametrize(
    ("before", "after", "verdict"),
    [
        (1.0, 0.0, "expected"),
        (1.0, 0.2, "expected"),
        (1.0, 0.5, "other pitch"),
        (1.0, -0.6, "other pitch"),
        (1.0, 0.95, "not turned"),
        (1.0, 1.05, "not turned"),
        (1.0, 1.9, "wrong way"),
        (0.03, 0.06, "unclear"),
    ],
)
def test_what_a_turn_did(before: float, after: float, verdict: str) -> None:
    turns = SCREW.turns(-before)
    seen = respond(SCREW, Observed(before, 0.03, 0.01), Observed(after, 0.03, 0.01), turns)
    assert seen.verdict == verdict


def test_a_doubtful_change_is_not_called_another_pitch() -> None:
    before, after = Observed(1.0, 0.2, 0.15), Observed(0.4, 0.2, 0.15)
    assert respond(SCREW, before, after, -2.0).verdict == "expected"
    assert respond(replace(SCREW, per_turn=0.1), before, after, -2.0).verdict == "unclear"


async def test_the_first_way_keeps_clear_of_the_reflectors() -> None:
    # From here a straight move to the pose near P2 would pass a reflector in the arm's way.
    base = replace(
        mounted_bench(), reflectors=(*mounted_bench().reflectors, Reflector("P4", 300.0, 420.0, 234.0))
    )
    context = await aligned(MountContext(pose=(95.0, 0.0, 50.0, 0.0)), base, reflector="P2")
    stops = [(95.0, 0.0), *(move[:2] for move in context.moves)]
    gaps = [
        math.dist(arm_xy(a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])), (300.0, 420.0))
        for a, b in pairwise(stops)
        for share in np.linspace(0.0, 1.0, 50)
    ]
    assert min(gaps) >= 50.0
    straight = [math.dist(arm_xy(95.0 * share, 0.0), (300.0, 420.0)) for share in np.linspace(0.0, 1.0, 50)]
    assert min(straight) < 50.0


async def test_returns_that_are_too_weak_are_no_distances() -> None:
    context = MountContext(offset_mm=0.02)
    with pytest.raises(AlignmentError, match=r"only 0 of 42 distances .* signal of 0\.8 or more"):
        # The ideal beam returns with 0.75 everywhere.
        await aligned(context, with_optics(mounted_bench(), signal_min=0.8))
