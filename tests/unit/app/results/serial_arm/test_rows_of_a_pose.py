"""Rows of one pose of a table say the same of its joints, or are refused."""

from pathlib import Path

import pytest

from catseye.app.cell.arm import arm_description
from catseye.app.errors import UsageError
from catseye.app.results.serial_arm.measured_poses import MeasuredPoses, read_measured_poses
from catseye.app.results.serial_arm.nominal_arm import serial_arm_of

JOINTS = ",".join(f"q{k}_deg" for k in range(1, 7))
READ = ",".join(f"q{k}_read_deg" for k in range(1, 7))
SIDES = ",".join(f"direction{k}" for k in range(1, 7))


def read(folder: Path, columns: str, *rows: str) -> MeasuredPoses:
    path = folder / "poses.csv"
    lines = [f"pose,{JOINTS},{columns},target,x_mm,y_mm,z_mm"]
    lines += [f"p1,10,20,30,40,50,60,{row},N{k},500,{k},300" for k, row in enumerate(rows, 1)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    description = arm_description("irb120")
    return read_measured_poses([path], description, serial_arm_of(description, None), {})


def test_read_back_joints_that_scatter_are_averaged(tmp_path: Path) -> None:
    found = read(tmp_path, READ, "10.001,20,30,40,50,60", "10.003,20,30,40,50,60")
    assert found.read_back is not None
    assert found.read_back[0].tolist() == pytest.approx([10.002, 20, 30, 40, 50, 60])


def test_read_back_joints_of_another_pose_are_refused(tmp_path: Path) -> None:
    with pytest.raises(
        UsageError, match=r"poses\.csv:3: pose 'p1' has read-back joints in .*csv:2 that differ by 0\.5"
    ):
        read(tmp_path, READ, "10,20,30,40,50,60", "10.5,20,30,40,50,60")


def test_other_sides_of_approach_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"csv:3: pose 'p1' was approached from other sides in .*csv:2"):
        read(tmp_path, SIDES, "1,1,1,1,1,1", "1,1,-1,1,1,1")


@pytest.mark.parametrize(
    ("columns", "values", "why"),
    [
        ("u_x_mm,u_y_mm,u_z_mm,cov_xy_mm2", "0.1,0.1,0.1,0.001", "column cov_xz_mm2 is missing: covariances"),
        ("cov_xy_mm2,cov_xz_mm2,cov_yz_mm2", "0,0,0", "uncertainties are stated for some rows only"),
        (
            "u_mm,cov_xy_mm2,cov_xz_mm2,cov_yz_mm2",
            "0.1,0.02,0,0",
            "csv:2: uncertainties and covariances do not",
        ),
    ],
)
def test_covariances_that_are_not_whole_are_refused(
    tmp_path: Path, columns: str, values: str, why: str
) -> None:
    with pytest.raises(UsageError, match=why):
        read(tmp_path, columns, values)


def test_a_missing_column_names_one_of_another_unit(tmp_path: Path) -> None:
    path = tmp_path / "poses.csv"
    path.write_text(f"pose,{JOINTS},target,x_m,Y_MM,z_mm\n", encoding="utf-8")
    description = arm_description("irb120")
    with pytest.raises(
        UsageError, match=r"column x_mm, y_mm is missing \(the file has x_m, Y_MM: another spelling"
    ):
        read_measured_poses([path], description, serial_arm_of(description, None), {})
