"""calibrate: several instruments at once, frames of tools, help with examples, and further mistakes in tables."""

import csv
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from catseye.app.cli import cli
from catseye.app.errors import UsageError
from catseye.app.results.serial_arm.result import SerialArmResult, read_serial_arm
from catseye.calibration.core.errors import UnidentifiableError
from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.rotations import pose_of
from catseye.calibration.serial_arm.plausibility import ImplausibleError
from tests.unit.app.results.serial_arm.tables import arm_file, poses_file, some_poses, tool_file
from tests.unit.calibration.serial_arm.nominal import NOISE_MM
from tests.unit.calibration.serial_arm.true_arm import BASE, FOUND, TrueArm

JOINTS = ",".join(f"q{k}_deg" for k in range(1, 7))
SPHERE = np.array([450.0, 100.0, 150.0])


def called(folder: Path, *words: str) -> Result:
    known = ["--arm", str(arm_file(folder)), "--tool", str(tool_file(folder)), "-o", str(folder / "arm.json")]
    return CliRunner().invoke(cli, ["calibrate", *known, *words])


def result_of(folder: Path, *words: str) -> SerialArmResult:
    done = called(folder, *words)
    assert done.exit_code == 0, done.output
    return read_serial_arm(folder / "arm.json")


def lengths_file(folder: Path, poses: Floats) -> Path:
    """Write ballbar lengths from nest 2 to a sphere of which nobody says where it is."""
    apart = np.linalg.norm(TrueArm().nests(poses, np.ones(len(poses), dtype=np.int64)) - SPHERE, axis=1)
    noise = 0.002 * np.random.default_rng(4).standard_normal(len(poses))
    lines = [f"pose,{JOINTS},target,anchor,segment,distance_mm,u_mm"]
    for k, (q, length) in enumerate(zip(poses.tolist(), (apart + noise).tolist(), strict=True)):
        lines.append(",".join([f"B{k}", *map(repr, q), "nest2", "sphere", "", repr(length), "0.002"]))
    (folder / "lengths.csv").write_text("\n".join(lines), "utf-8")
    return folder / "lengths.csv"


def test_lengths_of_a_ballbar_sharpen_places_of_a_tracker(tmp_path: Path) -> None:
    places, fixed = poses_file(tmp_path, some_poses()), ["--model", "geometric+compliance"]
    alone = result_of(tmp_path, "--poses", str(places), *fixed)
    lengths = lengths_file(tmp_path, some_poses(80, 5))
    both = result_of(tmp_path, "--poses", str(places), "--poses", str(lengths), *fixed)
    one, other = ({part.name: part for part in each.parameters} for each in (alone, both))
    assert other["J4.d_mm"].u < 0.7 * one["J4.d_mm"].u
    assert abs(other["J4.d_mm"].value - FOUND[3, 3]) < 4.0 * other["J4.d_mm"].u
    assert [other[f"sphere.{axis}_mm"].value for axis in "xyz"] == pytest.approx(SPHERE.tolist(), abs=0.2)
    assert both.anchors[0].name == "sphere"


def test_several_nests_of_a_pose_count_each(tmp_path: Path) -> None:
    poses = some_poses(30)
    lines = [f"pose,{JOINTS},target,x_mm,y_mm,z_mm,u_mm"]
    rng = np.random.default_rng(5)
    for nest in range(3):
        places = TrueArm().nests(poses, np.full(30, nest)) + NOISE_MM * rng.standard_normal((30, 3))
        for k, (q, place) in enumerate(zip(poses.tolist(), places.tolist(), strict=True)):
            lines.append(
                ",".join([f"P{k}", *map(repr, q), f"nest{nest + 1}", *map(repr, place), str(NOISE_MM)])
            )
    (tmp_path / "all.csv").write_text("\n".join(lines), "utf-8")
    result = result_of(tmp_path, "--poses", str(tmp_path / "all.csv"), "--model", "geometric+compliance")
    parts = {part.name: part for part in result.parameters}
    assert result.fit.n_rows == 270
    assert abs(parts["base.x_mm"].value - BASE[0]) < 4.0 * parts["base.x_mm"].u


def test_frame_of_a_tool_is_found_with_its_orientation(tmp_path: Path) -> None:
    tool = pose_of(np.array([10.0, -20.0, 90.0]), np.array([30.0, 45.0, -140.0]))
    frames = TrueArm(compliance=np.zeros(6)).flange(some_poses(40, 8)) @ tool
    lines = [f"pose,{JOINTS},target,x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg"]
    for k, (q, pose) in enumerate(zip(some_poses(40, 8).tolist(), frames, strict=True)):
        turned = np.rad2deg(
            [np.arctan2(pose[2, 1], pose[2, 2]), np.arcsin(-pose[2, 0]), np.arctan2(pose[1, 0], pose[0, 0])]
        )
        cells = [*pose[:3, 3].tolist(), *turned.tolist()]
        lines.append(",".join([f"P{k}", *map(repr, q), "plate", *map(repr, cells)]))
    (tmp_path / "cmm.csv").write_text("\n".join(lines), "utf-8")
    words = ["--poses", str(tmp_path / "cmm.csv"), "--arm", str(arm_file(tmp_path)), "--model", "geometric"]
    done = CliRunner().invoke(cli, ["calibrate", *words, "-o", str(tmp_path / "arm.json")])
    assert done.exit_code == 0, done.output
    result = read_serial_arm(tmp_path / "arm.json")
    parts = {part.name: part for part in result.parameters}
    assert result.fit.rms_mm < 1e-6
    assert not parts["J6.d_mm"].identified
    assert parts["plate.x_mm"].value == pytest.approx(10.0, abs=1.0)


def test_read_back_joints_that_moved_the_arm_are_said(tmp_path: Path) -> None:
    poses = some_poses(60)
    read = poses + np.random.default_rng(6).uniform(-0.05, 0.05, poses.shape)
    table = poses_file(tmp_path, read)
    rows = list(csv.DictReader(table.read_text("utf-8").splitlines()))
    for row, q in zip(rows, poses.tolist(), strict=True):
        for k in range(6):
            row[f"q{k + 1}_read_deg"], row[f"q{k + 1}_deg"] = row[f"q{k + 1}_deg"], repr(q[k])
    table.write_text("\n".join([",".join(rows[0]), *(",".join(row.values()) for row in rows)]), "utf-8")
    assert result_of(tmp_path, "--poses", str(table), "--model", "geometric+compliance").joints == "read back"
    bare = poses_file(tmp_path, some_poses(20, 60))
    done = CliRunner().invoke(cli, ["validate", str(tmp_path / "arm.json"), "--measured", str(bare)])
    assert isinstance(done.exception, UsageError)
    assert "the table needs them, too" in str(done.exception)


def test_metres_are_named(tmp_path: Path) -> None:
    table = poses_file(tmp_path, some_poses())
    rows = list(csv.DictReader(table.read_text("utf-8").splitlines()))
    for row in rows:
        row.update({f"{axis}_mm": repr(float(row[f"{axis}_mm"]) / 1000.0) for axis in "xyz"})
    table.write_text("\n".join([",".join(rows[0]), *(",".join(row.values()) for row in rows)]), "utf-8")
    done = called(tmp_path, "--poses", str(table))
    assert isinstance(done.exception, ImplausibleError)
    assert "the coordinates are in m, not in mm" in str(done.exception)


def test_poses_that_are_all_alike_are_refused(tmp_path: Path) -> None:
    done = called(
        tmp_path,
        "--poses",
        str(poses_file(tmp_path, np.repeat(some_poses(5), 12, axis=0))),
        "--model",
        "geometric",
    )
    assert isinstance(done.exception, UnidentifiableError)


def test_missing_direction_is_named(tmp_path: Path) -> None:
    table = poses_file(tmp_path, some_poses())
    lines = table.read_text("utf-8").splitlines()
    table.write_text("\n".join([f"{lines[0]},direction1", *(f"{line},1" for line in lines[1:])]), "utf-8")
    done = called(tmp_path, "--poses", str(table))
    assert isinstance(done.exception, UsageError)
    assert "column direction2 is missing: directions of approach are all or none" in str(done.exception)


@pytest.mark.parametrize(
    "command",
    ["select-poses", "calibrate", "predict", "validate", "compensate", "compare", "export", "report"],
)
def test_help_of_each_command_has_an_example(command: str) -> None:
    done = CliRunner().invoke(cli, [command, "--help"])
    assert done.exit_code == 0
    assert f"Example: catseye {command}" in done.output.replace("\n", " ")
