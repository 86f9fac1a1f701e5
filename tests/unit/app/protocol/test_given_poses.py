"""The parameter that takes a CSV of poses: names tell poses apart, not joints."""

from pathlib import Path

import pytest

from catseye.app.errors import UsageError
from catseye.app.protocol.procedures import parse_params
from catseye.procedures.serial_arm.pose_params import GivenPose
from catseye.procedures.serial_arm.tracker_calibration import CalibrationParams

HEADER = "pose,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg"


def poses_of(folder: Path, text: str) -> list[object]:
    path = folder / "poses.csv"
    path.write_text(text, encoding="utf-8")
    params = parse_params(CalibrationParams, [f"poses={path}"])
    assert isinstance(params, CalibrationParams)
    # A run holds them as JSON.
    assert CalibrationParams.model_validate_json(params.model_dump_json()) == params
    return list(params.poses)


def test_equal_joints_of_two_names_are_two_poses(tmp_path: Path) -> None:
    found = poses_of(tmp_path, f"{HEADER}\nhome,1,2,3,4,5,6\nlast,1,2,3,4,5,6\n")
    joints = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    assert found == [GivenPose(pose="home", joints=joints), GivenPose(pose="last", joints=joints)]


def test_rows_of_targets_are_one_pose(tmp_path: Path) -> None:
    text = f"{HEADER},target\nP1,1,2,3,4,5,6,N1\nP2,6,5,4,3,2,1,N1\nP1,1,2,3,4,5,6,N2\n"
    found = [one for one in poses_of(tmp_path, text) if isinstance(one, GivenPose)]
    assert [(one.pose, one.rows, one.targets) for one in found] == [
        ("P1", 2, ["N1", "N2"]),
        ("P2", 1, ["N1"]),
    ]


def test_one_name_of_two_poses_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="pose 'P1' has other joints on line 2"):
        poses_of(tmp_path, f"{HEADER}\nP1,1,2,3,4,5,6\nP1,1,2,3,4,5,7\n")


SIDES = ",".join(f"direction{k}" for k in range(1, 7))


def test_side_that_a_run_does_not_come_from_is_refused(tmp_path: Path) -> None:
    text = f"{HEADER},{SIDES}\nP1,1,2,3,4,5,6,1,1,1,1,1,1\nP2,6,5,4,3,2,1,1,1,-1,1,1,1\n"
    with pytest.raises(
        UsageError, match=r"poses\.csv:3: pose 'P2' has direction3 = -1, and a run brings every"
    ):
        poses_of(tmp_path, text)


def test_sides_that_a_run_comes_from_are_taken(tmp_path: Path) -> None:
    text = f"{HEADER},{SIDES}\nP1,1,2,3,4,5,6,1,1,1,1,1,1\n"
    joints = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    assert poses_of(tmp_path, text) == [GivenPose(pose="P1", joints=joints)]


def test_rows_without_names_are_taken_as_before() -> None:
    params = parse_params(CalibrationParams, ["poses=[[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]]"])
    assert params == CalibrationParams(poses=[[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]])
