"""resolution-model and predict-resolution, from result files of an arm of known joint errors to predicted steps."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from catseye.app.cli import cli
from catseye.app.errors import MeasurementRejectedError, UsageError
from catseye.app.results.resolution.joint_tables import read_joint_tables, write_joint_tables
from catseye.app.results.resolution.predicted import read_predicted
from tests.unit.calibration.resolution.invented_arm import JOINTS, SERIES_DEG, least_step, step_errors
from tests.unit.calibration.resolution.invented_tables import of_the_invented_arm

POSES = "pose,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\nP1,20,-80,95,15,30,-40\nP2,21,-80,95,15,30,-41\n"
FEW = SERIES_DEG[::3]


def called(*words: str) -> Result:
    return CliRunner().invoke(cli, [*words])


def decaying(joint: int, direction: int, position_deg: float) -> dict[str, Any]:
    rng = np.random.default_rng((joint, direction + 1, int(position_deg) + 360))
    errors = step_errors(joint, position_deg, FEW, rng)
    moves = [
        {"command_deg": direction * c, "measured_deg": direction * c * (1 + 0.01 * e), "error_percent": e}
        for c, e in zip(FEW.tolist(), errors.tolist(), strict=True)
    ]
    # What the instrument does not resolve, and what was not found, are no steps.
    moves.append(
        {"command_deg": direction * 1e-9, "measured_deg": 1.0, "error_percent": 1e11, "judged": False}
    )
    moves.append({"command_deg": direction * 1e-8, "measured_deg": None, "error_percent": None})
    return joint_test("decaying", JOINTS[joint], position_deg, direction=direction, moves=moves)


def joint_test(kind: str, joint: str, position_deg: float | None, **more: object) -> dict[str, Any]:
    return {
        "test": kind,
        "joint": joint,
        "position_deg": position_deg,
        "threshold_percent": 10.0,
        "moves": [],
    } | more


def backlash(joint: str, position_deg: float, value: float, *, valid: bool | None) -> dict[str, Any]:
    return joint_test(
        "backlash", joint, position_deg, reversal_deg={"value": value, "u": 1e-5, "valid": valid}
    )


def result_file(folder: Path, name: str, tests: list[dict[str, Any]], arm: str = "KR 210 R2700") -> str:
    path = folder / name
    path.write_text(
        json.dumps({"format": "catseye-resolution/1", "arm": arm, "tests": tests}), encoding="utf-8"
    )
    return str(path)


def poses_file(folder: Path) -> str:
    (folder / "poses.csv").write_text(POSES, encoding="utf-8")
    return str(folder / "poses.csv")


def tables_file(folder: Path) -> str:
    write_joint_tables(of_the_invented_arm().tables, folder / "known.csv", simulated=False)
    return str(folder / "known.csv")


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8") as lines:
        return list(csv.DictReader(lines))


def predicted(folder: Path, *options: str) -> list[dict[str, str]]:
    words = ("--arm", "kr210-r2700", "--poses", poses_file(folder), "-o", str(folder / "out.csv"))
    done = called("predict-resolution", tables_file(folder), *words, *options)
    assert done.exit_code == 0, done.output
    return rows_of(folder / "out.csv")


def test_results_become_tables_of_what_was_measured(tmp_path: Path) -> None:
    one = result_file(tmp_path, "a.json", [decaying(0, 1, -50.0), backlash("A1", -50.0, 0.005, valid=True)])
    other = result_file(tmp_path, "b.json", [decaying(0, 1, 0.0), backlash("A1", 0.0, 0.009, valid=False)])
    done = called("resolution-model", one, other, "-o", str(tmp_path / "t.csv"), "--json")
    assert done.exit_code == 0, done.output
    (model,) = json.loads(done.stdout)["models"]
    assert (model["joint"], model["direction"], model["positions"]) == ("A1", 1, [-50.0, 0.0])
    assert (model["steps"], model["reversal"]) == (2 * FEW.size, 0.005)
    table = read_joint_tables(tmp_path / "t.csv", JOINTS).tables.of("A1", 1)
    assert table is not None
    assert [sector.reversal for sector in table.sectors] == [0.005, None, None, None, None]
    assert table.sectors[0].commands[[0, -1]] == pytest.approx(FEW[[-1, 0]])


def test_tables_of_results_predict_the_tool(tmp_path: Path) -> None:
    tests = [decaying(joint, way, at) for joint in range(6) for way in (1, -1) for at in (-100.0, 100.0)]
    made = called("resolution-model", result_file(tmp_path, "a.json", tests), "-o", str(tmp_path / "t.csv"))
    assert made.exit_code == 0, made.output
    assert "predictions with --reversal leave them open" in made.stderr
    words = (
        "--arm",
        "kr210-r2700",
        "--poses",
        poses_file(tmp_path),
        "-o",
        str(tmp_path / "out.csv"),
        "--json",
    )
    done = called("predict-resolution", str(tmp_path / "t.csv"), *words)
    known = {(row["pose"], row["direction"]): row for row in predicted(tmp_path)}
    steps = [step for step in json.loads(done.stdout)["least_steps"] if step["lis"] is not None]
    assert len(steps) > 16
    for step in steps:
        ends = known[step["pose"], step["direction"]]
        assert step["low"] is None or step["low"] < float(ends["high"])
        assert step["high"] is None or step["high"] > float(ends["low"])


def test_predicted_csv_is_as_documented(tmp_path: Path) -> None:
    rows = predicted(tmp_path)
    assert list(rows[0]) == ["pose", "direction", "lis", "low", "high", "unit", "reason"]
    names = ["+X", "-X", "+Y", "-Y", "+Z", "-Z", "+RX", "-RX", "+RY", "-RY", "+RZ", "-RZ"]
    assert [(row["pose"], row["direction"]) for row in rows] == [(p, n) for p in ("P1", "P2") for n in names]
    assert [row["unit"] for row in rows[:12]] == ["mm"] * 6 + ["deg"] * 6
    assert all(float(row["low"]) < float(row["lis"]) < float(row["high"]) for row in rows if row["lis"])
    assert all(row["reason"] for row in rows if not row["lis"])


def test_a_prediction_as_json_has_the_errors_of_all_steps(tmp_path: Path) -> None:
    words = ("--arm", "kr210-r2700", "--poses", poses_file(tmp_path), "-o", str(tmp_path / "out.json"))
    done = called("predict-resolution", tables_file(tmp_path), *words)
    assert done.exit_code == 0, done.output
    steps = read_predicted(tmp_path / "out.json").least_steps
    assert [f"{step.lis:.6g}" for step in steps if step.lis] == [
        row["lis"] for row in predicted(tmp_path) if row["lis"]
    ]
    curve = steps[0].curve
    assert curve is not None
    assert curve.command[0] == 1.0
    # The paper's rule on the expected errors gives the least step.
    assert least_step(np.array(curve.command), np.array(curve.mean_percent), 10.0) == steps[0].lis


def test_workers_change_no_number(tmp_path: Path) -> None:
    assert predicted(tmp_path, "--workers", "2") == predicted(tmp_path)


def test_another_seed_draws_other_runs(tmp_path: Path) -> None:
    assert predicted(tmp_path, "--seed", "2") != predicted(tmp_path)


def test_reversals_without_their_errors_leave_nothing(tmp_path: Path) -> None:
    rows = predicted(tmp_path, "--reversal")
    assert not any(row["lis"] for row in rows)
    assert "reverses, and its reversal error at" in rows[0]["reason"]


def test_a_map_names_its_places(tmp_path: Path) -> None:
    rows = predicted(tmp_path, "--map", "x=1500:9000:2")
    assert [row["x_mm"] for row in rows] == ["1500"] * 12 + ["9000"] * 12
    assert rows[0]["lis"]
    assert {row["lis"] for row in rows[12:]} == {""}
    assert "the arm reaches" in rows[12]["reason"]


def test_a_tool_moves_the_centre_of_rotations(tmp_path: Path) -> None:
    tool = tmp_path / "tool.toml"
    tool.write_text(
        'format = "catseye-tool/1"\nname = "long"\nmass_kg = 1.0\ncentre_mm = [0, 0, 0]\n'
        '[[target]]\nname = "T"\nx_mm = 0.0\ny_mm = 0.0\nz_mm = 800.0\n',
        encoding="utf-8",
    )
    with_tool, without = predicted(tmp_path, "--tool", str(tool)), predicted(tmp_path)
    assert with_tool[6]["lis"] != without[6]["lis"]


def cartesian(pose: str, direction: int, least_mm: float | None) -> dict[str, Any]:
    lis = {"value": least_mm, "u": 1e-3, "low": 1e-3, "high": 1.0} if least_mm else None
    return joint_test("cartesian", "X", None, direction=direction, pose=pose, lis_mm=lis)


def test_measured_steps_stand_beside_the_predicted_ones(tmp_path: Path) -> None:
    plus = float(predicted(tmp_path)[0]["lis"])
    tests = [
        cartesian("P1", 1, plus),
        cartesian("P1", -1, 0.5),
        cartesian("P2", 1, None),
        cartesian("P9", 1, 1.0),
    ]
    words = ("--arm", "kr210-r2700", "--poses", poses_file(tmp_path), "-o", str(tmp_path / "out.csv"))
    measured = ("--measured", result_file(tmp_path, "m.json", tests))
    done = called("predict-resolution", tables_file(tmp_path), *words, *measured, "--json")
    compared = json.loads(done.stdout)["compared"]
    assert [(one["pose"], one["direction"], one["inside"]) for one in compared] == [
        ("P1", "+X", True),
        ("P1", "-X", False),
    ]
    assert "1 of 2 measured least steps within the predicted 95 % interval" in done.stderr


def test_measured_poses_of_other_names_are_refused(tmp_path: Path) -> None:
    words = ("--arm", "kr210-r2700", "--poses", poses_file(tmp_path), "-o", str(tmp_path / "out.csv"))
    measured = ("--measured", result_file(tmp_path, "m.json", [cartesian("P9", 1, 1.0)]))
    error = failure("predict-resolution", tables_file(tmp_path), *words, *measured)
    assert isinstance(error, UsageError)
    assert "predicted are P1, P2, measured P9; give poses the same names in both files" in str(error)


def failure(*words: str) -> BaseException | None:
    return called(*words).exception


@pytest.mark.parametrize(
    ("options", "part"),
    [
        (("--arm", "kr211"), "--arm kr211: there is no description of an arm kr211"),
        (("--arm", "irb120"), "unknown joint 'A1'; the arm knows J1"),
        (("--map", "x=1:2"), "--map x=1:2: 'x=1:2' is not an axis of a slice"),
        (("--map", "w=1:2:3"), "'w=1:2:3' is not an axis of a slice"),
        (("--map", "x=2:1:3"), "a slice from 2 to 1 mm: state the smaller end first"),
        (("--target", "T"), "--target names a target of a tool"),
    ],
)
def test_an_option_without_a_meaning_is_refused(tmp_path: Path, options: tuple[str, ...], part: str) -> None:
    words = ("--arm", "kr210-r2700", "--poses", poses_file(tmp_path), "-o", str(tmp_path / "out.csv"))
    error = failure("predict-resolution", tables_file(tmp_path), *words, *options)
    assert isinstance(error, UsageError)
    assert part in str(error)


def test_results_of_two_arms_make_no_tables(tmp_path: Path) -> None:
    files = [result_file(tmp_path, f"{arm}.json", [decaying(0, 1, 0.0)], arm) for arm in ("one", "two")]
    error = failure("resolution-model", *files, "-o", str(tmp_path / "t.csv"))
    assert isinstance(error, UsageError)
    assert "two.json is of the arm two, and" in str(error)


def test_a_test_without_its_position_makes_no_table(tmp_path: Path) -> None:
    one = decaying(0, 1, 0.0) | {"position_deg": None}
    error = failure("resolution-model", result_file(tmp_path, "a.json", [one]), "-o", str(tmp_path / "t.csv"))
    assert isinstance(error, UsageError)
    assert "a decaying test of A1 states no position" in str(error)


def test_too_few_steps_reject_the_results(tmp_path: Path) -> None:
    one = decaying(0, 1, 0.0)
    one["moves"] = one["moves"][:19]
    error = failure("resolution-model", result_file(tmp_path, "a.json", [one]), "-o", str(tmp_path / "t.csv"))
    assert isinstance(error, MeasurementRejectedError)
    assert "no joint has 20 steps with an error" in str(error)


def test_a_test_in_a_wrong_scale_makes_no_table(tmp_path: Path) -> None:
    wrong = {"factor": 0.5, "text": "the stated spacing is twice the real one"}
    one = decaying(0, 1, -50.0) | {"likely_mistake": wrong}
    error = failure("resolution-model", result_file(tmp_path, "a.json", [one]), "-o", str(tmp_path / "t.csv"))
    assert isinstance(error, UsageError)
    assert "a.json: A1 at −50°, +: all steps are about 0.5 times those commanded" in str(error)
    assert "the stated spacing is twice the real one" in str(error)


def test_tests_without_a_least_step_are_named(tmp_path: Path) -> None:
    stated = {"value": 1e-4, "u": 1e-5, "low": 8e-5, "high": 2e-4}
    tests = [decaying(0, 1, -50.0), decaying(0, 1, 0.0) | {"lis_deg": stated}]
    done = called("resolution-model", result_file(tmp_path, "a.json", tests), "-o", str(tmp_path / "t.csv"))
    assert done.exit_code == 0, done.output
    said = " ".join(done.stderr.split())
    assert "1 test without a least step, whose errors may not be those of the joint: A1 at −50°, +;" in said
