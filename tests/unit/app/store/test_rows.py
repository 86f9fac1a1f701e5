"""What fits a table."""

import math
from pathlib import Path
from typing import Any

import pytest

from catseye.app.store.rows import encode
from catseye.procedures.kit.records import Json, Record, row_of, table_of
from catseye.procedures.scara.records import PathPosition, ScrewTurn, SeenReflector
from tests.unit.app.store.fakes import PATH_ROW, SEARCH_ROW


def test_values_follow_column_order_and_extras_become_json() -> None:
    row = {**SEARCH_ROW, "lower_deg": 3, "note": "weak"}
    assert encode(table_of(SeenReflector), row) == ("P1", 1.0, 2.0, None, 3.0, None, None, '{"note":"weak"}')


@pytest.mark.parametrize(
    ("record", "name", "value"),
    [
        (SeenReflector, "theta1_deg", float("nan")),
        (SeenReflector, "theta1_deg", "1.0"),
        (SeenReflector, "theta1_deg", True),
        (SeenReflector, "reflector", 3),
        (SeenReflector, "signal", float("inf")),
        (PathPosition, "direction1", 1.0),
        (PathPosition, "direction1", True),
        (SeenReflector, "note", float("nan")),
    ],
)
def test_what_would_not_come_back_as_it_was_is_refused(record: type[Record], name: str, value: Json) -> None:
    row = {**(PATH_ROW if record is PathPosition else SEARCH_ROW), name: value}
    with pytest.raises(ValueError, match=f"{name}|JSON"):
        encode(table_of(record), row)


@pytest.mark.parametrize(
    ("record", "name", "value", "text"),
    [
        (
            SeenReflector,
            "theta1_deg",
            "1.0",
            r"search\.theta1_deg = '1.0' is a str: it takes a finite number",
        ),
        (SeenReflector, "reflector", 3, r"search\.reflector = 3 is a int: it takes a str"),
        (PathPosition, "direction1", 1.0, r"path\.direction1 = 1.0 is a float: it takes an int"),
        (SeenReflector, "note", {1, 2}, r"search: note = \{1, 2\} is a set, which JSON cannot carry"),
        (
            SeenReflector,
            "note",
            {"at": [0, Path()]},
            r"search: note\.at\[1\] = .* is a pathlib\.\w+, which",
        ),
        (SeenReflector, "note", [math.nan], r"search: note\[0\] = nan: only a finite number"),
    ],
)
def test_what_is_refused_is_named_with_table_key_and_type(
    record: type[Record], name: str, value: Any, text: str
) -> None:
    row = {**(PATH_ROW if record is PathPosition else SEARCH_ROW), name: value}
    with pytest.raises(ValueError, match=text):
        encode(table_of(record), row)


def test_all_missing_columns_are_named() -> None:
    with pytest.raises(ValueError, match="lacks theta1_deg, theta2_deg"):
        encode(table_of(SeenReflector), {"reflector": "P1"})


@pytest.mark.parametrize("name", ["kind", "turns", "step_id", "seq", "extra"])
def test_a_further_value_hides_no_column(name: str) -> None:
    record = ScrewTurn(screw="stage", turns=0.5, round=1, text="turn it", extra={name: 1})
    with pytest.raises(ValueError, match=f"extra has {name}"):
        row_of(record)
