"""The place of the ballbar's cup, taken by leading a nest into it: kinematics of a true arm, by hand."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from catseye.app.engine.dry_run import DryRunContext
from catseye.app.engine.operator import Answer
from catseye.app.store.reader import RunReader
from catseye.calibration.kinematics.inverse import inverse_kinematics
from catseye.calibration.kinematics.rotations import rotation_of
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.system import System
from catseye.procedures.serial_arm.ballbar import BallbarParams, BallbarTest
from catseye.procedures.serial_arm.ballbar_cup import BallbarCup, CupParams, CupPlan
from tests.declared_questions import undeclared
from tests.unit.procedures.serial_arm.benches import SIX, Room, carried_out
from tests.unit.procedures.serial_arm.test_ballbar import (
    BENCH,
    CUP,
    FOUND_MM,
    NEST_FOUND,
    RESULT,
    SMALL,
    true_chain,
)
from tests.unit.procedures.six_axes import CHAIN


def pose_at(place_mm: np.ndarray, turn_deg: float = 0.0) -> Pose:
    """Return joints at which the true arm holds N1 at a place, the tool looking down, turned about z."""
    frame = np.eye(4)
    frame[:3, :3] = rotation_of(np.array([180.0, 0.0, turn_deg]))
    frame[:3, 3] = place_mm
    tool = np.eye(4)
    tool[:3, 3] = SIX.target("N1").place_mm
    found = inverse_kinematics(true_chain(), frame[None], np.array([0.0, 20.0, 20.0, 0.0, 40.0, 0.0]), tool)
    assert not found.refused
    return tuple(found.poses[0].tolist())


class Led(Room):
    """A bench whose arm somebody leads while a question is open."""

    poses: dict[str, Pose]

    async def answer(self, prompt: Prompt) -> Answer:
        if prompt.id in self.poses:
            self.robot.pose = self.poses[prompt.id]
        return await super().answer(prompt)


def led(tmp_path: Path, **poses: Pose) -> Led:
    room = Led(tmp_path)
    room.poses = {name.replace("_", "/"): pose for name, pose in poses.items()}
    return room


def plan_of(**changes: Any) -> CupPlan:
    return BallbarCup().plan(BENCH, CupParams(result=RESULT, **changes))


def said(path: Path, kind: str) -> list[Any]:
    return [one.data for one in RunReader(path).events() if one.kind == kind]


async def test_the_joints_tell_where_the_cup_stands(tmp_path: Path) -> None:
    true = np.add(CUP, [3.0, -2.0, 1.0])
    room = led(tmp_path, cup_1=pose_at(true), cup_2=pose_at(true, 40.0))
    room.answers["bar"] = "skip"
    outcome = await carried_out(room, BallbarCup(), plan_of())
    assert (outcome.status, outcome.text) == ("complete", "")
    (found,) = said(outcome.path, "cup-found")
    assert found["centre_mm"] == pytest.approx(true.tolist(), abs=1e-6)
    assert found["apart_mm"] < 1e-6
    assert len(RunReader(outcome.path).rows("cup")) == 2


def test_the_cup_is_rehearsed_with_the_nest_as_identified() -> None:
    plan = BallbarCup().plan(BENCH, CupParams(result=NEST_FOUND))
    flange = CHAIN.flange(np.array([plan.rehearsed]))[0]
    assert (flange @ [*FOUND_MM, 1.0])[:3] == pytest.approx(CUP, abs=1e-6)


async def test_a_taking_apart_from_the_first_is_asked_again(tmp_path: Path) -> None:
    room = led(
        tmp_path, cup_1=pose_at(CUP), cup_2=pose_at(np.add(CUP, [0.0, 0.0, 2.0])), cup_2_2=pose_at(CUP, 30.0)
    )
    room.answers["bar"] = "skip"
    outcome = await carried_out(room, BallbarCup(), plan_of())
    assert outcome.status == "complete"
    assert "2.00 mm from the first taking" in next(one.text for one in room.asked if one.id == "cup/2/2")


async def test_a_taking_with_the_same_joints_proves_nothing(tmp_path: Path) -> None:
    room = led(tmp_path, cup_1=pose_at(CUP), cup_2=pose_at(CUP))
    room.answers["bar"] = "skip"
    outcome = await carried_out(room, BallbarCup(), plan_of())
    assert outcome.status == "complete"
    assert ["proves nothing" in str(one["text"]) for one in said(outcome.path, "warning")].count(True) == 1


async def test_takings_that_disagree_are_to_be_begun_anew(tmp_path: Path) -> None:
    room = led(tmp_path, cup_1=pose_at(np.add(CUP, [0.0, 0.0, 2.0])), cup_2=pose_at(CUP))
    outcome = await carried_out(room, BallbarCup(), plan_of())
    assert outcome.status == "failed"
    assert "start again if the first taking may be wrong: catseye resume keeps it" in outcome.text


async def test_a_wrong_first_taking_needs_no_new_run(tmp_path: Path) -> None:
    outcome = await carried_out(led(tmp_path, cup_1=(0.0,) * 6), BallbarCup(), plan_of())
    assert outcome.text.endswith("Then continue with catseye resume")


def test_what_is_measured_is_called_a_taking() -> None:
    assert [record.point_name for record in BallbarCup.records] == ["taking"]


async def test_a_nest_far_from_the_stated_cup_ends_the_run(tmp_path: Path) -> None:
    room = led(tmp_path, cup_1=(0.0,) * 6)
    outcome = await carried_out(room, BallbarCup(), plan_of())
    assert outcome.status == "failed"
    assert "correct centre_mm if the cup stands elsewhere" in outcome.text


async def test_the_bar_joins_the_two_nests(tmp_path: Path) -> None:
    over = pose_at(np.add(CUP, [0.0, 0.0, 300.4]))
    room = led(tmp_path, cup_1=pose_at(CUP), cup_2=pose_at(CUP, 40.0), bar=over)
    room.answers = dict.fromkeys(["bar", "bar/2", "bar/3"], "done")
    outcome = await carried_out(room, BallbarCup(), plan_of())
    assert outcome.status == "complete"
    assert said(outcome.path, "cup-found")[0]["bar_off_mm"] == pytest.approx(0.4, abs=1e-6)


async def test_nests_farther_apart_than_the_bar_are_refused(tmp_path: Path) -> None:
    over = pose_at(np.add(CUP, [0.0, 0.0, 310.0]))
    room = led(tmp_path, cup_1=pose_at(CUP), cup_2=pose_at(CUP, 40.0), bar=over)
    room.answers = dict.fromkeys(["bar", "bar/2", "bar/3"], "done")
    outcome = await carried_out(room, BallbarCup(), plan_of())
    assert outcome.status == "failed"
    assert "310.0 mm apart, and the bar is 300 ± 1 mm long" in outcome.text


async def test_a_cup_that_the_bar_cannot_go_about_is_reported(tmp_path: Path) -> None:
    far = np.add(CUP, [110.0, 0.0, 0.0])
    bench = replace(BENCH, ballbar=replace(BENCH.ballbar, centre_mm=tuple(far.tolist())))  # type: ignore[type-var]  # it has one
    plan = BallbarCup().plan(bench, CupParams(result=RESULT))
    room = led(tmp_path, cup_1=pose_at(far), cup_2=pose_at(far, 20.0))
    room.answers["bar"] = "skip"
    outcome = await carried_out(room, BallbarCup(), plan)
    assert outcome.status == "complete"
    assert any("ballbar cannot move about this cup" in str(one["text"]) for one in room.said("warning"))


def test_a_nest_that_the_tool_lacks_is_refused() -> None:
    with pytest.raises(PlanError, match="no target N9"):
        plan_of(nest="N9")


def test_a_taken_place_replaces_that_of_the_cell() -> None:
    taken = [450.0, 5.0, 62.0]
    plan = BallbarTest().plan(BENCH, BallbarParams(result=RESULT, centre_mm=taken, **SMALL))
    assert plan.ballbar.centre_mm == (450.0, 5.0, 62.0)
    with pytest.raises(PlanError, match="give x, y and z"):
        BallbarTest().plan(BENCH, BallbarParams(result=RESULT, centre_mm=[1.0, 2.0], **SMALL))


async def test_a_rehearsal_takes_the_stated_place() -> None:
    dry = DryRunContext(System(BENCH), pose=(0.0,) * 6, declared=BallbarCup.records)
    await BallbarCup().run(dry, plan_of())
    assert undeclared(dry.prompts, BallbarCup) == []
    assert len(dry.records) == 2
    # Nobody can lead an arm in a rehearsal: it is not blamed for standing still.
    assert not [data for kind, data in dry.notes if kind == "warning"]


def test_a_stated_place_that_no_arm_reaches_is_refused() -> None:
    far = replace(BENCH, ballbar=replace(BENCH.ballbar, centre_mm=(1500.0, 0.0, 60.0)))  # type: ignore[type-var]  # it has one
    with pytest.raises(PlanError, match="cannot hold N1 in a cup at 1500, 0, 60 mm"):
        BallbarCup().plan(far, CupParams(result=RESULT))
