"""What single poses are missed by is in every prediction: several targets a pose, distances, robust losses."""

import csv
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from catseye.app.cli import cli
from catseye.app.results.serial_arm.result import SerialArmResult, read_serial_arm
from catseye.calibration.core.types import Floats
from tests.unit.app.results.serial_arm.tables import arm_file, some_poses, tool_file
from tests.unit.calibration.serial_arm.nominal import NOISE_MM
from tests.unit.calibration.serial_arm.true_arm import TrueArm

SCATTER_MM = 0.1
JOINTS = ",".join(f"q{k}_deg" for k in range(1, 7))
ANCHORS = {"P1": (900.0, 300.0, 100.0), "P2": (-200.0, 1000.0, 300.0), "P3": (700.0, -800.0, 900.0)}


def scattered(poses: Floats, seed: int, targets: int) -> Floats:
    """Return places of targets of an arm that misses each pose as a whole, shape (poses, targets, 3)."""
    arm, aside = TrueArm(), np.random.default_rng(seed).standard_normal((len(poses), 1, 3))
    nests = [arm.nests(poses, np.full(len(poses), k)) for k in range(targets)]
    return np.asarray(np.stack(nests, axis=1) + SCATTER_MM * aside)


def places_file(file: Path, poses: Floats, targets: int, noise_seed: int) -> Path:
    places = scattered(poses, noise_seed, targets)
    places = places + NOISE_MM * np.random.default_rng(noise_seed + 500).standard_normal(places.shape)
    lines = [f"pose,{JOINTS},target,x_mm,y_mm,z_mm,u_mm"]
    for k, (q, of_pose) in enumerate(zip(poses.tolist(), places.tolist(), strict=True)):
        lines += [
            ",".join([f"P{k}", *map(repr, q), f"nest{number + 1}", *map(repr, place), str(NOISE_MM)])
            for number, place in enumerate(of_pose)
        ]
    file.write_text("\n".join(lines) + "\n", "utf-8")
    return file


def lengths_file(file: Path, poses: Floats, seed: int) -> Path:
    """Write absolute distances of nest 2, which state 0.005 mm."""
    apart = scattered(poses, seed, 2)[:, 1] - np.array([ANCHORS[f"P{k % 3 + 1}"] for k in range(len(poses))])
    lengths = np.linalg.norm(apart, axis=1) + 0.005 * np.random.default_rng(seed).standard_normal(len(poses))
    lines = [f"pose,{JOINTS},target,anchor,segment,distance_mm,u_mm"]
    for k, (q, length) in enumerate(zip(poses.tolist(), lengths.tolist(), strict=True)):
        lines.append(",".join([f"P{k}", *map(repr, q), "nest2", f"P{k % 3 + 1}", "", repr(length), "0.005"]))
    file.write_text("\n".join(lines) + "\n", "utf-8")
    return file


def calibrated(folder: Path, table: Path, *words: str) -> SerialArmResult:
    files = ["--poses", str(table), "--arm", str(arm_file(folder)), "--tool", str(tool_file(folder))]
    words = (*files, "--model", "geometric+compliance", "-o", str(folder / "arm.json"), *words)
    done = CliRunner().invoke(cli, ["calibrate", *words])
    assert done.exit_code == 0, done.output
    return read_serial_arm(folder / "arm.json")


def errors_by_u(folder: Path, table: Path, predicted: tuple[str, ...], wanted: tuple[str, ...]) -> Floats:
    """Return errors of predictions over their stated uncertainties, noise of the table included."""
    file = folder / "predicted.csv"
    words = [str(folder / "arm.json"), "--poses", str(table), "-o", str(file)]
    done = CliRunner().invoke(cli, ["predict", *words])
    assert done.exit_code == 0, done.output
    rows = list(csv.DictReader(file.read_text("utf-8").splitlines()))
    missed = np.array(
        [[float(row[a]) - float(row[b]) for a, b in zip(predicted, wanted, strict=True)] for row in rows]
    )
    u = np.array([np.hypot(float(row["u_pred_mm"]), float(row["u_mm"])) for row in rows])
    return np.asarray(missed / u[:, None])


PLACES = (("x_pred_mm", "y_pred_mm", "z_pred_mm"), ("x_mm", "y_mm", "z_mm"))
LENGTHS = (("distance_pred_mm",), ("distance_mm",))


@pytest.mark.parametrize(("targets", "loss"), [(3, ()), (1, ("--loss", "huber")), (3, ("--loss", "huber"))])
def test_predicted_u_contains_what_single_poses_are_missed_by(
    tmp_path: Path, targets: int, loss: tuple[str, ...]
) -> None:
    table = places_file(tmp_path / "poses.csv", some_poses(60, 5), targets, 21)
    result = calibrated(tmp_path, table, *loss)
    assert result.left_mm == pytest.approx(SCATTER_MM, rel=0.25)
    fresh = places_file(tmp_path / "fresh.csv", some_poses(150, 6), targets, 22)
    assert 0.85 < np.sqrt(np.mean(errors_by_u(tmp_path, fresh, *PLACES) ** 2)) < 1.2


def test_predicted_lengths_contain_what_single_poses_are_missed_by(tmp_path: Path) -> None:
    anchors = "".join(f"{name},{x},{y},{z}\n" for name, (x, y, z) in ANCHORS.items())
    (tmp_path / "anchors.csv").write_text("anchor,x_mm,y_mm,z_mm\n" + anchors, "utf-8")
    table = lengths_file(tmp_path / "lengths.csv", some_poses(150, 7), 23)
    result = calibrated(tmp_path, table, "--anchors", str(tmp_path / "anchors.csv"))
    assert result.left_mm == pytest.approx(SCATTER_MM, rel=0.25)
    fresh = lengths_file(tmp_path / "fresh.csv", some_poses(150, 8), 24)
    assert 0.85 < np.sqrt(np.mean(errors_by_u(tmp_path, fresh, *LENGTHS) ** 2)) < 1.2


def test_wrong_poses_that_a_robust_loss_bears_widen_nothing(tmp_path: Path) -> None:
    table = places_file(tmp_path / "poses.csv", some_poses(60, 5), 1, 21)
    head, *rows = table.read_text("utf-8").splitlines()
    for k in (10, 40):
        cells = rows[k].split(",")
        cells[8] = repr(float(cells[8]) + 20.0)
        rows[k] = ",".join(cells)
    table.write_text("\n".join([head, *rows]) + "\n", "utf-8")
    assert calibrated(tmp_path, table, "--loss", "huber").left_mm == pytest.approx(SCATTER_MM, rel=0.25)
