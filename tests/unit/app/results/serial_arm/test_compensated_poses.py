"""Compensated commands as a CSV."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest

from catseye.app.files.poses import NamedPoses
from catseye.app.results.serial_arm.compensated_poses import (
    CompensatedPoses,
    Form,
    compensate_poses,
    compensated_text,
)
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.compensation import Compensated
from tests.unit.app.results.serial_arm.test_prediction import BACKLASH_DEG, JOINTS, SIDES, arm, asked


def test_a_joint_that_slides_has_its_command_in_mm() -> None:
    joints = np.array([[10.0, 250.5, -3.0]])
    poses = NamedPoses(("P1",), joints, (2,), (1,))
    found = Compensated(joints, np.array([0.25]), ())
    text = compensated_text(CompensatedPoses(poses, found, ("deg", "mm", "deg")), "csv", ())
    assert list(csv.DictReader(text.splitlines())) == [
        {
            "pose": "P1",
            "q1_deg": "10.000000",
            "q2_mm": "250.500000",
            "q3_deg": "-3.000000",
            "direction1": "1",
            "direction2": "1",
            "direction3": "1",
            "uncorrected_mm": "0.2500",
            "reason": "",
        }
    ]


ABOVE, BELOW = "1,-1,1,1,1,1", "1,1,1,1,1,1"
POSE = "10,20,30,40,50,60"


def program(folder: Path, sides: str) -> Path:
    return asked(folder / "program.csv", f"pose,{JOINTS},{SIDES}", f"A,{POSE},{sides}")


def test_command_from_above_is_higher_by_the_play(tmp_path: Path) -> None:
    from_above, from_below = (
        compensate_poses(arm(), program(tmp_path, sides), None).found.joints[0] for sides in (ABOVE, BELOW)
    )
    assert from_above - from_below == pytest.approx(BACKLASH_DEG * (np.arange(6) == 1), abs=1e-4)


def test_compensated_csv_repeats_the_sides(tmp_path: Path) -> None:
    text = compensated_text(compensate_poses(arm(), program(tmp_path, ABOVE), None), "csv", ())
    (row,) = csv.DictReader(text.splitlines())
    assert ",".join(row[f"direction{k}"] for k in range(1, 7)) == ABOVE


def numbers(text: str) -> Floats:
    """Return the joints of each move of a module, in the order of the moves."""
    rapid = re.findall(r"jointtarget \w+:=\[\[([^\]]*)\]", text)
    krl = re.findall(r"PTP \{([^}]*)\}", re.sub(r"A\d ", "", text))
    return np.array([[float(one) for one in line.split(",")] for line in rapid or krl])


@pytest.mark.parametrize("form", ["rapid", "krl"])
def test_module_drives_to_each_pose_from_its_side(tmp_path: Path, form: Form) -> None:
    found = compensate_poses(arm(), program(tmp_path, ABOVE), None, 5.0)
    text = compensated_text(found, form, ())
    before, there = numbers(text)
    assert there - before == pytest.approx([5.0, -5.0, 5.0, 5.0, 5.0, 5.0], abs=2e-6)
    assert "joint 1 from below, joint 2 from above" in text
    assert "these paths have not been checked for obstacles" in text


@pytest.mark.parametrize("form", ["rapid", "krl"])
def test_module_without_approach_says_so(tmp_path: Path, form: Form) -> None:
    text = compensated_text(compensate_poses(arm(), program(tmp_path, BELOW), None), form, ())
    assert len(numbers(text)) == 1
    assert "The commands hold where each joint comes from below" in text
    assert "THIS MODULE DOES NOT BRING THEM FROM THERE" in text
