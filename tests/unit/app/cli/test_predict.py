"""predict against an arm worked out by hand."""

import csv
import json
import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.cli.scara.predict import predict
from catseye.app.errors import MeasurementRejectedError, UsageError
from catseye.app.results.scara.path_csv import directions_of, read_path_csv, start_states
from tests.unit.app.cli.arms import bare, stored, text_file

NOMINAL = (325.0, 225.0)


def place(theta1_deg: float, theta2_deg: float, link1_mm: float, link2_mm: float) -> tuple[float, float]:
    one, both = math.radians(theta1_deg), math.radians(theta1_deg + theta2_deg)
    return (
        link1_mm * math.cos(one) + link2_mm * math.cos(both),
        link1_mm * math.sin(one) + link2_mm * math.sin(both),
    )


def predicted(folder: Path, text: str, *options: str, model: str = "error-map") -> list[dict[str, str]]:
    hand, start = (*options, "right", "1,1")[:2] if options else ("right", "1,1")
    output = folder / "predicted.csv"
    predict(
        stored(folder, bare(model)),
        text_file(folder, text),
        output,
        "left" if hand == "left" else "right",
        start,
        as_json=False,
    )
    with output.open(encoding="utf-8") as lines:
        return list(csv.DictReader(lines))


def test_joint_commands_get_their_errors_and_uncertainties(tmp_path: Path) -> None:
    rows = predicted(
        tmp_path, "theta1_deg,theta2_deg,direction1,direction2\n45,60.50,1,1\n90,0,-1,1\n0,120,1,-1\n"
    )
    assert list(rows[0]) == [
        *("theta1_deg", "theta2_deg", "direction1", "direction2"),
        *("x_pred_mm", "y_pred_mm", "ex_um", "ey_um", "u_ex_um", "u_ey_um"),
    ]
    # Deviations between the nodes: half way 20 mdeg up; at 90° 10 mdeg down; at 0° 10 mdeg up.
    by_hand = [(45.020, 60.505), (90.010, 0.005), (0.010, 119.995)]
    for row, angles, command in zip(rows, by_hand, [(45, 60.5), (90, 0), (0, 120)], strict=True):
        x, y = place(*angles, 325.1, 224.9)
        x0, y0 = place(*command, *NOMINAL)
        assert float(row["x_pred_mm"]) == pytest.approx(x, abs=1e-6)
        assert float(row["y_pred_mm"]) == pytest.approx(y, abs=1e-6)
        assert float(row["ex_um"]) == pytest.approx(1e3 * (x - x0), abs=1e-3)
        assert float(row["ey_um"]) == pytest.approx(1e3 * (y - y0), abs=1e-3)
    assert rows[0]["theta2_deg"] == "60.50"
    # At θ1 = 90°, θ2 = 0° on the nodes: y answers to both links, x to both angles (mdeg to rad: 1.745329e-5).
    mdeg = math.pi / 180e3
    assert float(rows[1]["u_ey_um"]) == pytest.approx(math.hypot(2.0, 3.0), abs=2e-3)
    assert float(rows[1]["u_ex_um"]) == pytest.approx(
        math.hypot(0.5 * mdeg * 550.0, 0.7 * mdeg * 224.9) * 1e3, abs=2e-3
    )


def test_a_missing_budget_is_stated_in_the_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = text_file(tmp_path, "theta1_deg,theta2_deg,direction1,direction2\n45,60.50,1,1\n")
    output = tmp_path / "predicted.csv"
    predict(stored(tmp_path, bare("error-map")), path, output, as_json=True)
    missing = "the result holds no error budget: uncertainties of positions are those of its parameters alone"
    assert any(missing in warning for warning in json.loads(capsys.readouterr().out)["warnings"])


def test_the_conventional_model_has_no_range_and_no_directions(tmp_path: Path) -> None:
    text = "theta1_deg,theta2_deg,direction1,direction2\n-170,-45,1,1\n-170,-45,-1,-1\n"
    rows = predicted(tmp_path, text, model="conventional")
    x, y = place(-170.0, -45.0 + 0.020, 325.1, 224.9)
    for row in rows:
        assert (float(row["x_pred_mm"]), float(row["y_pred_mm"])) == pytest.approx((x, y), abs=1e-6)


def test_rows_outside_get_empty_cells_and_a_remark(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    head = "# a comment\ntheta1_deg,theta2_deg,direction1,direction2\n"
    rows = predicted(
        tmp_path, head + "45,60,1,1\n91,60,1,1\n92,60,1,1\n\n45,60,1,1\n45,121,1,1\n90,120,1,1\n"
    )
    numbers = [[row[name] for name in ("x_pred_mm", "u_ey_um")] for row in rows]
    assert [both == ["", ""] for both in numbers] == [False, True, True, False, True, False]
    errors = capsys.readouterr().err
    assert "3 of 6 rows lie outside the identified range" in errors
    assert "θ1 (91.00°…92.00°) beyond its nodes 0°…90° in lines 4–5" in errors
    assert "θ2 (121.00°…121.00°) beyond its nodes 0°…120° in line 8" in errors
    assert "325 and 225 mm (RH-3FRH5515) are taken" in errors
    assert "no covariance" in errors


def test_a_path_wholly_outside_is_rejected_and_writes_nothing(tmp_path: Path) -> None:
    with pytest.raises(MeasurementRejectedError, match=r"2 of 2 rows lie outside.*in lines 2–3.*nothing was"):
        predicted(tmp_path, "theta1_deg,theta2_deg,direction1,direction2\n-1,60,1,1\n-2,60,1,1\n")
    assert not (tmp_path / "predicted.csv").exists()


def cartesian(*commands: tuple[float, float]) -> str:
    places = (place(*command, *NOMINAL) for command in commands)
    return "x_mm,y_mm\n" + "".join(f"{x:.9f},{y:.9f}\n" for x, y in places)


def test_directions_of_positions_are_signs_of_the_changes(tmp_path: Path) -> None:
    way = [(40.0, 50.0), (41.0, 50.0), (41.0, 48.0), (41.0, 48.0), (39.0, 48.0), (39.0, 49.0), (40.0, 49.0)]
    path = text_file(tmp_path, cartesian(*way))
    for start in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
        commands = read_path_csv(path, NOMINAL, "right", start).commands
        assert commands.direction1.tolist() == [start[0], 1, 1, 1, -1, -1, 1]
        assert commands.direction2.tolist() == [start[1], start[1], -1, -1, -1, 1, 1]
        np.testing.assert_allclose(np.rad2deg(commands.theta1_rad), [one for one, _ in way], atol=1e-9)


@given(st.lists(st.integers(-3, 3), min_size=1, max_size=40), st.sampled_from([1, -1]), st.integers(0, 10**6))
def test_no_change_keeps_the_state(steps: list[int], start: int, seed: int) -> None:
    rounding = np.random.default_rng(seed).uniform(-4e-9, 4e-9, len(steps) + 1)
    angles = 0.01 * np.cumsum([0, *steps])
    states = directions_of(angles + rounding, start).tolist()
    assert states[0] == start
    for (before, state), step in zip(pairwise(states), steps, strict=True):
        assert state == (before if step == 0 else int(np.sign(step)))


def test_positions_are_predicted_like_the_joints_that_they_are(tmp_path: Path) -> None:
    way = [(40.0, 50.0), (44.0, 54.0), (40.0, 50.0)]
    rows = predicted(tmp_path, cartesian(*way), "right", "-1,1")
    for row, (one, two), (s1, s2) in zip(rows, way, [(-1, 1), (1, 1), (-1, -1)], strict=True):
        up, down = 10.0 + 20.0 * one / 90.0, -10.0 + 20.0 * one / 90.0
        x, y = place(one + 1e-3 * (up if s1 > 0 else down), two + 0.005 * s2, 325.1, 224.9)
        assert (float(row["x_pred_mm"]), float(row["y_pred_mm"])) == pytest.approx((x, y), abs=2e-6)


def test_the_hand_chooses_the_sign_of_the_second_joint(tmp_path: Path) -> None:
    path = text_file(tmp_path, cartesian((80.0, -40.0)))
    left = read_path_csv(path, NOMINAL, "left").commands
    assert np.rad2deg([left.theta1_rad[0], left.theta2_rad[0]]) == pytest.approx([80.0, -40.0])
    right = read_path_csv(path, NOMINAL, "right").commands
    assert np.rad2deg(right.theta2_rad[0]) == pytest.approx(40.0)


def test_a_path_goes_through_the_half_turn_without_a_jump(tmp_path: Path) -> None:
    path = text_file(tmp_path, cartesian(*((170.0 + 5.0 * i, 60.0) for i in range(5))))
    commands = read_path_csv(path, NOMINAL).commands
    assert np.rad2deg(commands.theta1_rad) == pytest.approx([170.0, 175.0, 180.0, 185.0, 190.0])
    assert commands.direction1.tolist() == [1] * 5
    assert commands.direction2.tolist() == [1] * 5


def test_positions_out_of_reach_name_their_line(tmp_path: Path) -> None:
    with pytest.raises(
        UsageError, match=r"path\.csv:3: the position \(x = 600 mm, y = 0 mm\) is out of reach"
    ):
        read_path_csv(text_file(tmp_path, "x_mm,y_mm\n400,0\n600,0\n"), NOMINAL)


@pytest.mark.parametrize(("factor", "unit"), [(1e-3, "m"), (1.0 / 25.4, "inches"), (0.1, "cm"), (1e3, "µm")])
def test_positions_in_another_unit_are_named(tmp_path: Path, factor: float, unit: str) -> None:
    rows = "".join(f"{factor * 200.0},{factor * y}\n" for y in range(-400, 401, 100))
    with pytest.raises(
        UsageError, match=rf"path\.csv: .*x_mm, y_mm seem to be in {unit}: .*convert them to mm"
    ):
        read_path_csv(text_file(tmp_path, "x_mm,y_mm\n" + rows), NOMINAL)


def test_a_path_contradicting_its_start_direction_is_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # J2 turns back later, which is no matter of the start.
    path = cartesian((40.0, 50.0), (40.0, 52.0), (37.0, 54.0), (34.0, 52.0))
    predicted(tmp_path, path)
    errors = capsys.readouterr().err
    assert (
        "approached in the directions 1,1 (--start-direction), but the path continues with J1 the other way"
        in errors
    )
    assert "give --start-direction=-1,1" in errors
    predicted(tmp_path, path, "right", "-1,1")
    assert "--start-direction" not in capsys.readouterr().err


@pytest.mark.parametrize("text", ["", "1", "1,0", "1,1,1", "up,down", "1;-1"])
def test_start_states_that_are_none_are_refused(text: str) -> None:
    with pytest.raises(UsageError, match="--start-direction 1,-1"):
        start_states(text)
    assert start_states("+1, -1") == (1, -1)


def test_machines_read_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = "theta1_deg,theta2_deg,direction1,direction2\n45,60,1,1\n91,60,1,1\n45.5,60,-1,1\n"
    output = tmp_path / "predicted.csv"
    predict(stored(tmp_path, bare()), text_file(tmp_path, text), output, "right", "1,1", as_json=True)
    found = json.loads(capsys.readouterr().out)
    assert (found["rows"], found["predicted"], found["output"]) == (3, 2, str(output))
    assert len(found["warnings"]) == 4
    x, y = place(45.020, 60.005, 325.1, 224.9)
    x0, y0 = place(45.0, 60.0, *NOMINAL)
    x2, y2 = place(45.5 + 1e-3 * (-10.0 + 20.0 * 45.5 / 90.0), 60.005, 325.1, 224.9)
    x20, y20 = place(45.5, 60.0, *NOMINAL)
    errors = [1e3 * math.hypot(x - x0, y - y0), 1e3 * math.hypot(x2 - x20, y2 - y20)]
    assert found["max_um"] == pytest.approx(max(errors), abs=1e-3)
    assert found["rms_um"] == pytest.approx(math.sqrt((errors[0] ** 2 + errors[1] ** 2) / 2.0), abs=1e-3)


def test_rows_just_reversed_are_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    head = "theta1_deg,theta2_deg,direction1,direction2\n"
    # The last row was brought there by a take-up: its state is against its step.
    predicted(tmp_path, head + "40,60,1,1\n50,60,1,1\n49.5,60,-1,1\n48,60,-1,1\n47,60,1,1\n")
    assert "in 1 row a joint has moved less than 1° since it reversed (line 4)" in capsys.readouterr().err


def test_a_file_that_is_read_is_not_written_over(tmp_path: Path) -> None:
    result, path = stored(tmp_path, bare()), text_file(tmp_path, cartesian((40.0, 50.0)))
    for kept in (result, path):
        before = kept.read_bytes()
        with pytest.raises(UsageError, match="would be lost: choose another file to write"):
            predict(result, path, kept, "right", "1,1", as_json=False)
        assert kept.read_bytes() == before


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"theta1_map": None}, "no theta1_map"),
        ({"model": "conventional", "theta20_mdeg": None}, "no theta20_mdeg"),
        ({"link1_mm": {"value": 500.0, "u": 0.0}}, "does not state the nominal links"),
        ({"format": "catseye-result/2"}, "not a catseye-result/1 file"),
    ],
)
def test_results_that_are_none_are_refused(tmp_path: Path, change: dict[str, object], text: str) -> None:
    path = text_file(tmp_path, "x_mm,y_mm\n400,0\n")
    with pytest.raises(UsageError, match=text):
        predict(
            stored(tmp_path, {**bare(), **change}), path, tmp_path / "o.csv", "right", "1,1", as_json=False
        )


def test_nodes_have_to_increase(tmp_path: Path) -> None:
    content = bare()
    content["theta1_map"]["node_deg"] = [90.0, 0.0]
    with pytest.raises(
        UsageError, match=r"theta1_map\.node_deg of the result has to hold nodes that increase"
    ):
        predict(
            stored(tmp_path, content),
            text_file(tmp_path, "x_mm,y_mm\n400,0\n"),
            tmp_path / "o.csv",
            "right",
            "1,1",
            as_json=False,
        )
