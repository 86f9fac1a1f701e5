"""validate of a serial arm: tables that cannot be of the calibrated arm are refused, and the mistake is named."""

import csv
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from catseye.app.cli import cli
from catseye.calibration.serial_arm.plausibility import ImplausibleError
from tests.unit.app.results.serial_arm.tables import arm_file, poses_file, some_poses, tool_file

Row = dict[str, str]

PLACE = ("x_mm", "y_mm", "z_mm")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("calibrated")
    words = ["--poses", str(poses_file(made, some_poses())), "--arm", str(arm_file(made))]
    words += ["--tool", str(tool_file(made)), "--model", "geometric+compliance"]
    done = CliRunner().invoke(cli, ["calibrate", *words, "-o", str(made / "arm.json")])
    assert done.exit_code == 0, done.output
    return made


def validated(folder: Path, change: Callable[[Row], Row]) -> Result:
    """Validate with a table that somebody has changed."""
    source = poses_file(folder, some_poses(60, 60), seed=9)
    rows = list(csv.DictReader(source.read_text("utf-8").splitlines()))
    with (folder / "changed.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(change(row) for row in rows)
    words = [str(folder / "arm.json"), "--measured", str(folder / "changed.csv")]
    return CliRunner().invoke(cli, ["validate", *words])


def in_metres(row: Row) -> Row:
    return row | {name: str(float(row[name]) / 1000.0) for name in PLACE}


def left_handed(row: Row) -> Row:
    return row | {"y_mm": str(-float(row["y_mm"]))}


def names_exchanged(row: Row) -> Row:
    other = {"nest1": "nest3", "nest3": "nest1"}
    return row | {"target": other.get(row["target"], row["target"])}


def in_another_frame(row: Row) -> Row:
    """Turned by 90° about z, and moved."""
    x, y = float(row["x_mm"]), float(row["y_mm"])
    return row | {"x_mm": str(500.0 - y), "y_mm": str(x - 200.0)}


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (in_metres, "if the coordinates are in m, not in mm"),
        (left_handed, "if the frame of the instrument is left-handed"),
        (names_exchanged, "the names of the targets are mixed up (nest1 is nest3"),
        (in_another_frame, "in another frame than those of the calibration"),
    ],
)
def test_mistake_of_places_is_named(folder: Path, change: Callable[[Row], Row], named: str) -> None:
    done = validated(folder, change)
    assert isinstance(done.exception, ImplausibleError), done.output
    assert named in str(done.exception)


def test_sound_places_are_validated(folder: Path) -> None:
    done = validated(folder, lambda row: row)
    assert done.exit_code == 0, done.output
