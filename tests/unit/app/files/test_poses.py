"""Poses CSV: names, joints, and what is wrong with a file."""

from pathlib import Path

import pytest

from catseye.app.errors import UsageError
from catseye.app.files.poses import poses_table, read_poses


def written(folder: Path, text: str) -> Path:
    path = folder / "poses.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_poses_are_read_in_their_order(tmp_path: Path) -> None:
    found = read_poses(
        written(tmp_path, "# day 1\npose,q1_deg,q2_mm\nP2,10,-3.5\nP1,20,4\n"), poses_table(("deg", "mm"))
    )
    assert found.names == ("P2", "P1")
    assert found.joints.tolist() == [[10.0, -3.5], [20.0, 4.0]]
    assert found.lines == (3, 4)


def test_targets_of_one_pose_are_one_pose(tmp_path: Path) -> None:
    text = "pose,q1_deg,target,x_mm\nP1,10,T1,5.5\nP1,10,T2,6.5\nP2,11,T1,7\n"
    found = read_poses(written(tmp_path, text), poses_table(("deg",)))
    assert found.names == ("P1", "P2")
    assert found.rows == (2, 1)
    assert found.targets == (("T1", "T2"), ("T1",))


@pytest.mark.parametrize(
    ("text", "part"),
    [
        (
            "pose,q1_deg,q2_deg\nP1,1,2\n",
            "poses.csv:1: column q3_deg is missing: it takes a file with",
        ),
        ("q1_deg,q2_deg,q3_deg\n1,2,3\n", "column pose is missing"),
        ("pose,q1_deg,q2_deg,q3_deg\nP1,1,two,3\n", "poses.csv:2: q2_deg = 'two' is not a finite number"),
        ("pose,q1_deg,q2_deg,q3_deg\n,1,2,3\n", "poses.csv:2: the pose has no name"),
        ("pose,q1_deg,q2_deg,q3_deg\nP,1,2,3\nP,1,2,4\n", "poses.csv:3: pose 'P' has other joints on line 2"),
        ("pose,q1_deg,q2_deg,q3_deg\n", "holds no poses"),
    ],
)
def test_a_wrong_file_names_line_and_remedy(tmp_path: Path, text: str, part: str) -> None:
    with pytest.raises(UsageError, match=part):
        read_poses(written(tmp_path, text), poses_table(("deg", "deg", "deg")))
