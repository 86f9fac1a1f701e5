"""Predicted distances of a result that was identified from distances."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from catseye.app.cli import cli
from catseye.app.errors import UsageError
from catseye.app.results.serial_arm.identified_arm import ends_with_frames
from catseye.app.results.serial_arm.length_errors import left_variance_mm2, root_of
from catseye.app.results.serial_arm.result import AnchorPart, ParameterPart
from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.plausibility import ImplausibleError
from tests.unit.app.results.serial_arm.sample import sample_calibration
from tests.unit.app.results.serial_arm.tables import arm_file, some_poses, tool_file
from tests.unit.calibration.serial_arm.true_arm import TrueArm

ANCHORS = {"P1": (900.0, 300.0, 100.0), "P2": (-200.0, 1000.0, 300.0), "P3": (700.0, -800.0, 900.0)}
U_MM = 0.01
JOINTS = ",".join(f"q{k}_deg" for k in range(1, 7))


def lengths(poses: Floats) -> Floats:
    """Return what interferometers show of nest 2 with dead paths of 0, 100 and 200 mm."""
    places = TrueArm(base=np.zeros(6)).nests(poses, np.ones(len(poses), dtype=np.int64))
    apart = [np.linalg.norm(place - ANCHORS[f"P{k % 3 + 1}"]) for k, place in enumerate(places)]
    return np.asarray(np.array(apart) - 100.0 * (np.arange(len(poses)) % 3))


def table(file: Path, poses: Floats, measured: Floats) -> Path:
    lines = [f"pose,{JOINTS},target,anchor,segment,distance_mm,u_mm"]
    for k, (q, length) in enumerate(zip(poses.tolist(), measured.tolist(), strict=True)):
        cells = [str(k), *map(repr, q), "nest2", f"P{k % 3 + 1}", f"s{k % 3}", repr(length), str(U_MM)]
        lines.append(",".join(cells))
    file.write_text("\n".join(lines), "utf-8")
    return file


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("distances")
    poses, noise = some_poses(240, 3), np.random.default_rng(3).standard_normal(240)
    file = table(made / "distances.csv", poses, lengths(poses) + U_MM * noise)
    (made / "anchors.csv").write_text(
        "anchor,x_mm,y_mm,z_mm\n" + "".join(f"{name},{x},{y},{z}\n" for name, (x, y, z) in ANCHORS.items()),
        "utf-8",
    )
    words = ["--poses", str(file), "--arm", str(arm_file(made)), "--tool", str(tool_file(made))]
    words += ["--anchors", str(made / "anchors.csv"), "--model", "geometric+compliance"]
    done = CliRunner().invoke(cli, ["calibrate", *words, "-o", str(made / "arm.json")])
    assert done.exit_code == 0, done.output
    return made


def predicted(folder: Path, file: Path) -> Result:
    words = [str(folder / "arm.json"), "--poses", str(file), "-o", str(folder / "predicted.csv")]
    return CliRunner().invoke(cli, ["predict", *words])


def test_predicted_distances_hold_within_their_uncertainty(folder: Path) -> None:
    poses = some_poses(120, 44)
    wanted = lengths(poses)
    done = predicted(folder, table(folder / "asked.csv", poses, wanted))
    assert done.exit_code == 0, done.output
    rows = list(csv.DictReader((folder / "predicted.csv").read_text("utf-8").splitlines()))
    missed = np.array([float(row["distance_pred_mm"]) for row in rows]) - wanted
    u = np.array([float(row["u_pred_mm"]) for row in rows])
    assert np.abs(missed).mean() < 0.02
    assert 0.4 < np.sqrt(np.mean((missed / u) ** 2)) < 1.7


def test_dead_path_that_nobody_knows_is_refused(folder: Path) -> None:
    file = table(folder / "other.csv", some_poses(3, 45), np.zeros(3))
    file.write_text(file.read_text("utf-8").replace(",s1,", ",s9,"), "utf-8")
    done = predicted(folder, file)
    assert isinstance(done.exception, UsageError)
    assert "other.csv:3: the result does not know the dead path of P2#s9" in str(done.exception)


def validated(folder: Path, file: Path, *words: str) -> Result:
    return CliRunner().invoke(cli, ["validate", str(folder / "arm.json"), "--measured", str(file), *words])


def ballbar(folder: Path, seed: int) -> Path:
    """Write lengths from nests 1 and 2 to a sphere of which nobody says where it is."""
    poses = some_poses(160, seed)
    nests = np.arange(160) % 2
    centre = np.array([450.0, 100.0, 150.0])
    apart = np.linalg.norm(TrueArm(base=np.zeros(6)).nests(poses, nests) - centre, axis=1)
    lines = [f"pose,{JOINTS},target,anchor,segment,distance_mm"]
    for k, (q, length) in enumerate(zip(poses.tolist(), apart.tolist(), strict=True)):
        lines.append(",".join([f"B{k}", *map(repr, q), f"nest{nests[k] + 1}", "sphere", "", repr(length)]))
    (folder / "ballbar.csv").write_text("\n".join(lines), "utf-8")
    return folder / "ballbar.csv"


def test_lengths_of_a_ballbar_validate_by_target(folder: Path) -> None:
    done = validated(folder, ballbar(folder, 71), "--json", "-o", str(folder / "ballbar.html"))
    said = json.loads(done.stdout)
    rows = {(one["target"], one["state"]): one for one in said["by_target"]}
    assert (said["measured"], said["n"], said["fitted_anchors"]) == ("distances", 160, ["sphere"])
    assert said["calibrated"]["max_mm"] < 0.15
    assert said["frames_only"]["mean_mm"] > 5.0 * said["calibrated"]["mean_mm"]
    assert abs(rows["nest2", "calibrated"]["mean_mm"]) < 0.05
    assert "Length errors by measurement" in (folder / "ballbar.html").read_text("utf-8")


def test_stated_place_of_the_sphere_is_taken(folder: Path) -> None:
    (folder / "sphere.csv").write_text("anchor,x_mm,y_mm,z_mm\nsphere,450,100,150\n", "utf-8")
    done = validated(folder, ballbar(folder, 72), "--json", "--anchors", str(folder / "sphere.csv"))
    said = json.loads(done.stdout)
    assert said["fitted_anchors"] == []
    assert said["calibrated"]["mean_mm"] < 0.1


def anchors_file(folder: Path, name: str, moved_mm: Floats, u_mm: str = "") -> Path:
    """Write the anchors, each moved."""
    head = "anchor,x_mm,y_mm,z_mm" + (",u_mm" if u_mm else "")
    lines = [
        ",".join([name_, *map(repr, (np.array(ANCHORS[name_]) + moved).tolist()), *([u_mm] if u_mm else [])])
        for name_, moved in zip(ANCHORS, moved_mm, strict=True)
    ]
    (folder / name).write_text("\n".join([head, *lines]), "utf-8")
    return folder / name


def of_new_segments(folder: Path, seed: int, count: int = 120) -> Path:
    """Write lengths with dead paths of which the result knows nothing."""
    poses = some_poses(count, seed)
    noise = U_MM * np.random.default_rng(seed).standard_normal(count)
    file = table(folder / f"new{seed}.csv", poses, lengths(poses) + 7.0 + noise)
    text = file.read_text("utf-8")
    for k in range(3):
        text = text.replace(f",s{k},", f",later{k},")
    file.write_text(text, "utf-8")
    return file


@pytest.mark.parametrize("off_mm", [0.0, 2.0])
def test_known_anchor_stays_where_its_dead_path_is_unknown(folder: Path, off_mm: float) -> None:
    anchors = anchors_file(folder, "off.csv", np.array([[off_mm, 0.0, 0.0], [0.0] * 3, [0.0] * 3]))
    done = validated(folder, of_new_segments(folder, 81), "--json", "--anchors", str(anchors))
    said = json.loads(done.stdout)
    assert said["fitted_anchors"] == []
    assert sorted(said["fitted_dead_paths"]) == ["P1#later0", "P2#later1", "P3#later2"]
    if off_mm:
        # A third of the rows are to the anchor that stands 2 mm beside where it is said to.
        assert said["calibrated"]["max_mm"] > 0.5
    else:
        assert said["calibrated"]["max_mm"] < 0.15
        assert 88.0 < said["inside_95_percent"] < 99.0
    assert "does not know the dead path of P1#later0" in done.stderr


def test_uncertainty_of_anchors_counts_in_that_of_errors(folder: Path) -> None:
    moved = np.array([[0.3, -0.2, 0.1], [-0.1, 0.3, -0.3], [0.2, 0.1, 0.3]])
    file = of_new_segments(folder, 82)
    inside = []
    for u_mm in ("", "0.25"):
        anchors = anchors_file(folder, f"u{u_mm}.csv", moved, u_mm)
        done = validated(folder, file, "--json", "--anchors", str(anchors))
        inside.append(json.loads(done.stdout)["inside_95_percent"])
    assert inside[0] < 60.0
    assert inside[1] > 90.0


def test_the_drawn_arm_has_anchors_of_its_own() -> None:
    """As they were fitted with the links as drawn, where they were not known."""
    plain = sample_calibration()
    assert plain.frames is not None
    own = [
        ParameterPart(
            name=name, value=value, u=0.1, unit="mm", nominal=None, identified=True, of_distances=True
        )
        for name, value in (("P1.y_mm", 7.0), ("P1#s0.dead_path_mm", 0.5))
    ]
    anchors = [AnchorPart(name=name, place_mm=(1.0, 2.0, 3.0)) for name in ("P1", "P2")]
    frames = plain.frames.model_copy(update={"parameters": own})
    places, paths = ends_with_frames(plain.model_copy(update={"anchors": anchors, "frames": frames}))
    assert {name: place.tolist() for name, place in places.items()} == {
        "P1": [1.0, 7.0, 3.0],
        "P2": [1.0, 2.0, 3.0],
    }
    assert paths == {"P1#s0": 0.5}


def zeroed_anew(folder: Path, seed: int, prefix: str = "") -> Path:
    """Write lengths of segments by the old names, whose counter was zeroed 45 mm farther away."""
    poses = some_poses(120, seed)
    file = table(folder / f"zeroed{seed}.csv", poses, lengths(poses) - 45.0)
    head, *rows = file.read_text("utf-8").splitlines()
    file.write_text("\n".join([head, *(prefix + row for row in rows)]), "utf-8")
    return file


def test_dead_path_of_another_zero_is_named(folder: Path) -> None:
    done = validated(folder, zeroed_anew(folder, 84))
    assert isinstance(done.exception, ImplausibleError)
    assert "P1#s0: all 40 distances are 45 mm shorter than predicted" in str(done.exception)


def test_tables_of_two_zeros_are_named(folder: Path) -> None:
    words = ["--poses", str(folder / "distances.csv"), "--poses", str(zeroed_anew(folder, 85, "later "))]
    words += ["--arm", str(folder / "arm.toml"), "--tool", str(folder / "plate.toml")]
    words += ["--anchors", str(folder / "anchors.csv"), "-o", str(folder / "both.json")]
    done = CliRunner().invoke(cli, ["calibrate", *words])
    assert isinstance(done.exception, ImplausibleError), done.output
    assert "if each table has dead paths of its own: P1#s0 is a segment of several tables" in str(
        done.exception
    )


def test_a_single_distance_shows_no_dead_path(folder: Path) -> None:
    anchors = anchors_file(folder, "right.csv", np.zeros((3, 3)))
    file = of_new_segments(folder, 83, count=5)
    done = validated(folder, file, "--anchors", str(anchors))
    assert isinstance(done.exception, InsufficientPointsError)
    assert "P3#later2: a single distance does not say what its dead path is" in str(done.exception)


def test_fitting_takes_its_part_of_the_variance() -> None:
    rng = np.random.default_rng(4)
    fitted, slopes, own = rng.normal(size=(12, 2)), rng.normal(size=(12, 3)), rng.uniform(0.1, 2.0, 12)
    covariance = np.cov(rng.normal(size=(3, 9)))
    whole = slopes @ covariance @ slopes.T + np.diag(own)
    rest = np.eye(12) - fitted @ np.linalg.pinv(fitted)
    left = left_variance_mm2(fitted, slopes @ root_of(covariance), own)
    assert left == pytest.approx(np.diag(rest @ whole @ rest))
