"""Measured CSV: where an independent instrument saw the arm along a path (version 1)."""

from functools import partial
from pathlib import Path

from catseye.app.errors import UsageError
from catseye.app.files.csv_table import CsvRow, csv_rows, misnamed, require_file
from catseye.procedures.kit.context import MeasuredPoint

JOINTS = ("theta1_deg", "theta2_deg")
DIRECTIONS = ("direction1", "direction2")
PLACE = ("x_mm", "y_mm")
MEASURED = ("x_meas_mm", "y_meas_mm")
UNCERTAINTY = "u_mm"

_FORMS = f"{','.join(JOINTS + DIRECTIONS + MEASURED)}[,u_mm] or {','.join(PLACE + MEASURED)}[,u_mm]"


def read_measured_csv(path: Path) -> list[MeasuredPoint]:
    """Read the positions that an independent instrument measured along a path.

    The commands stand in the joint form or in the Cartesian form, never in both.

    Args:
        path: the file.

    Raises:
        UsageError: the file is missing, a column is missing, a value is wrong; names file and line.
    """
    points = [_point(row) for row in csv_rows(path, _FORMS, partial(_check, path))]
    if not points:
        raise UsageError(f"{path}: holds no points; each row below the header line is one position")
    return points


def read_typed_csv(file: str) -> list[MeasuredPoint]:
    """Read the same from a file as somebody typed it.

    Raises:
        UsageError: likewise, or it is no regular file, or ~ stands for no folder.
    """
    try:
        path = Path(file.strip()).expanduser().absolute()
    except RuntimeError as error:
        raise UsageError(f"{file}: {error}; type the whole path") from error
    require_file(path)
    return read_measured_csv(path)


def _check(path: Path, line: int, header: list[str]) -> None:
    if "displacement_mm" in header:
        raise UsageError(
            f"{path}:{line}: the file holds distances to reflectors, and positions are needed: x_meas_mm, y_meas_mm. "
            "A path of distances is compared by catseye report on its run of validation-path"
        )
    joint_form = any(name in header for name in JOINTS + DIRECTIONS)
    if joint_form and any(name in header for name in PLACE):
        raise UsageError(
            f"{path}:{line}: joint and Cartesian commands stand in one file; keep either "
            f"{','.join(JOINTS + DIRECTIONS)} or {','.join(PLACE)}"
        )
    commands = JOINTS + DIRECTIONS if joint_form else PLACE
    missing = [name for name in commands + MEASURED if name not in header]
    if missing:
        raise UsageError(
            f"{path}:{line}: column {', '.join(missing)} is missing; {_why(missing)}the header has to be {_FORMS}, "
            "comma separated"
        )
    if fault := misnamed(header, (*commands, *MEASURED, UNCERTAINTY)):
        raise UsageError(f"{path}:{line}: {fault}; allowed are {_FORMS}")


def _why(missing: list[str]) -> str:
    if set(missing) <= set(DIRECTIONS):
        return "joint commands need the state of approach of each joint, 1 or -1; "
    return ""


def _point(row: CsvRow) -> MeasuredPoint:
    joint_form = JOINTS[0] in row.cells
    return MeasuredPoint(
        line=row.line,
        theta_deg=(row.finite(JOINTS[0]), row.finite(JOINTS[1])) if joint_form else None,
        directions=(row.direction(DIRECTIONS[0]), row.direction(DIRECTIONS[1])) if joint_form else None,
        command_mm=None if joint_form else (row.finite(PLACE[0]), row.finite(PLACE[1])),
        x_meas_mm=row.finite(MEASURED[0]),
        y_meas_mm=row.finite(MEASURED[1]),
        u_mm=row.positive(UNCERTAINTY) if UNCERTAINTY in row.cells else None,
    )
