"""compensate: what it writes, what it reports and what it refuses, for an arm worked out by hand."""

import csv
import json
import math
import re
from pathlib import Path
from typing import Any

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli.scara.compensate import compensate
from catseye.app.errors import LimitError, MeasurementRejectedError, UsageError
from catseye.app.protocol.procedures import parse_params
from catseye.procedures.scara.path.validation_path import PathParams
from tests.unit.app.cli.arms import DOWN1, UP1, bare, stored, text_file

JOINTS = "theta1_deg,theta2_deg,direction1,direction2\n"
LINK1, LINK2 = 325.1, 224.9


def run(folder: Path, path: str | None, form: str = "csv", **options: Any) -> Path:
    output = folder / f"out.{form}"
    chosen: dict[str, Any] = {
        "hand": "right",
        "start_direction": "1,1",
        "cell": None,
        "j4": 0.0,
        "as_json": False,
    }
    compensate(
        stored(folder, options.pop("content", bare())),
        output,
        None if path is None else text_file(folder, path),
        **chosen | {"format_": form} | options,
    )
    return output


def cell(folder: Path, limits: str = "[-170.0, 170.0]") -> Path:
    assert "j1 = [-170.0, 170.0]" in TEMPLATE
    return text_file(folder, TEMPLATE.replace("j1 = [-170.0, 170.0]", f"j1 = {limits}"), "cell.toml")


def place(theta1_deg: float, theta2_deg: float, s1: int, s2: int) -> tuple[float, float]:
    """Return where the arm of the result stands."""
    up = UP1 if s1 > 0 else DOWN1
    one = math.radians(theta1_deg + 1e-3 * (up[0] + (up[1] - up[0]) * theta1_deg / 90.0))
    both = one + math.radians(theta2_deg + 5e-3 * s2)
    return (
        LINK1 * math.cos(one) + LINK2 * math.cos(both),
        LINK1 * math.sin(one) + LINK2 * math.sin(both),
    )


@pytest.mark.parametrize("form", ["csv", "json", "melfa"])
def test_a_path_made_from_changed_runs_says_so(tmp_path: Path, form: str) -> None:
    content = bare()
    content["provenance"]["unverified"] = ["night-7: wire.log was changed"]
    output = run(tmp_path, JOINTS + "10.0,20.0,1,1\n", form, content=content, cell=cell(tmp_path))
    text = output.read_text(encoding="utf-8")
    if form == "json":
        assert json.loads(text)["provenance"]["unverified"] == ["night-7: wire.log was changed"]
    else:
        assert "UNVERIFIED: night-7: wire.log was changed" in text


def rows_of(output: Path) -> list[dict[str, str]]:
    lines = [line for line in output.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def test_the_csv_holds_commands_that_stand_there(tmp_path: Path) -> None:
    rows = rows_of(run(tmp_path, "x_mm,y_mm\n200,400\n150,420\n150.5,420\n"))
    assert [(row["x_mm"], row["y_mm"]) for row in rows] == [
        ("200.000000", "400.000000"),
        ("150.000000", "420.000000"),
        ("150.500000", "420.000000"),
    ]
    for row in rows:
        theta1, theta2 = float(row["theta1_deg"]), float(row["theta2_deg"])
        found = place(theta1, theta2, int(row["direction1"]), int(row["direction2"]))
        # Six decimals of a degree are 10 nm at 550 mm.
        assert found == pytest.approx((float(row["x_mm"]), float(row["y_mm"])), abs=1e-5)
        assert 0.0 < float(row["u_x_um"]) < 10.0
    assert [row["take_up1"] for row in rows] == ["1", "0", "1"]


def test_the_json_holds_the_same_and_what_it_means(tmp_path: Path) -> None:
    path = JOINTS + "45,60,1,1\n45,60,-1,1\n"
    document = json.loads(run(tmp_path, path, "json").read_text(encoding="utf-8"))
    rows = rows_of(run(tmp_path, path))
    assert document["format"] == "catseye-compensation/1"
    assert document["gauge"] == "mean of theta1 map = 0"
    assert (document["link1_mm"], document["nominal"]["link1_mm"]) == (LINK1, 325.0)
    assert list(document["columns"]) == list(rows[0])
    for one, other in zip(document["rows"], rows, strict=True):
        assert {name: float(value) for name, value in one.items()} == {n: float(v) for n, v in other.items()}
    # Without a reversal of the links' part, the two commands differ by the reversal of 20 mdeg at 45°.
    difference = document["rows"][1]["theta1_deg"] - document["rows"][0]["theta1_deg"]
    assert difference == pytest.approx(0.020, abs=1e-5)


def test_rows_without_a_correction_are_reported_and_left_empty(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = rows_of(run(tmp_path, JOINTS + "45,60,1,1\n120,60,1,1\n50,60,1,1\n"))
    assert [row["theta1_deg"] == "" for row in rows] == [False, True, False]
    assert rows[1]["x_mm"] != ""
    assert "the corrected commands of line 3 lie outside the nodes" in capsys.readouterr().err


def test_out_of_reach_of_the_identified_arm(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    content = bare()
    content["link2_mm"]["value"] = 224.0
    rows_of(run(tmp_path, "x_mm,y_mm\n388.6,388.6\n200,400\n", content=content))
    assert "does not reach the positions of line 2" in capsys.readouterr().err


def test_a_stretched_arm_is_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    content = bare()
    content["link2_mm"]["value"] = 225.0
    run(tmp_path, "x_mm,y_mm\n300,300\n388.9,388.9\n", content=content)
    assert (
        "in line 3 a joint is corrected by more than 0.2°: the arm is nearly stretched"
        in capsys.readouterr().err
    )


def test_a_program_leaves_no_row_out(tmp_path: Path) -> None:
    with pytest.raises(MeasurementRejectedError, match=r"line 3 .*a program leaves no row out"):
        run(tmp_path, JOINTS + "45,60,1,1\n120,60,1,1\n", "melfa", cell=cell(tmp_path))
    assert not (tmp_path / "out.melfa").exists()


def test_a_program_takes_what_it_needs_from_the_cell(tmp_path: Path) -> None:
    text = run(tmp_path, JOINTS + "45,60,1,1\n", "melfa", cell=cell(tmp_path), j4=12.5).read_text()
    assert "Ovrd 20" in text
    assert ",50.000,12.500)" in text
    with pytest.raises(UsageError, match="needs --cell FILE"):
        run(tmp_path, JOINTS + "45,60,1,1\n", "melfa")
    with pytest.raises(LimitError, match="--j4 400"):
        run(tmp_path, JOINTS + "45,60,1,1\n", "melfa", cell=cell(tmp_path), j4=400.0)


def test_limits_of_the_joints_are_kept(tmp_path: Path) -> None:
    with pytest.raises(LimitError, match="line 2: the corrected command needs J1 = "):
        run(tmp_path, JOINTS + "45,60,1,1\n", cell=cell(tmp_path, "[-170.0, 44.0]"))


def box(x_mm: float, y_mm: float) -> str:
    """Return a box of 2 mm around a place, for a cell file."""
    low, high = ([x_mm + d, y_mm + d, z] for d, z in ((-1.0, 0.0), (1.0, 300.0)))
    return f'\n[[workspace.keep_out]]\nname = "press"\nmin_mm = {low}\nmax_mm = {high}\n'


def cell_with_a_box(folder: Path, theta1_deg: float, theta2_deg: float) -> Path:
    """Return a cell file with a box where the arm would stand at these angles."""
    x_mm, y_mm = place(theta1_deg, theta2_deg, 1, 1)
    return text_file(folder, TEMPLATE + box(x_mm, y_mm), "cell.toml")


@pytest.mark.parametrize("form", ["csv", "json", "melfa"])
@pytest.mark.parametrize(
    ("boxed_deg", "line", "what"),
    [
        ((45.0, 60.0), 2, "the take-up before it"),
        ((60.0, 60.0), 3, "the corrected command"),
        ((52.5, 60.0), 3, "the corrected command"),
        ((75.0, 60.0), 4, "the corrected command"),
    ],
)
def test_bodies_in_the_way_are_refused(
    tmp_path: Path, form: str, boxed_deg: tuple[float, float], line: int, what: str
) -> None:
    path = JOINTS + "45,60,1,1\n60,60,1,1\n75,60,1,1\n"
    with pytest.raises(LimitError) as caught:
        run(tmp_path, path, form, cell=cell_with_a_box(tmp_path, *boxed_deg))
    text = str(caught.value)
    assert text.startswith(f"line {line}: {what} cannot be driven to: the keep-out box press stands")
    assert "runs into it (5 mm are kept free)" in text
    assert not (tmp_path / f"out.{form}").exists()


@pytest.mark.parametrize("boxed_deg", [(45.0, 60.0), (75.0, 60.0)])
def test_refused_bodies_come_with_a_remedy_of_this_command(
    tmp_path: Path, boxed_deg: tuple[float, float]
) -> None:
    path = JOINTS + "45,60,1,1\n60,60,1,1\n75,60,1,1\n"
    with pytest.raises(LimitError) as caught:
        run(tmp_path, path, cell=cell_with_a_box(tmp_path, *boxed_deg))
    text = str(caught.value)
    assert "take the row out, or choose the other hand or another path" in text
    assert "pendant" not in text
    assert "target" not in text


def test_the_first_take_up_is_refused_where_it_is(tmp_path: Path) -> None:
    # The box stands at the command; the take-up before it is near enough to be refused first.
    with pytest.raises(LimitError, match="line 2: the take-up before it") as caught:
        run(tmp_path, JOINTS + "45,60,1,1\n75,60,1,1\n", cell=cell_with_a_box(tmp_path, 45.0, 60.0))
    named = re.search(r"near J1 ([\d.]+)°, J2 ([\d.]+)°", str(caught.value))
    assert named is not None
    # The template's take-up overshoots by 1 degree, the corrections are some millidegrees.
    assert [float(angle) for angle in named.groups()] == pytest.approx([44.0, 59.0], abs=0.06)


def test_bodies_are_looked_at_with_the_angle_of_j4(tmp_path: Path) -> None:
    # The interferometer head reaches out from the J4 axis, to the side that J4 turns it to.
    x_mm, y_mm = place(45.0, 60.0, 1, 1)
    beside = text_file(tmp_path, TEMPLATE + box(x_mm, y_mm + 50.0), "cell.toml")
    path = JOINTS + "45,60,1,1\n"
    run(tmp_path, path, cell=beside, j4=-15.0)
    with pytest.raises(LimitError, match="interferometer head"):
        run(tmp_path, path, cell=beside, j4=165.0)


def test_without_a_cell_nothing_is_said_to_be_clear(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run(tmp_path, JOINTS + "45,60,1,1\n")
    assert "without --cell FILE neither the limits of the joints nor the bodies" in capsys.readouterr().err


@pytest.mark.parametrize("form", ["csv", "melfa"])
def test_the_cell_file_of_another_arm_is_refused(tmp_path: Path, form: str) -> None:
    other = text_file(tmp_path, TEMPLATE.replace("link1_mm = 325.0", "link1_mm = 400.0"), "other.toml")
    with pytest.raises(
        UsageError, match=r"nominal links 400 and 225 mm, that of result\.json 325 and 225 mm"
    ):
        run(tmp_path, "x_mm,y_mm\n300,300\n", form, cell=other)
    assert not (tmp_path / f"out.{form}").exists()


def test_the_result_is_not_written_over(tmp_path: Path) -> None:
    result = stored(tmp_path, bare())
    before = result.read_bytes()
    path = text_file(tmp_path, "x_mm,y_mm\n300,300\n")
    with pytest.raises(UsageError, match="would be lost"):
        compensate(result, result, path, "json", "right", "1,1", None, 0.0, as_json=False)
    assert result.read_bytes() == before


def test_tables_need_no_path_and_are_one_a_joint(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run(tmp_path, None, "kw-ssfk", as_json=True)
    facts = json.loads(capsys.readouterr().out)
    assert facts["output"] == [str(tmp_path / f"out-j{joint}.kw-ssfk") for joint in (1, 2)]
    first = (tmp_path / "out-j1.kw-ssfk").read_text(encoding="utf-8")
    assert [line.split() for line in first.splitlines() if ".table[1]." in line] == [
        ["kw.ssfk.table[1].setpoint", "900000"],
        ["kw.ssfk.table[1].pos", "300"],
        ["kw.ssfk.table[1].neg", "100"],
    ]
    with pytest.raises(UsageError, match="omit --path"):
        run(tmp_path, JOINTS + "45,60,1,1\n", "kw-ssfk")
    with pytest.raises(UsageError, match="a conventional result holds no maps"):
        run(tmp_path, None, "kw-ssfk", content=bare("conventional"))


def test_a_path_is_needed_and_a_conventional_result_will_do(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="--format csv needs --path FILE"):
        run(tmp_path, None)
    (row,) = rows_of(run(tmp_path, JOINTS + "45,60,1,1\n", content=bare("conventional")))
    one, both = (math.radians(float(row["theta1_deg"])), 0.0)
    both = one + math.radians(float(row["theta2_deg"]) + 0.020)
    found = (LINK1 * math.cos(one) + LINK2 * math.cos(both), LINK1 * math.sin(one) + LINK2 * math.sin(both))
    assert found == pytest.approx((float(row["x_mm"]), float(row["y_mm"])), abs=1e-5)


def test_the_summary_is_data(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run(tmp_path, JOINTS + "45,60,1,1\n46,60,1,1\n", as_json=True)
    facts = json.loads(capsys.readouterr().out)
    assert (facts["rows"], facts["corrected"], facts["take_ups"]) == (2, 2, 1)
    assert facts["largest_rounding_um"] < 7.0


def turned_deg(row: dict[str, str], one: float, two: float, four: float) -> float:
    """Return the world angle of the tool on the arm of `arms.bare` at joint commands, by hand."""
    first = one + 1e-3 * (10.0 * int(row["direction1"]) + 20.0 * one / 90.0)
    return first + two + 0.005 * int(row["direction2"]) + four


def test_the_tools_orientation_is_kept_in_every_form(tmp_path: Path) -> None:
    path = "line,x_mm,y_mm,z_mm,c_deg\n1,200,400,45,90\n1,150,420,50,90\n2,250,300,55,-120\n"
    file = text_file(
        tmp_path, TEMPLATE.replace("j3_range_mm = [40.0, 60.0]", "j3_range_mm = [30.0, 70.0]"), "cell.toml"
    )
    table = rows_of(run(tmp_path, path, cell=file))
    document = json.loads(run(tmp_path, path, "json", cell=file).read_text(encoding="utf-8"))
    wished = [(1, 45.0, 90.0), (1, 50.0, 90.0), (2, 55.0, -120.0)]
    for row, same, (line, z_mm, c_deg) in zip(table, document["rows"], wished, strict=True):
        assert (int(row["line"]), float(row["z_mm"]), float(row["c_deg"])) == (line, z_mm, c_deg)
        turned = turned_deg(row, float(row["theta1_deg"]), float(row["theta2_deg"]), float(row["j4_deg"]))
        assert (turned - c_deg) % 360.0 == pytest.approx(0.0, abs=2e-6) or turned == pytest.approx(c_deg)
        assert float(row["j3_mm"]) == z_mm
        assert {name: float(value) for name, value in same.items()} == {n: float(v) for n, v in row.items()}
    program = run(tmp_path, path, "melfa", cell=file).read_text(encoding="utf-8")
    constants = [
        [float(value) for value in found.split(",")]
        for found in re.findall(r"JC=\((.*?)\)\r?\n\d+ Mov JC\r?\n\d+ Dly", program)
    ]
    for row, (one, two, height, four), (_, z_mm, c_deg) in zip(table, constants, wished, strict=True):
        # Three decimals of three joints.
        assert (turned_deg(row, one, two, four) - c_deg + 1.0) % 360.0 == pytest.approx(1.0, abs=6e-4)
        assert height == z_mm
    assert "J3 keeps the height of the path" in program
    assert "line 2, row 3: x 250.000" in program


def test_a_height_beyond_the_cell_is_refused(tmp_path: Path) -> None:
    path = "x_mm,y_mm,z_mm\n200,400,65\n"
    with pytest.raises(LimitError, match=r"line 2: .* needs J3 = 65\.000 mm, outside its limits 40mm…60mm"):
        run(tmp_path, path, cell=cell(tmp_path))


def test_an_orientation_leaves_no_choice_of_j4(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="states c_deg, from which J4 follows: omit --j4"):
        run(tmp_path, "x_mm,y_mm,c_deg\n200,400,0\n", j4=10.0)


def test_the_corrected_file_can_be_driven(tmp_path: Path) -> None:
    path = "line,x_mm,y_mm,z_mm,c_deg\n1,200,400,45,90\n1,150,420,50,90\n2,250,300,55,-120\n"
    params = parse_params(PathParams, [f"joints={run(tmp_path, path)}"])
    assert isinstance(params, PathParams)
    assert [(row.line, row.j3_mm) for row in params.joints] == [(1, 45.0), (1, 50.0), (2, 55.0)]
    assert all(row.j4_deg is not None for row in params.joints)
