"""The section of a report on a ballbar: Table XII by hand from readings."""

from typing import cast

import numpy as np
import pytest

from catseye.app.results.figures import Figure, Points
from catseye.app.results.model import Statement, Table
from catseye.app.results.serial_arm.ballbar_report import ballbar_section
from catseye.app.store.reader import RunReader
from catseye.procedures.kit.records import Json

ERRORS_MM = {"nest1": [0.1, -0.2, 0.1], "nest2": [0.3, 0.5]}


class Readings:
    """A run with readings."""

    def rows(self, table: str) -> list[dict[str, Json]]:
        assert table == "ballbar"
        return [{"nest": nest, "error_mm": error} for nest, errors in ERRORS_MM.items() for error in errors]


class Nothing:
    """A run without any."""

    def rows(self, table: str) -> list[dict[str, Json]]:
        del table
        return []


def test_errors_of_length_by_nest() -> None:
    blocks = ballbar_section(cast("RunReader", Readings())).blocks
    (table,) = [block for block in blocks if isinstance(block, Table)]
    first, second = table.rows
    assert first[:2] == ("nest1", 3)
    assert first[2:] == pytest.approx((0.0, 0.03**0.5, 0.2))
    assert second[:2] == ("nest2", 2)
    assert second[2:] == pytest.approx((0.4, 0.02**0.5, 0.5))


def test_the_largest_error_of_length_stands_for_the_run() -> None:
    blocks = ballbar_section(cast("RunReader", Readings())).blocks
    (said,) = [block for block in blocks if isinstance(block, Statement)]
    assert said.text == "5 lengths, off by 0.500 mm at most, +0.160 mm on average."
    assert said.short == "lengths off ≤ 0.500 mm"


def test_errors_are_drawn_in_their_order_by_nest() -> None:
    blocks = ballbar_section(cast("RunReader", Readings())).blocks
    (figure,) = [block for block in blocks if isinstance(block, Figure)]
    drawn = [
        mark.y
        for row in figure.rows
        for panel in row
        if panel is not None
        for mark in panel.marks
        if isinstance(mark, Points)
    ]
    assert [np.asarray(values).tolist() for values in drawn] == list(ERRORS_MM.values())


def test_a_run_without_readings_has_no_ballbar() -> None:
    assert ballbar_section(cast("RunReader", Nothing())).blocks == ()
