"""Drawing and reading of true drivetrains."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from catseye.simulators.config import SerialArm, TruthText
from catseye.simulators.errors import TruthFileError
from catseye.simulators.world.serial.truth import (
    JointTruth,
    draw_joint_truth,
    joint_truth_document,
    read_joint_truth,
)
from tests.unit.simulators.world.serial.arms import serial_arm

ARM = serial_arm("kr210-r2700")


def text(document: object) -> TruthText:
    return TruthText(json.dumps(document).encode(), "joints.json")


def test_the_same_seed_draws_the_same_drivetrains() -> None:
    assert draw_joint_truth(ARM, 4) == draw_joint_truth(ARM, 4)
    assert draw_joint_truth(ARM, 4) != draw_joint_truth(ARM, 5)


def test_a_written_truth_is_read_back() -> None:
    truth = draw_joint_truth(ARM, 4)
    assert read_joint_truth(text(joint_truth_document(truth)), ARM) == truth


def changed(change: Callable[[Any], object]) -> TruthText:
    document = json.loads(json.dumps(joint_truth_document(draw_joint_truth(ARM, 4))))
    change(document)
    return text(document)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda d: d.update(format="catseye-result/1"), r"joints\.json: format: .*catseye-joint-truth/1"),
        (lambda d: d["joints"].pop(), r"joints\.json: joints: it has A1, .*A5; KR 210 R2700 has A1, .*A6"),
        (lambda d: d["joints"][2].pop("play_deg"), r"joints\.json: joints\.2\.play_deg: Field required"),
        (
            lambda d: d["joints"][0].update(stiffness_nm_per_deg=0),
            r"joints\.0\.stiffness_nm_per_deg: .*greater",
        ),
        (lambda d: d["joints"][0].update(slack_deg=1), r"joints\.0\.slack_deg: Extra inputs"),
    ],
)
def test_a_wrong_truth_is_refused_by_its_key(change: Callable[[Any], object], said: str) -> None:
    with pytest.raises(TruthFileError, match=said):
        read_joint_truth(changed(change), ARM)


def test_every_key_is_documented() -> None:
    files = (Path(__file__).parents[5] / "docs" / "files.md").read_text("utf-8")
    section = files.split("## joint truth JSON")[1].split("\n## ")[0]
    assert [key for key in JointTruth.model_fields if f"`{key}`" not in section] == []


def test_an_arm_of_five_joints_needs_a_truth_file() -> None:
    short = SerialArm("short", ARM.joints[:5])
    with pytest.raises(TruthFileError, match=r"short: .*it has A1, A2, A3, A4, A5: state them"):
        draw_joint_truth(short, 1)
