"""Readers get expanded uncertainties, k = 2, everywhere; data hold standard ones."""

import ast
import re
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np
import pytest

import catseye.app
from catseye.app.render.cells import cell_text
from catseye.app.render.page import page_html
from catseye.app.results.figures import Band, Figure, Points, Role
from catseye.app.results.model import Column, Quantity, Report, Table
from catseye.app.results.numbers import CONVENTION_OF_U, fixed
from catseye.app.results.resolution.report_files import ReportFiles
from catseye.app.results.resolution.result_report import resolution_report
from catseye.app.results.runs.records import Sources
from catseye.app.results.scara.values import parameter_table
from catseye.app.results.serial_arm.calibration_report import calibration_report
from tests.unit.app.results.resolution.sample import sample_result
from tests.unit.app.results.scara.sample import hand_made, whole
from tests.unit.app.results.serial_arm.sample import sample_calibration

APP: Final = Path(catseye.app.__path__[0])
RATIOS: Final = ("in u", "/ u", "/u", " 2 u", "±2 u")
"""Ends of titles of what is counted in standard uncertainties."""


def column_calls() -> Iterator[tuple[str, str, str, bool]]:
    """Yield place, key, title and declaration of every column in the source."""
    for path in sorted(APP.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Column":
                key, title = (ast.unparse(part).removeprefix("f").strip("'\"") for part in node.args[:2])
                declared = any(one.arg == "standard" for one in node.keywords)
                yield f"{path.name}:{node.lineno}", key, title, declared


@cache
def scara() -> Report:
    return whole().report


@cache
def serial_arm() -> Report:
    return calibration_report("Calibration", sample_calibration())


@cache
def resolution() -> Report:
    return resolution_report("Resolution", ReportFiles((sample_result(),)), Sources())


every_report = pytest.mark.parametrize(
    "report", [scara, serial_arm, resolution], ids=lambda made: made.__name__
)


def shown(table: Table, key: str) -> list[str]:
    """Return a column as a reader sees it."""
    place = [column.key for column in table.columns].index(key)
    return [cell_text(row[place], table.columns[place]) for row in table.rows]


def test_no_column_is_titled_with_a_standard_uncertainty() -> None:
    found = [
        (place, title)
        for place, _, title, _ in column_calls()
        if re.search(r"\bu\b|k ?= ?1", title) and not title.endswith(RATIOS)
    ]
    assert found == []


def test_a_column_titled_with_u_declares_itself() -> None:
    columns = list(column_calls())
    assert sum(declared for *_, declared in columns) > 30
    titled = [one for one in columns if re.search(r"\bU\b", one[2])]
    # Those whose cells are expanded already say so in their key.
    assert [one for one in titled if not one[3] and "expanded" not in one[1] and one[1] != "figure"] == []
    assert [one for one in columns if one[3] and not re.search(r"\bU\b", one[2]) and one[2] != "name"] == []


@every_report
def test_tables_of_samples_show_no_standard_uncertainty(report: Callable[[], Report]) -> None:
    tables = [block for block in report().blocks() if isinstance(block, Table)]
    for table in tables:
        for column in table.columns:
            bare = re.search(r"\bu\b", column.title) and not column.title.endswith(RATIOS)
            assert not bare, (table.key, column.title)


@every_report
def test_figures_with_error_bars_say_k_once(report: Callable[[], Report]) -> None:
    for figure in (block for block in report().blocks() if isinstance(block, Figure)):
        marks = [mark for row in figure.rows for panel in row if panel for mark in panel.marks]
        assert "k = 1" not in figure.caption
        if any(isinstance(mark, Points) and mark.u is not None for mark in marks):
            assert figure.caption.count("k = 2") == 1, figure.key


@every_report
def test_a_report_says_once_what_u_is(report: Callable[[], Report]) -> None:
    page = page_html(report())
    assert page.count(CONVENTION_OF_U) == 1
    assert "k = 1" not in page


def test_a_declared_cell_is_shown_twice_as_large() -> None:
    column = Column("u_mm", "U", "mm", fixed(2), standard=True)
    assert cell_text(0.21, column) == "0.42"
    assert cell_text(Quantity(0.21, fixed(3)), column) == "0.420"
    assert cell_text(None, column) == "–"
    plain = Column("x_mm", "x", "mm", fixed(2))
    assert (cell_text(0.21, plain), cell_text(Quantity(0.21, fixed(2), standard=True), plain)) == (
        "0.21",
        "0.42",
    )


def test_a_declared_cell_is_not_doubled_twice() -> None:
    column = Column("u_mm", "U", "mm", fixed(2), standard=True)
    assert cell_text(Quantity(0.21, fixed(2), standard=True), column) == "0.42"


def test_bars_and_bands_are_twice_their_standard_uncertainty() -> None:
    x, y, u = np.array([0.0, 1.0]), np.array([5.0, 6.0]), np.array([0.5, 1.0])
    assert Points(x, y, Role.CHANGE).half_bar is None
    half = Points(x, y, Role.CHANGE, u=u).half_bar
    assert half is not None
    assert half.tolist() == [1.0, 2.0]
    band = Band.around(x, y, u, Role.EXPECTED)
    assert (band.low.tolist(), band.high.tolist()) == ([4.0, 4.0], [6.0, 8.0])


def test_places_of_a_search_show_twice_their_u() -> None:
    table = scara().table("search")
    # Programs get them as they are.
    assert [row[2] for row in table.rows] == [0.21, 0.25]
    assert shown(table, "u_x_mm") == ["0.42", "0.50"]
    assert shown(table, "u_aim_mm") == ["0.30", "0.28"]


def test_links_of_a_result_show_twice_their_u() -> None:
    result = hand_made()
    (l1, *_) = parameter_table(result).rows
    assert l1[0] == "L1"
    assert shown(parameter_table(result), "u")[0] == f"{2.0 * result.link1_mm.u:.4f}"


def test_parameters_of_a_serial_arm_show_twice_their_u() -> None:
    result = sample_calibration()
    identified = next(one for one in result.parameters if one.identified)
    table = serial_arm().table("parameters")
    text = dict(zip((str(row[0]) for row in table.rows), shown(table, "u"), strict=True))[identified.name]
    assert float(text) == pytest.approx(2.0 * identified.u, rel=0.01)


def test_reversal_errors_of_a_joint_show_twice_their_u() -> None:
    result = sample_result()
    found = next(test.reversal for test in result.tests if test.reversal is not None)
    table = resolution().table("reversal")
    assert found.u is not None
    assert float(shown(table, "u_expanded")[0].rstrip("°")) == pytest.approx(2.0 * found.u, rel=0.1)
