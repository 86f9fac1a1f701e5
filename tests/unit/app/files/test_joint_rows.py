"""Rows to be driven as they stand, and the parameter that takes them."""

from pathlib import Path

import pytest

from catseye.app.errors import UsageError
from catseye.app.files.columns import read_table
from catseye.app.protocol.procedures import parse_params
from catseye.procedures.scara.path.tables import JOINT_ROWS
from catseye.procedures.scara.path.validation_path import PathParams

HEADER = "x_mm,y_mm,theta1_deg,theta2_deg,direction1,direction2,u_x_um\n"


def written(folder: Path, text: str) -> Path:
    path = folder / "rows.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_rows_are_read_and_further_columns_passed_over(tmp_path: Path) -> None:
    path = written(tmp_path, f"# made by hand\n{HEADER}200,-400,-92.1037,72.5987,1,-1,5.4\n")
    found = read_table(path, JOINT_ROWS)
    assert found.stacked(HEADER.split(",")[:6]).tolist() == [[200.0, -400.0, -92.1037, 72.5987, 1.0, -1.0]]


def test_the_parameter_takes_the_rows_of_the_file(tmp_path: Path) -> None:
    path = written(tmp_path, HEADER + "200,-400,-92.1037,72.5987,1,-1,5.4\n")
    params = parse_params(PathParams, [f"joints={path}", "passes=2"])
    # As a run of an earlier version holds them.
    stored = {"joints": [[200.0, -400.0, -92.1037, 72.5987, 1.0, -1.0]], "passes": 2}
    assert params == PathParams.model_validate(stored)
    assert PathParams.model_validate_json(params.model_dump_json()) == params


def test_line_and_tool_come_with_the_rows(tmp_path: Path) -> None:
    text = f"line,{HEADER.strip()},j3_mm,j4_deg\n3,200,-400,-92.1,72.5,1,-1,5.4,45,-12.5\n"
    params = parse_params(PathParams, [f"joints={written(tmp_path, text)}"])
    assert isinstance(params, PathParams)
    (row,) = params.joints
    assert (row.line, row.direction2, row.j3_mm, row.j4_deg) == (3, -1, 45.0, -12.5)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("path.csv", "line,x_mm,y_mm,c_deg\n1,200,-400,30\n1,200,-300,30\n"),
        (
            "path.toml",
            '[[segment]]\nkind = "line"\nfrom = [200, -400]\nto = [200, -300]\npoints = 2\nc_deg = 30\n',
        ),
    ],
)
def test_the_parameter_takes_a_path_file(tmp_path: Path, name: str, text: str) -> None:
    file = tmp_path / name
    file.write_text(text, encoding="utf-8")
    params = parse_params(PathParams, [f"path={file}"])
    assert isinstance(params, PathParams)
    assert [(row.line, row.x_mm, row.y_mm, row.c_deg) for row in params.path] == [
        (1, 200.0, -400.0, 30.0),
        (1, 200.0, -300.0, 30.0),
    ]
    assert PathParams.model_validate_json(params.model_dump_json()) == params


@pytest.mark.parametrize(
    ("text", "part"),
    [
        (HEADER + "200,-400,,,,,\n", "rows.csv:2: has no corrected command"),
        (HEADER + "200,-400,1,2,1,0,\n", "rows.csv:2: direction2 = '0' is not 1 or -1"),
        (HEADER, "holds no rows"),
        ("theta1_deg,theta2_deg,direction1,direction2\n1,2,1,1\n", "column x_mm, y_mm is missing"),
        (f"x_mm,{HEADER}7,200,-400,1,2,1,-1,5\n", "rows.csv:1: column x_mm stands twice"),
    ],
)
def test_what_cannot_be_driven_is_refused(tmp_path: Path, text: str, part: str) -> None:
    with pytest.raises(UsageError, match=part):
        read_table(written(tmp_path, text), JOINT_ROWS)


def test_a_parameter_that_is_no_file_is_reported() -> None:
    with pytest.raises(UsageError, match="--param joints: 3 is not possible; it takes the name of a file"):
        parse_params(PathParams, ["joints=3"])
    with pytest.raises(UsageError, match="there is no such file"):
        parse_params(PathParams, ["joints=nowhere.csv"])
