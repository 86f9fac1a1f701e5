"""What fits a table."""

import pytest

from catseye.app.store.rows import encode
from catseye.procedures.kit.context import Table
from catseye.procedures.kit.records import Json
from tests.unit.app.store.fakes import PATH_ROW, SEARCH_ROW


def test_values_come_in_the_tables_order_and_the_rest_as_json() -> None:
    row = {**SEARCH_ROW, "lower_deg": 3, "note": "weak"}
    assert encode("search", row) == ("P1", 1.0, 2.0, None, 3.0, None, None, '{"note":"weak"}')


@pytest.mark.parametrize(
    ("table", "name", "value"),
    [
        ("search", "theta1_deg", float("nan")),
        ("search", "theta1_deg", "1.0"),
        ("search", "theta1_deg", True),
        ("search", "reflector", 3),
        ("search", "signal", float("inf")),
        ("path", "direction1", 1.0),
        ("path", "direction1", True),
        ("search", "note", float("nan")),
    ],
)
def test_what_would_not_come_back_as_it_was_is_refused(table: Table, name: str, value: Json) -> None:
    row = {**(PATH_ROW if table == "path" else SEARCH_ROW), name: value}
    with pytest.raises(ValueError, match=f"{name}|JSON"):
        encode(table, row)


def test_all_missing_columns_are_named() -> None:
    with pytest.raises(ValueError, match="lacks theta1_deg, theta2_deg"):
        encode("search", {"reflector": "P1"})
