"""Exported parameters: labelled rows, and URDF read by its own rules."""

import csv
import json
import types
from pathlib import Path
from typing import cast
from xml.etree import ElementTree

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from catseye.app.cell.arm import ArmDescription
from catseye.app.cli import cli
from catseye.app.errors import UsageError
from catseye.app.results.serial_arm.export import target_links
from catseye.calibration.core.types import Floats
from tests.unit.app.results.serial_arm.tables import arm_file, poses_file, some_poses, tool_file
from tests.unit.calibration.serial_arm.true_arm import COMPLIANCE, FOUND, NESTS, TrueArm


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("exported")
    words = ["--poses", str(poses_file(folder, some_poses(), seed=None)), "--arm", str(arm_file(folder))]
    words += [
        "--tool",
        str(tool_file(folder)),
        "--model",
        "geometric+compliance",
        "-o",
        str(folder / "arm.json"),
    ]
    done = CliRunner().invoke(cli, ["calibrate", *words])
    assert done.exit_code == 0, done.output
    return folder / "arm.json"


def exported(result: Path, name: str) -> Path:
    done = CliRunner().invoke(cli, ["export", str(result), "-o", str(result.with_name(name))])
    assert done.exit_code == 0, done.output
    return result.with_name(name)


def about(axis: Floats, angle: float) -> Floats:
    """Return a turn (Rodrigues)."""
    x, y, z = axis
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * across + (1.0 - np.cos(angle)) * (across @ across))


def numbers(text: str) -> Floats:
    return np.array([float(word) for word in text.split()])


def forward(urdf: Path, values_rad: Floats) -> dict[str, Floats]:
    """Return the place of every link, m, as the URDF specification says."""
    places = {"base": (np.eye(3), np.zeros(3))}
    moving = iter(values_rad.tolist())
    for joint in ElementTree.parse(urdf).getroot().iter("joint"):
        origin, parent, child = joint.find("origin"), joint.find("parent"), joint.find("child")
        assert origin is not None
        assert parent is not None
        assert child is not None
        roll, pitch, yaw = numbers(origin.attrib["rpy"])
        turn = about(np.eye(3)[2], yaw) @ about(np.eye(3)[1], pitch) @ about(np.eye(3)[0], roll)
        axis = joint.find("axis")
        if axis is not None:
            turn = turn @ about(numbers(axis.attrib["xyz"]), next(moving))
        rotation, place = places[parent.attrib["link"]]
        places[child.attrib["link"]] = (
            rotation @ turn,
            place + rotation @ numbers(origin.attrib["xyz"]),
        )
    return {name: place for name, (_, place) in places.items()}


def test_urdf_puts_the_nests_where_the_true_arm_does(result: Path) -> None:
    urdf, stiff = exported(result, "arm.urdf"), TrueArm(compliance=0.0 * COMPLIANCE, base=np.zeros(6))
    for pose in some_poses(10, 90):
        found = forward(urdf, np.deg2rad(pose))
        for k in range(len(NESTS)):
            wanted = stiff.nests(pose[None], np.array([k]))[0]
            assert 1e3 * found[f"nest{k + 1}"] == pytest.approx(wanted, abs=1e-6)


def test_rows_name_joint_parameter_and_deviation(result: Path) -> None:
    rows = {
        row["name"]: row
        for row in csv.DictReader(exported(result, "arm.csv").read_text("utf-8").splitlines())
    }
    row = rows["J4.d_mm"]
    assert (row["of"], row["parameter"], row["unit"]) == ("J4", "d_mm", "mm")
    assert float(row["value"]) == pytest.approx(FOUND[3, 3], abs=1e-6)
    assert float(row["deviation"]) == pytest.approx(FOUND[3, 3] - 302.0, abs=1e-6)


def test_json_holds_the_same_rows(result: Path) -> None:
    said = json.loads(exported(result, "exported.json").read_text("utf-8"))
    assert said["model"] == "geometric+compliance"
    assert {"name", "value", "u", "unit", "nominal"} <= set(said["parameters"][0])


def test_urdf_of_anything_else_is_refused(tmp_path: Path) -> None:
    other: Result = CliRunner().invoke(cli, ["export", "no-such-run", "-o", str(tmp_path / "run.urdf")])
    assert isinstance(other.exception, UsageError)
    assert "URDF is of calibrated serial arms" in str(other.exception)


def test_links_of_targets_have_names_of_their_own() -> None:
    joints = [types.SimpleNamespace(name=name) for name in ("J1", "J2")]
    description = cast("ArmDescription", types.SimpleNamespace(joint=joints))
    names = ["base", "J1_link", "a b", "a_b", "N1"]
    assert target_links(names, description) == ["base_2", "J1_link_2", "a_b_2", "a_b", "N1"]
