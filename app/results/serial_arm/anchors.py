"""Anchors CSV: the fixed ends of distances, known or to be found."""

from pathlib import Path

from catseye.app.files.columns import read_rows
from catseye.app.files.csv_lines import CsvRow, finite
from catseye.calibration.serial_arm.arm import Anchor
from catseye.procedures.kit.columns import ColumnRule, TableRule

_TABLE = TableRule(
    "anchors",
    "an anchor and its place",
    ((ColumnRule("u_mm", unit="mm", optional=True, positive=True),),),
    source="a file with the columns anchor,x_mm,y_mm,z_mm and, if known, u_mm",
)


def read_anchors(path: Path) -> dict[str, Anchor]:
    """Read anchors; one without a place is to be found.

    Raises:
        UsageError: the file is missing, a name stands twice, or a coordinate is no number; names file and line.
    """
    rows, columns = read_rows(path, _TABLE)
    found: dict[str, Anchor] = {}
    for k, row in enumerate(rows):
        name = row.cells.get("anchor", "")
        if not name:
            raise row.fault("the anchor has no name: state one in the column anchor")
        if name in found:
            raise row.fault(f"anchor {name!r} occurs twice: give each a name of its own")
        u_mm = columns.get("u_mm")
        found[name] = _anchor(row, name, None if u_mm is None else float(u_mm[k]))
    return found


def _anchor(row: CsvRow, name: str, u_mm: float | None) -> Anchor:
    cells = [row.cells.get(f"{axis}_mm", "") for axis in "xyz"]
    if not any(cells):
        return Anchor(name, u_mm=None)
    try:
        x, y, z = map(finite, cells)
    except ValueError as error:
        raise row.fault(
            f"anchor {name!r}: {', '.join(cells)} are not three numbers: state all, or none"
        ) from error
    return Anchor(name, (x, y, z), u_mm or 0.0)
