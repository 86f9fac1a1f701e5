"""calibrate: Monte Carlo, robust loss, priors, directions, poses of the flange, and what the gate says."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from catseye.app.cell.six_axis.template import BY_ARM
from catseye.app.cli import cli
from catseye.app.errors import UsageError
from catseye.app.results.serial_arm.identified_arm import identified_arm
from catseye.app.results.serial_arm.result import SerialArmResult, read_serial_arm
from catseye.calibration.serial_arm.plausibility import ImplausibleError
from catseye.procedures.kit.errors import PlanError
from tests.unit.app.results.serial_arm.tables import arm_file, poses_file, some_poses, tool_file
from tests.unit.calibration.serial_arm.true_arm import COMPLIANCE, FOUND, TrueArm

JOINTS = ",".join(f"q{k}_deg" for k in range(1, 7))


def called(folder: Path, poses: Path, *words: str, model: str = "geometric+compliance") -> Result:
    known = ["--arm", str(arm_file(folder)), "--tool", str(tool_file(folder)), "-o", str(folder / "arm.json")]
    return CliRunner().invoke(cli, ["calibrate", "--poses", str(poses), "--model", model, *known, *words])


def result_of(folder: Path, poses: Path, *words: str, model: str = "geometric+compliance") -> SerialArmResult:
    done = called(folder, poses, *words, model=model)
    assert done.exit_code == 0, done.output
    return read_serial_arm(folder / "arm.json")


def rewritten(poses: Path, change: "dict[str, list[str]]") -> Path:
    """Return a table with further columns."""
    rows = list(csv.DictReader(poses.read_text("utf-8").splitlines()))
    for name, values in change.items():
        for row, value in zip(rows, values, strict=True):
            row[name] = value
    lines = [",".join(rows[0]), *(",".join(row.values()) for row in rows)]
    poses.write_text("\n".join(lines) + "\n", "utf-8")
    return poses


def test_monte_carlo_gives_intervals_about_the_values(tmp_path: Path) -> None:
    table = poses_file(tmp_path, some_poses())
    plain = {one.name: one for one in result_of(tmp_path, table).parameters}
    drawn = result_of(tmp_path, table, "--uncertainty", "monte-carlo", "--draws", "2000", "--seed", "4")
    assert drawn.monte_carlo is not None
    assert drawn.monte_carlo.draws == 2000
    for one in drawn.parameters:
        if one.identified:
            assert one.u == pytest.approx(plain[one.name].u, rel=0.12)
            assert one.low is not None
            assert one.high is not None
            assert one.high - one.low == pytest.approx(3.92 * one.u, rel=0.12)


def test_too_few_draws_are_refused(tmp_path: Path) -> None:
    words = ["--uncertainty", "monte-carlo", "--draws", "100"]
    done = called(tmp_path, poses_file(tmp_path, some_poses()), *words)
    assert isinstance(done.exception, UsageError)
    assert "--draws 2000 or more" in str(done.exception)


def test_robust_loss_keeps_wrong_poses_and_is_hardly_moved(tmp_path: Path) -> None:
    table = poses_file(tmp_path, some_poses(80))
    rows = list(csv.DictReader(table.read_text("utf-8").splitlines()))
    moved = [repr(float(row["x_mm"]) + (3.0 if k in {7, 50} else 0.0)) for k, row in enumerate(rows)]
    result = result_of(tmp_path, rewritten(table, {"x_mm": moved}), "--loss", "huber")
    parts = {one.name: one for one in result.parameters}
    assert (result.loss, result.rejected) == ("huber", [])
    assert parts["J4.d_mm"].value == pytest.approx(FOUND[3, 3], abs=5.0 * parts["J4.d_mm"].u)
    assert parts["J4.d_mm"].u < 0.1


def test_prior_narrows_a_parameter_and_an_unknown_one_is_refused(tmp_path: Path) -> None:
    table = poses_file(tmp_path, some_poses(60))
    free = {one.name: one for one in result_of(tmp_path, table).parameters}
    priors = tmp_path / "priors.csv"
    priors.write_text(f"name,value,u\nJ2.d_mm,{FOUND[1, 3]},0.002\n", "utf-8")
    known = {one.name: one for one in result_of(tmp_path, table, "--priors", str(priors)).parameters}
    assert known["J2.d_mm"].u < min(0.0021, free["J2.d_mm"].u)
    priors.write_text("name,u\nJ9.d_mm,0.002\n", "utf-8")
    done = called(tmp_path, table, "--priors", str(priors))
    assert "has no parameter J9.d_mm" in str(done.exception)


def test_priors_weigh_alike_without_stated_uncertainties(tmp_path: Path) -> None:
    priors = tmp_path / "priors.csv"
    priors.write_text("name,u\nJ4.a_mm,0.01\n", "utf-8")
    words = ["--priors", str(priors)]
    stated = result_of(tmp_path, poses_file(tmp_path, some_poses(80)), *words)
    bare = result_of(tmp_path, poses_file(tmp_path, some_poses(80), u_mm=""), *words)
    one, other = (next(p for p in each.parameters if p.name == "J4.a_mm") for each in (stated, bare))
    assert other.value == pytest.approx(one.value, abs=0.3 * one.u)
    assert other.u == pytest.approx(one.u, rel=0.25)


def test_backlash_is_found_from_directions(tmp_path: Path) -> None:
    rng, poses = np.random.default_rng(6), some_poses(150, 6)
    sides = rng.choice([-1, 1], poses.shape)
    table = poses_file(tmp_path, poses + 0.5 * 0.04 * sides)
    joints = {f"q{k + 1}_deg": [repr(q) for q in poses[:, k].tolist()] for k in range(6)}
    directions = {f"direction{k + 1}": [str(d) for d in sides[:, k].tolist()] for k in range(6)}
    result = result_of(tmp_path, rewritten(table, {**joints, **directions}), model="maps")
    parts = {one.name: one for one in result.parameters}
    for name in ("J1.reversal_deg", "J2.reversal_deg", "J3.reversal_deg"):
        assert parts[name].value == pytest.approx(0.04, abs=0.012)
    # The stored maps and reversals predict what they were identified from.
    assert len(identified_arm(result).identified) == result.fit.n_parameters


def test_frame_of_the_flange_needs_no_tool(tmp_path: Path) -> None:
    poses, arm = some_poses(40, 8), arm_file(tmp_path)
    # No load is on the flange, so that the true arm has no compliance here.
    flange = TrueArm(compliance=0.0 * COMPLIANCE).flange(poses)
    lines = [f"pose,{JOINTS},target,x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg"]
    for k, (q, pose) in enumerate(zip(poses.tolist(), flange, strict=True)):
        ry = np.arcsin(-pose[2, 0])
        angles = [np.arctan2(pose[2, 1], pose[2, 2]), ry, np.arctan2(pose[1, 0], pose[0, 0])]
        cells = [*q, *pose[:3, 3].tolist(), *np.rad2deg(angles).tolist()]
        lines.append(
            ",".join([f"P{k}", *map(repr, map(float, cells[:6])), "", *map(repr, map(float, cells[6:]))])
        )
    (tmp_path / "cmm.csv").write_text("\n".join(lines), "utf-8")
    words = ["--poses", str(tmp_path / "cmm.csv"), "--arm", str(arm), "--model", "geometric"]
    done = CliRunner().invoke(cli, ["calibrate", *words, "-o", str(tmp_path / "arm.json")])
    assert done.exit_code == 0, done.output
    parts = {one.name: one for one in read_serial_arm(tmp_path / "arm.json").parameters}
    assert parts["J6.theta_offset_deg"].value == pytest.approx(FOUND[5, 2], abs=1e-5)
    assert parts["J6.d_mm"].value == pytest.approx(FOUND[5, 3], abs=1e-5)


def test_uncertainties_of_some_tables_only_are_refused(tmp_path: Path) -> None:
    one = poses_file(tmp_path, some_poses(45))
    other = poses_file(tmp_path, some_poses(30, 7), u_mm="")
    other.write_text(other.read_text("utf-8").replace("pose ", "other "), "utf-8")
    done = called(tmp_path, one, "--poses", str(other))
    assert isinstance(done.exception, UsageError)
    assert "poses30.csv: uncertainties are stated for some rows only" in str(done.exception)


def test_copied_rows_are_refused(tmp_path: Path) -> None:
    table = poses_file(tmp_path, some_poses())
    lines = table.read_text("utf-8").splitlines()
    table.write_text("\n".join([*lines, lines[3]]), "utf-8")
    done = called(tmp_path, table)
    assert isinstance(done.exception, ImplausibleError)
    assert "pose 'pose 3' repeats 'pose 3'" in str(done.exception)


def test_accepted_implausible_result_carries_its_reason(tmp_path: Path) -> None:
    table = poses_file(tmp_path, some_poses())
    lines = table.read_text("utf-8").splitlines()
    table.write_text("\n".join([*lines, lines[3]]), "utf-8")
    result = result_of(tmp_path, table, "--accept-implausible", "copied on purpose")
    assert result.implausible is not None
    assert result.implausible.accepted == "copied on purpose"
    assert "repeat others to the last digit" in result.implausible.findings[0]


def far_from_its_drawing(folder: Path, longer_mm: float) -> Path:
    table = FOUND.copy()
    table[3, 3] += longer_mm
    poses, nest = some_poses(60), np.arange(60) % 3
    places = TrueArm(table).nests(poses, nest)
    return rewritten(
        poses_file(folder, poses),
        {f"{axis}_mm": [repr(p) for p in places[:, k].tolist()] for k, axis in enumerate("xyz")},
    )


def test_arm_far_from_its_drawing_is_refused_by_name(tmp_path: Path) -> None:
    done = called(tmp_path, far_from_its_drawing(tmp_path, 12.0))
    assert isinstance(done.exception, ImplausibleError)
    assert "J4.d_mm would be 314" in str(done.exception)


def test_arm_far_from_its_drawing_is_kept_with_a_reason(tmp_path: Path) -> None:
    table = far_from_its_drawing(tmp_path, 30.0)
    result = result_of(tmp_path, table, "--accept-implausible", "a longer forearm")
    assert {one.name: one.value for one in result.parameters}["J4.d_mm"] == pytest.approx(332.0, abs=1.0)
    assert result.implausible is not None


def test_unknown_arm_is_a_usage_error(tmp_path: Path) -> None:
    words = ["--poses", str(poses_file(tmp_path, some_poses(3))), "--arm", "irb-121"]
    done = CliRunner().invoke(cli, ["calibrate", *words, "-o", str(tmp_path / "arm.json")])
    assert isinstance(done.exception, UsageError)
    assert "there is no description of an arm irb-121" in str(done.exception)


def test_selected_poses_are_written_with_targets_and_index(tmp_path: Path) -> None:
    words = ["--count", "14", "--candidates", "300", "--starts", "1", "--limit", "J2=0:110", "--json"]
    known = ["--arm", str(arm_file(tmp_path)), "--tool", str(tool_file(tmp_path))]
    page = tmp_path / "chosen.html"
    words += ["--report", str(page)]
    done = CliRunner().invoke(cli, ["select-poses", *known, *words, "-o", str(tmp_path / "chosen.csv")])
    assert done.exit_code == 0, done.output
    # The line across the curve has a name.
    assert "the 14 poses chosen" in page.read_text("utf-8")
    rows = list(csv.DictReader((tmp_path / "chosen.csv").read_text("utf-8").splitlines()))
    said = json.loads(done.stdout)
    assert len(rows) == 14
    assert all(float(row["q2_deg"]) >= 0.0 and row["target"].startswith("nest") for row in rows)
    assert [one["count"] for one in said["index_of_count"]] == sorted(
        one["count"] for one in said["index_of_count"]
    )
    assert said["value"] > 0.0


def test_limit_of_no_joint_is_refused(tmp_path: Path) -> None:
    known = ["--arm", "irb120", "--tool", str(tool_file(tmp_path)), "--count", "14", "--limit", "A2=0:1"]
    done = CliRunner().invoke(cli, ["select-poses", *known, "-o", str(tmp_path / "chosen.csv")])
    assert isinstance(done.exception, UsageError)
    assert "the arm has the joints J1" in str(done.exception)


def test_poses_of_a_cell_name_every_seen_target(tmp_path: Path) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text(BY_ARM["irb120"].replace("cone_deg = 30.0", "cone_deg = 80.0"), "utf-8")
    words = ["--count", "12", "--candidates", "300", "--starts", "1", "--targets-per-pose", "3", "--json"]
    done = CliRunner().invoke(
        cli, ["select-poses", "--cell", str(cell), *words, "-o", str(tmp_path / "c.csv")]
    )
    assert done.exit_code == 0, done.output
    rows = list(csv.DictReader((tmp_path / "c.csv").read_text("utf-8").splitlines()))
    assert json.loads(done.stdout)["measurements"] == len(rows)
    assert len({row["pose"] for row in rows}) == 12
    assert 12 < len(rows) <= 36


@pytest.mark.parametrize("of_cell", [True, False])
def test_poses_are_chosen_for_some_targets(tmp_path: Path, of_cell: bool) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text(BY_ARM["irb120"].replace("cone_deg = 30.0", "cone_deg = 80.0"), "utf-8")
    known = ["--arm", str(arm_file(tmp_path)), "--tool", str(tool_file(tmp_path))]
    known = ["--cell", str(cell)] if of_cell else known
    words = ["--count", "14", "--candidates", "300", "--starts", "1", "--targets-per-pose", "3"]
    words += ["--target", "nest1", "--target", "nest3", "-o", str(tmp_path / "c.csv")]
    done = CliRunner().invoke(cli, ["select-poses", *known, *words])
    assert done.exit_code == 0, done.output
    rows = list(csv.DictReader((tmp_path / "c.csv").read_text("utf-8").splitlines()))
    assert {row["target"] for row in rows} == {"nest1", "nest3"}


@pytest.mark.parametrize("of_cell", [True, False])
def test_a_target_that_the_tool_lacks_is_refused(tmp_path: Path, of_cell: bool) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text(BY_ARM["irb120"], "utf-8")
    known = ["--cell", str(cell)] if of_cell else ["--arm", "irb120", "--tool", str(tool_file(tmp_path))]
    words = ["--count", "14", "--target", "nest9", "-o", str(tmp_path / "c.csv")]
    done = CliRunner().invoke(cli, ["select-poses", *known, *words])
    assert isinstance(done.exception, UsageError | PlanError)
    assert "nest9" in str(done.exception)


@pytest.mark.parametrize("option", ["--cone-deg", "--face-deg"])
def test_angles_of_sight_beside_a_cell_are_refused(tmp_path: Path, option: str) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text(BY_ARM["irb120"], "utf-8")
    words = ["--cell", str(cell), option, "20", "--count", "12", "--candidates", "300"]
    done = CliRunner().invoke(cli, ["select-poses", *words, "-o", str(tmp_path / "c.csv")])
    assert isinstance(done.exception, UsageError)
    assert option in str(done.exception)


def test_a_cell_beside_an_arm_is_refused(tmp_path: Path) -> None:
    words = ["--cell", str(tmp_path / "cell.toml"), "--arm", "irb120", "--count", "12"]
    done = CliRunner().invoke(cli, ["select-poses", *words, "-o", str(tmp_path / "c.csv")])
    assert isinstance(done.exception, UsageError)
    assert "leave out --arm" in str(done.exception)
