"""Text in an exported table is never a formula of a spreadsheet, and comes back as it was."""

import csv
import io
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from catseye.app.files.csv_lines import cells_of
from catseye.app.files.csv_text import OwnWord, csv_text, marked, unmarked
from catseye.app.files.tabular import table_csv
from catseye.app.results.scara.points import COLUMNS, point_columns, points_csv, read_points
from catseye.procedures.kit.columns import Columns
from tests.unit.app.files.spreadsheet import formulas

FORMULAS = (
    "=1+1",
    "+1+1",
    "-2+3",
    "@SUM(A1)",
    "\t=1",
    "\r=1",
    "  =1+1",
    "=cmd|' /C calc'!A0",
    "-",
    "'=1",
    "''+x",
    "\uff1d1+1",
    " \uff20SUM(A1)",
    "x;=1+1",
    ";=1+1",
    ";\t-1+1",
    "x; @SUM(A1)",
    'x;"=1+1"',
    'x";"=1+1',
    "x;'=1+1",
    "x\t=1+1",
    "x\r=1+1",
    "x\n\uff0b1+1",
    "x;y;=1;=2",
)


def one_point(name: str) -> Columns:
    return point_columns([dict(zip(COLUMNS, (name, 0, -40.0, 20.0, 1, -1, -0.25), strict=True))])


@pytest.mark.parametrize("name", FORMULAS)
def test_no_writer_lets_a_text_become_a_formula(name: str) -> None:
    for written in (points_csv(one_point(name)), table_csv([{"reflector": name, name: -1.5}])):
        assert name not in [cell for line in csv.reader(io.StringIO(written)) for cell in line]
        assert formulas(written) == []


@pytest.mark.parametrize("name", [*FORMULAS, "x,=1+1", 'x,"=1+1"', "x, -1+1"])
def test_no_comment_becomes_a_formula(name: str) -> None:
    assert formulas(csv_text(["a"], [], [f"made from {name}", name])) == []


@pytest.mark.parametrize("text", ["a, -1", "[1.0, -2.5]", "P1;P2", "a-b; c=d", "half\nway"])
def test_what_is_no_formula_stays_as_it_is(text: str) -> None:
    assert marked(text) == text


@pytest.mark.parametrize("name", ["=1+1", "-P1", "@P", "'=P", "''-P", "'P", "P1"])
def test_a_points_file_gives_the_name_back(tmp_path: Path, name: str) -> None:
    path = tmp_path / "points.csv"
    path.write_text(points_csv(one_point(name)), encoding="utf-8")
    assert read_points(path, [name])["reflector"].tolist() == [0.0]


def test_numbers_stay_numbers() -> None:
    rows = [[-1.5, -2, "-3.25e-06", "+4", "-.5", None, True]]
    assert csv_text("abcdefg", rows) == "a,b,c,d,e,f,g\n-1.5,-2,-3.25e-06,+4,-.5,,True\n"


def test_a_comment_is_one_line() -> None:
    assert csv_text(["a"], [], ["made from x\n=1+1"]) == "# made from x =1+1\na\n"


@example(',=,"')
@given(st.text(st.sampled_from("'\"=-@#;,\t\r\n aé1"), max_size=10))
def test_no_text_becomes_a_formula(text: str) -> None:
    assert formulas(csv_text(["x", text], [[-1.5, text]], [text])) == []


@given(st.text(st.sampled_from("'\"=+-@;\t\r\n aé1"), max_size=8))
def test_each_text_comes_back(text: str) -> None:
    assert unmarked(marked(text)) == text


@given(st.text(st.sampled_from("'=+-@; aé1,\""), max_size=8).map(str.strip))
def test_each_text_comes_back_through_a_line(text: str) -> None:
    line = csv_text(["x", text], []).removesuffix("\n")
    assert cells_of(Path("t.csv"), 1, line) == ["x", text]


def test_a_word_of_the_program_stands_as_it_is() -> None:
    assert csv_text(["direction"], [[OwnWord("+X")], ["+X"]]) == "direction\n+X\n'+X\n"
