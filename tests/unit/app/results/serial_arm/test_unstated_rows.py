"""Validation with tables that state no uncertainties: judged by the scatter of the calibration, or not at all."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from catseye.app.cli import cli
from tests.unit.app.results.serial_arm.tables import arm_file, poses_file, some_poses, tool_file
from tests.unit.calibration.serial_arm.nominal import NOISE_MM
from tests.unit.calibration.serial_arm.true_arm import TrueArm


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Calibrate from a table without uncertainties."""
    made = tmp_path_factory.mktemp("unstated")
    poses = poses_file(made, some_poses(80), u_mm="")
    words = ["--poses", str(poses), "--arm", str(arm_file(made)), "--tool", str(tool_file(made))]
    words += ["--model", "geometric+compliance", "-o", str(made / "arm.json")]
    done = CliRunner().invoke(cli, ["calibrate", *words])
    assert done.exit_code == 0, done.output
    return made


def validated(folder: Path, table: Path, *words: str) -> Result:
    words = (str(folder / "arm.json"), "--measured", str(table), *words)
    done = CliRunner().invoke(cli, ["validate", *words])
    assert done.exit_code == 0, done.output
    return done


def test_rows_without_u_scatter_as_those_of_the_calibration(folder: Path) -> None:
    fresh = poses_file(folder, some_poses(200, 5), seed=9, u_mm="")
    said = json.loads(validated(folder, fresh, "--json").stdout)
    assert said["assumed_u_mm"] == pytest.approx(NOISE_MM, rel=0.2)
    assert 90.0 <= said["inside_95_percent"] <= 98.0
    assert "its rows were taken to scatter as those of the calibration" in " ".join(
        validated(folder, fresh).stderr.split()
    )


def test_rows_that_state_u_are_judged_by_it(folder: Path) -> None:
    fresh = poses_file(folder, some_poses(200, 5), seed=9)
    said = json.loads(validated(folder, fresh, "--json").stdout)
    assert said["assumed_u_mm"] is None
    assert 90.0 <= said["inside_95_percent"] <= 98.0


def test_rows_larger_than_the_scatter_fall_outside(folder: Path) -> None:
    fresh = poses_file(folder, some_poses(100, 5), seed=9, u_mm="")
    head, *rows = fresh.read_text("utf-8").splitlines()
    cells = [row.split(",") for row in rows]
    moved = [[*one[:8], repr(float(one[8]) + 0.3), *one[9:]] for one in cells]
    fresh.write_text("\n".join([head, *map(",".join, moved)]) + "\n", "utf-8")
    assert json.loads(validated(folder, fresh, "--json").stdout)["inside_95_percent"] < 20.0


def test_lengths_without_u_are_not_judged_by_places(folder: Path) -> None:
    poses = some_poses(30, 6)
    apart = np.linalg.norm(
        TrueArm().nests(poses, np.zeros(30, dtype=np.int64)) - [450.0, 100.0, 150.0], axis=1
    )
    lines = [f"pose,{','.join(f'q{k}_deg' for k in range(1, 7))},target,anchor,segment,distance_mm"]
    for k, (q, length) in enumerate(zip(poses.tolist(), apart.tolist(), strict=True)):
        lines.append(",".join([f"B{k}", *map(repr, q), "nest1", "sphere", "", repr(length)]))
    (folder / "ballbar.csv").write_text("\n".join(lines) + "\n", "utf-8")
    said = json.loads(validated(folder, folder / "ballbar.csv", "--json").stdout)
    assert (said["inside_95_percent"], said["assumed_u_mm"]) == (None, None)
    assert "is not judged" in " ".join(validated(folder, folder / "ballbar.csv").stderr.split())
