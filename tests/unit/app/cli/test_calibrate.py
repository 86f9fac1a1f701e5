"""calibrate: from tables of measured poses to a result, and what it refuses."""

import csv
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import catseye
from catseye.app.cli import cli
from catseye.app.errors import MeasurementRejectedError, UsageError
from catseye.app.results.loading import CalibratedArm
from catseye.app.results.serial_arm.identified_arm import identified_arm
from catseye.app.results.serial_arm.result import read_serial_arm, write_serial_arm
from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.plausibility import ImplausibleError
from tests.unit.app.render.page_reader import read_page
from tests.unit.app.results.serial_arm.tables import arm_file, poses_file, some_poses, tool_file
from tests.unit.calibration.serial_arm.true_arm import BASE, DRAWN, FOUND, NESTS, TrueArm


def called(folder: Path, poses: Path, *words: str) -> Result:
    arm = ["--arm", str(arm_file(folder)), "-o", str(folder / "arm.json")]
    return CliRunner().invoke(cli, ["calibrate", "--poses", str(poses), *arm, *words])


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Calibrate once for all tests that begin with a result; return the folder of its files and of what was said."""
    folder = tmp_path_factory.mktemp("calibrated")
    done = called(folder, poses_file(folder, some_poses()), "--tool", str(tool_file(folder)), "--json")
    assert done.exit_code == 0, done.output
    (folder / "said.json").write_text(done.stdout, "utf-8")
    return folder


@pytest.fixture
def calibrated(made: Path, tmp_path: Path) -> Path:
    """Return a folder of its own with the result, its table, arm and tool."""
    return shutil.copytree(made, tmp_path / "calibrated")


def test_table_gives_the_arm_with_honest_uncertainties(calibrated: Path) -> None:
    result = read_serial_arm(calibrated / "arm.json")
    parts = {one.name: one for one in result.parameters}
    wanted = {
        "base.x_mm": BASE[0],
        "base.rz_deg": BASE[5],
        "J4.d_mm": FOUND[3, 3],
        "J5.alpha_deg": FOUND[4, 0],
    }
    assert result.model == "geometric+compliance"
    for name, true in wanted.items():
        assert abs(parts[name].value - true) < 4.0 * parts[name].u
        assert parts[name].u < 0.1


def test_result_predicts_like_the_arm_that_it_came_from(calibrated: Path) -> None:
    arm = identified_arm(read_serial_arm(calibrated / "arm.json"))
    poses = some_poses(200, 50)
    places, covariance = arm.places_mm(Commands.of(arm.arm, poses), 1)
    missed = places - TrueArm().nests(poses, np.ones(200, dtype=np.int64))
    u = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    assert np.linalg.norm(missed, axis=1).mean() < 0.06
    assert 0.5 < np.sqrt(np.mean((missed / u) ** 2)) < 1.6


def test_json_has_the_keys_of_the_format(made: Path) -> None:
    said = json.loads((made / "said.json").read_text("utf-8"))
    assert {"arm", "model", "parameters", "fit", "cross_validation", "rejected", "output"} <= set(said)
    stored = json.loads((made / "arm.json").read_text("utf-8"))
    assert stored["format"] == "catseye-serial-arm/1"
    assert len(stored["correlation"]) == stored["fit"]["n_parameters"]


def test_without_a_tool_places_of_targets_are_found(tmp_path: Path) -> None:
    poses = poses_file(tmp_path, some_poses(80))
    assert called(tmp_path, poses, "--model", "geometric").exit_code == 0
    parts = {one.name: one for one in read_serial_arm(tmp_path / "arm.json").parameters}
    assert parts["nest2.x_mm"].value == pytest.approx(115.0, abs=5.0)
    assert not parts["J6.theta_offset_deg"].identified


def test_wrong_unit_is_named_and_nothing_written(tmp_path: Path) -> None:
    poses = poses_file(tmp_path, some_poses())
    header, *rows = (line.split(",") for line in poses.read_text("utf-8").splitlines())
    turned = [[*row[:1], *(repr(float(np.deg2rad(float(q)))) for q in row[1:7]), *row[7:]] for row in rows]
    poses.write_text("\n".join(",".join(row) for row in [header, *turned]), encoding="utf-8")
    done = called(tmp_path, poses, "--tool", str(tool_file(tmp_path)))
    assert isinstance(done.exception, ImplausibleError)
    assert "in rad, not in deg" in str(done.exception)
    assert not (tmp_path / "arm.json").exists()


def test_target_that_the_tool_lacks_is_refused_with_its_line(tmp_path: Path) -> None:
    tool = tool_file(tmp_path, ("smr1", "nest2", "nest3"))
    done = called(tmp_path, poses_file(tmp_path, some_poses()), "--tool", str(tool))
    assert isinstance(done.exception, UsageError)
    assert "poses45.csv:2: the tool has no target 'nest1'; it has smr1" in str(done.exception)


def test_pose_with_other_joints_is_refused_with_both_lines(tmp_path: Path) -> None:
    poses = poses_file(tmp_path, some_poses())
    poses.write_text(poses.read_text("utf-8").replace("pose 3,", "pose 1,"), encoding="utf-8")
    done = called(tmp_path, poses, "--tool", str(tool_file(tmp_path)))
    assert "poses45.csv:4: pose 'pose 1' has other joints" in str(done.exception)


def test_too_few_poses_are_refused(tmp_path: Path) -> None:
    done = called(
        tmp_path,
        poses_file(tmp_path, some_poses(3)),
        "--tool",
        str(tool_file(tmp_path)),
        "--model",
        "geometric",
    )
    assert isinstance(done.exception, CalibrationError)
    assert "rows for 26 parameters" in str(done.exception)


def test_distances_to_anchors_are_identified(tmp_path: Path) -> None:
    poses, rng = some_poses(200, 3), np.random.default_rng(3)
    places = TrueArm(base=np.zeros(6)).nests(poses, np.ones(200, dtype=np.int64))
    anchors = {"P1": (900.0, 300.0, 100.0), "P2": (-200.0, 1000.0, 300.0), "P3": (700.0, -800.0, 900.0)}
    (tmp_path / "anchors.csv").write_text(
        "anchor,x_mm,y_mm,z_mm\n" + "".join(f"{name},{x},{y},{z}\n" for name, (x, y, z) in anchors.items()),
        "utf-8",
    )
    lines = ["pose," + ",".join(f"q{k}_deg" for k in range(1, 7)) + ",target,anchor,segment,distance_mm,u_mm"]
    for k, (q, place) in enumerate(zip(poses.tolist(), places, strict=True)):
        name = ("P1", "P2", "P3")[k % 3]
        apart = float(np.linalg.norm(place - anchors[name]) - 100.0 * (k % 3) + 0.002 * rng.standard_normal())
        lines.append(",".join([f"{k}", *map(repr, q), "nest2", name, f"s{k % 3}", repr(apart), "0.002"]))
    (tmp_path / "distances.csv").write_text("\n".join(lines), encoding="utf-8")
    words = ["--tool", str(tool_file(tmp_path)), "--anchors", str(tmp_path / "anchors.csv")]
    done = called(tmp_path, tmp_path / "distances.csv", *words, "--model", "geometric+compliance")
    assert done.exit_code == 0, done.output
    parts = {one.name: one for one in read_serial_arm(tmp_path / "arm.json").parameters}
    assert parts["J4.d_mm"].value == pytest.approx(FOUND[3, 3], abs=4.0 * parts["J4.d_mm"].u)
    assert parts["P2#s1.dead_path_mm"].value == pytest.approx(100.0, abs=0.05)


def validated(folder: Path, *words: str) -> Result:
    poses = poses_file(folder, some_poses(100, 60), seed=9)
    return CliRunner().invoke(cli, ["validate", str(folder / "arm.json"), "--measured", str(poses), *words])


def test_validation_states_errors_of_drawn_and_calibrated_arm(calibrated: Path) -> None:
    done = validated(calibrated, "--json")
    said = json.loads(done.stdout)
    assert said["n"] == 100
    assert 1.0 < said["frames_only"]["mean_mm"] < 3.0
    # Noise of the measured places alone makes 0.065 mm.
    assert 0.05 < said["calibrated"]["mean_mm"] < 0.1
    assert said["calibrated"]["max_mm"] > said["calibrated"]["mean_mm"] > said["calibrated"]["std_mm"]
    assert 89.0 <= said["inside_95_percent"] <= 99.0
    before_mm, after_mm = (said[state]["mean_mm"] for state in ("frames_only", "calibrated"))
    assert said["said"][0]["short"] == f"as drawn {before_mm:.3f} mm → calibrated {after_mm:.3f} mm"


def marked(folder: Path) -> None:
    """Have the result say that it comes of a run of emulators that was changed."""
    result = read_serial_arm(folder / "arm.json")
    assert result.provenance is not None
    origin = {"simulated": True, "unverified": ["run R was changed"]}
    provenance = result.provenance.model_copy(update=origin)
    write_serial_arm(result.model_copy(update={"provenance": provenance}), folder / "arm.json")


@pytest.mark.parametrize("of_emulators", [False, True])
@pytest.mark.parametrize("command", ["validate", "report"])
def test_pages_of_emulated_or_changed_runs_say_so(calibrated: Path, command: str, of_emulators: bool) -> None:
    if of_emulators:
        marked(calibrated)
    words = ["-o", str(calibrated / "page.html")]
    if command == "validate":
        done = validated(calibrated, *words)
    else:
        done = CliRunner().invoke(cli, [command, str(calibrated / "arm.json"), *words])
    assert done.exit_code == 0, done.output
    text = read_page((calibrated / "page.html").read_text(encoding="utf-8")).text
    told = [word in text for word in ("SIMULATION", "UNVERIFIED: run R was changed")]
    assert told == [of_emulators, of_emulators]


def test_validation_beyond_the_limit_is_rejected(calibrated: Path) -> None:
    done = validated(calibrated, "--limit-mm", "0.03")
    assert isinstance(done.exception, MeasurementRejectedError)
    assert "more than the limit of 0.03 mm" in str(done.exception)


def test_predicted_rows_keep_their_columns(calibrated: Path) -> None:
    poses = poses_file(calibrated, some_poses(30, 70), seed=None)
    words = ["--poses", str(poses), "-o", str(calibrated / "predicted.csv")]
    done = CliRunner().invoke(cli, ["predict", str(calibrated / "arm.json"), *words])
    assert done.exit_code == 0, done.output
    with (calibrated / "predicted.csv").open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    missed = [[float(row[f"{axis}_pred_mm"]) - float(row[f"{axis}_mm"]) for axis in "xyz"] for row in rows]
    assert len(rows) == 30
    assert np.linalg.norm(missed, axis=1).mean() < 0.06
    assert all(0.0 < float(row["u_pred_mm"]) < 0.1 for row in rows)
    assert "joints" not in rows[0]


def test_path_of_a_scara_is_refused_for_a_serial_arm(calibrated: Path) -> None:
    words = ["--path", str(calibrated / "poses45.csv"), "-o", str(calibrated / "predicted.csv")]
    done = CliRunner().invoke(cli, ["predict", str(calibrated / "arm.json"), *words])
    assert isinstance(done.exception, UsageError)
    assert "is for a serial arm: give --poses FILE" in str(done.exception)


def test_report_of_the_result_shows_its_parameters(calibrated: Path) -> None:
    done = CliRunner().invoke(
        cli, ["report", str(calibrated / "arm.json"), "-o", str(calibrated / "arm.html")]
    )
    assert done.exit_code == 0, done.output
    page = (calibrated / "arm.html").read_text("utf-8")
    assert "J4.compliance_rad_per_nmm" in page
    assert "geometric+compliance, poses left out" in page


def compensated(folder: Path, form: str) -> str:
    poses = poses_file(folder, some_poses(12, 80), seed=None)
    words = ["--poses", str(poses), "--format", form, "--target", "nest2", "-o", str(folder / "out.txt")]
    done = CliRunner().invoke(cli, ["compensate", str(folder / "arm.json"), *words])
    assert done.exit_code == 0, done.output
    return (folder / "out.txt").read_text("utf-8")


def missed_mm(commands: dict[int, list[float]]) -> Floats:
    """Return by how much the true arm misses poses of the program, by number, where nest 2 is meant to be."""
    nest = np.ones(len(commands), dtype=np.int64)
    meant = DRAWN.nests(some_poses(12, 80)[list(commands)], nest)
    there = TrueArm(base=np.zeros(6)).nests(np.array(list(commands.values())), nest)
    return np.asarray(np.linalg.norm(there - meant, axis=1))


def test_compensated_commands_bring_the_true_arm_near(calibrated: Path) -> None:
    rows = list(csv.DictReader(compensated(calibrated, "csv").splitlines()))
    kept = [k for k, row in enumerate(rows) if not row["reason"]]
    assert len(kept) >= 9
    assert missed_mm({k: [float(rows[k][f"q{j}_deg"]) for j in range(1, 7)] for k in kept}).mean() < 0.12
    bare = missed_mm({k: some_poses(12, 80)[k].tolist() for k in kept})
    assert [float(rows[k]["uncorrected_mm"]) for k in kept] == pytest.approx(bare, abs=0.2)
    assert bare.min() > 0.5


def test_the_library_compensates_as_the_command_does(tmp_path: Path) -> None:
    # Without a tool the places of its targets are identified.
    done = called(tmp_path, poses_file(tmp_path, some_poses()), "--model", "geometric")
    assert done.exit_code == 0, done.output
    rows = list(csv.DictReader(compensated(tmp_path, "csv").splitlines()))
    said = np.array([[float(row[f"q{j}_deg"] or "nan") for j in range(1, 7)] for row in rows])
    assert np.isfinite(said).all(axis=1).sum() >= 9
    loaded = catseye.load(tmp_path / "arm.json")
    assert isinstance(loaded, CalibratedArm)
    assert loaded.value("nest2.x_mm")[0] == pytest.approx(NESTS[1, 0], abs=1.0)
    np.testing.assert_allclose(loaded.compensated(some_poses(12, 80), "nest2"), said, atol=1e-6)


def test_rapid_module_drives_the_true_arm_near(calibrated: Path) -> None:
    lines = compensated(calibrated, "rapid").splitlines()
    assert (lines[0], lines[-1]) == ("MODULE CATSCOMP", "ENDMODULE")
    text = "\n".join(lines)
    declared = re.findall(r"CONST jointtarget (p\d+_pose_(\d+)):=\[\[([^\]]*)\]", text)
    assert re.findall(r"MoveAbsJ (\w+)", text) == [name for name, _, _ in declared]
    missed = missed_mm({int(pose) - 1: [float(q) for q in joints.split(",")] for _, pose, joints in declared})
    assert len(missed) >= 9
    assert missed.max() < 0.3


def test_krl_module_drives_the_true_arm_near(calibrated: Path) -> None:
    text = compensated(calibrated, "krl")
    assert text.startswith("DEF CATSCOMP( )")
    moves = re.findall(r"; p\d+_pose_(\d+)\s+PTP \{([^}]*)\}", text)
    axes = [dict(axis.split() for axis in listed.split(", ")) for _, listed in moves]
    assert len(moves) == text.count("PTP") >= 9
    assert all(list(one) == [f"A{k}" for k in range(1, 7)] for one in axes)
    commands = {
        int(pose) - 1: [float(q) for q in one.values()] for (pose, _), one in zip(moves, axes, strict=True)
    }
    assert missed_mm(commands).max() < 0.3


def test_what_single_poses_are_missed_by_widens_predictions(tmp_path: Path) -> None:
    """The tables state 0.01 mm, and scatter by 0.0404 mm."""
    poses, tool = poses_file(tmp_path, some_poses(60), u_mm="0.01"), tool_file(tmp_path)
    done = called(tmp_path, poses, "--tool", str(tool), "--model", "geometric+compliance")
    assert done.exit_code == 0, done.output
    result = tmp_path / "arm.json"
    assert read_serial_arm(result).left_mm == pytest.approx((0.0404**2 - 0.01**2) ** 0.5, rel=0.2)
    fresh = poses_file(tmp_path, some_poses(200, 5), seed=9, u_mm="0.01")
    said = CliRunner().invoke(cli, ["validate", str(result), "--measured", str(fresh), "--json"])
    assert 91.0 <= json.loads(said.stdout)["inside_95_percent"] <= 99.0


def of_joints_read_back(folder: Path) -> Path:
    result = read_serial_arm(folder / "arm.json").model_copy(update={"joints": "read back"})
    write_serial_arm(result, folder / "read.json")
    return folder / "read.json"


def test_no_commands_are_made_of_joints_read_back(calibrated: Path) -> None:
    poses = poses_file(calibrated, some_poses(5, 70))
    words = ["--poses", str(poses), "-o", str(calibrated / "out.csv")]
    done = CliRunner().invoke(cli, ["compensate", str(of_joints_read_back(calibrated)), *words])
    assert isinstance(done.exception, UsageError)
    assert "calibrate again from the table without its columns q1_read_deg" in str(done.exception)
    assert not (calibrated / "out.csv").exists()


def test_prediction_says_that_joints_are_read_back(calibrated: Path) -> None:
    poses = poses_file(calibrated, some_poses(5, 70))
    words = ["--poses", str(poses), "-o", str(calibrated / "out.csv"), "--json"]
    done = CliRunner().invoke(cli, ["predict", str(of_joints_read_back(calibrated)), *words])
    assert json.loads(done.stdout)["joints"] == "read back"
    with (calibrated / "out.csv").open(encoding="utf-8") as lines:
        assert {row["joints"] for row in csv.DictReader(lines)} == {"read back"}
    assert "stands elsewhere at such commands" in done.stderr


def test_approach_is_for_programs_alone(calibrated: Path) -> None:
    poses = poses_file(calibrated, some_poses(5, 70))
    words = ["--poses", str(poses), "-o", str(calibrated / "out.csv"), "--approach", "5"]
    done = CliRunner().invoke(cli, ["compensate", str(calibrated / "arm.json"), *words])
    assert isinstance(done.exception, UsageError)
    assert "--approach is for --format rapid and krl" in str(done.exception)


def test_uncertainties_in_m_are_named(tmp_path: Path) -> None:
    poses, tool = poses_file(tmp_path, some_poses(), u_mm="0.00004"), tool_file(tmp_path)
    done = called(tmp_path, poses, "--tool", str(tool), "--model", "geometric+compliance")
    assert isinstance(done.exception, ImplausibleError)
    assert "the stated uncertainties, 4e-05 mm, are smaller than those of any instrument" in str(
        done.exception
    )
    assert "they may be in m, not in mm" in str(done.exception)
    kept = ["--tool", str(tool), "--model", "geometric+compliance", "--accept-implausible", "as they are"]
    assert called(tmp_path, poses, *kept).exit_code == 0


def test_fine_instrument_on_an_arm_with_ripple_is_believed(tmp_path: Path) -> None:
    """A CMM of 0.5 µm shows the waves that the model lacks: 0.1 mm, and no other unit."""
    poses = poses_file(tmp_path, some_poses(60), None, "0.0005", TrueArm(wave_deg=np.full(6, 0.02)))
    done = called(tmp_path, poses, "--tool", str(tool_file(tmp_path)), "--model", "geometric+compliance")
    assert done.exit_code == 0, done.output


def test_rows_that_are_more_certain_than_most_are_remarked(tmp_path: Path) -> None:
    poses, tool = poses_file(tmp_path, some_poses()), tool_file(tmp_path)
    head, *rows = poses.read_text("utf-8").splitlines()
    rows[6] = rows[6].removesuffix(",0.0404") + ",0.002"
    poses.write_text("\n".join([head, *rows]) + "\n", "utf-8")
    done = called(tmp_path, poses, "--tool", str(tool), "--model", "geometric+compliance")
    assert done.exit_code == 0, done.output
    assert (
        "the uncertainties of 1 rows (the first: pose 'pose 7', 0.002 mm) are less than 1/10" in done.stderr
    )


def test_poses_outside_the_ranges_are_remarked(tmp_path: Path) -> None:
    poses, tool, arm = poses_file(tmp_path, some_poses()), tool_file(tmp_path), arm_file(tmp_path)
    narrow = arm.read_text("utf-8").replace("high_deg = 70.0", "high_deg = 40.0", 1)
    assert narrow != arm.read_text("utf-8")
    (tmp_path / "narrow.toml").write_text(narrow, "utf-8")
    words = ["--poses", str(poses), "--arm", str(tmp_path / "narrow.toml"), "--tool", str(tool)]
    done = CliRunner().invoke(
        cli, ["calibrate", *words, "--model", "geometric+compliance", "-o", str(tmp_path / "arm.json")]
    )
    assert done.exit_code == 0, done.output
    assert "poses are outside the ranges of the arm description" in done.stderr
    assert read_serial_arm(tmp_path / "arm.json").remarks


def test_validation_names_a_mistake_in_joints_read_back(calibrated: Path) -> None:
    poses = poses_file(calibrated, some_poses(20, 61), seed=9)
    head, *rows = (line.split(",") for line in poses.read_text("utf-8").splitlines())
    in_rad = [[repr(float(np.deg2rad(float(q)))) for q in row[1:7]] for row in rows]
    read = [f"q{k}_read_deg" for k in range(1, 7)]
    lines = [",".join([*row, *more]) for row, more in zip([head, *rows], [read, *in_rad], strict=True)]
    poses.write_text("\n".join(lines) + "\n", "utf-8")
    words = [str(of_joints_read_back(calibrated)), "--measured", str(poses)]
    done = CliRunner().invoke(cli, ["validate", *words])
    assert isinstance(done.exception, UsageError)
    assert "if the joints are in rad, not in deg: put the columns q1_read_deg" in str(done.exception)
