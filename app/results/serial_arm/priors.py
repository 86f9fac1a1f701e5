"""Priors CSV: what is known of an arm's parameters before anything is measured."""

from pathlib import Path

from catseye.app.files.columns import read_rows
from catseye.app.files.csv_lines import finite
from catseye.calibration.serial_arm.arm import Known
from catseye.procedures.kit.columns import ColumnRule, TableRule

_TABLE = TableRule(
    "priors",
    "a parameter and its standard uncertainty",
    ((ColumnRule("u", positive=True),),),
    source="a file with the columns name,u and, where it is not the nominal value, value",
)


def read_priors(path: Path) -> dict[str, Known]:
    """Read what is known beforehand, by the names that parameters have in results.

    Raises:
        UsageError: the file is missing, a name stands twice, or a value is no number; names file and line.
    """
    rows, columns = read_rows(path, _TABLE)
    found: dict[str, Known] = {}
    for row, u in zip(rows, columns["u"].tolist(), strict=True):
        name, value = row.cells.get("name", ""), row.cells.get("value", "")
        if not name or name in found:
            raise row.fault(
                f"parameter {name!r} occurs twice, or has no name: give each row a name of its own"
            )
        try:
            found[name] = Known(finite(value) if value else None, u)
        except ValueError as error:
            raise row.fault(
                f"value {value!r} of {name} is not a number: state one, or leave it empty"
            ) from error
    return found
