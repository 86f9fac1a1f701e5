"""Compensated commands as a CSV."""

import csv

import numpy as np

from catseye.app.files.poses import NamedPoses
from catseye.app.results.serial_arm.compensated_poses import CompensatedPoses, compensated_text
from catseye.calibration.serial_arm.compensation import Compensated


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
            "uncorrected_mm": "0.2500",
            "reason": "",
        }
    ]
