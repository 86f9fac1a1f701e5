"""Compensated path as CSV and JSON (version 1)."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from catseye.app.files.atomic import write_atomically
from catseye.app.files.csv_text import csv_text
from catseye.app.protocol.banners import unverified_text
from catseye.app.results.scara.compensation import STEP_DEG, CompensatedPath
from catseye.app.results.scara.path_csv import PLACE
from catseye.calibration.core.types import Bools, Floats, Ints

FORMAT = "catseye-compensation/1"

COLUMNS = {
    "line": ("line of the path that the row belongs to", 0),
    "x_mm": ("where the arm shall stand", 6),
    "y_mm": ("where the arm shall stand", 6),
    "z_mm": ("height of the tool, kept as it is", 6),
    "c_deg": ("orientation of the tool in the world, kept as it is", 6),
    "speed_mm_s": ("speed along the path, kept as it is", 6),
    "theta1_deg": ("corrected command of J1", 6),
    "theta2_deg": ("corrected command of J2", 6),
    "j3_mm": ("command of J3, for that height", 6),
    "j4_deg": ("command of J4, for that orientation beside the corrected J1 and J2", 6),
    "direction1": ("side from which J1 has to come: 1 from below, -1 from above", 0),
    "direction2": ("side from which J2 has to come", 0),
    "take_up1": ("1: overshoot with J1 and come back, otherwise the arm is not on that side", 0),
    "take_up2": ("the same for J2", 0),
    "correction1_mdeg": ("corrected minus uncorrected command of J1", 3),
    "correction2_mdeg": ("corrected minus uncorrected command of J2", 3),
    "shift_x_um": ("position of the nominal arm at the corrected command, minus the wished one", 3),
    "shift_y_um": ("the same along y", 3),
    "u_x_um": ("standard uncertainty (k = 1) of x, from that of the identified arm", 3),
    "u_y_um": ("the same of y", 3),
    "rounding_um": (f"miss when the command is rounded to {1e3 * STEP_DEG:g} mdeg", 3),
}
"""What each column means, and its decimals; a path that says nothing of line or tool has none of their columns."""

WISHED = ("line", *PLACE, "z_mm", "c_deg", "speed_mm_s")
"""Columns that a row has without a correction, too."""


@dataclass(frozen=True)
class Origin:
    """Where a compensation comes from.

    Attributes:
        result: name of the result file.
        model: of the result.
        gauge: of the result.
        links_mm: identified links.
        nominal_mm: links that uncorrected commands are calculated with.
        identified: when the result was made.
        software: that made the compensation.
        created: when, ISO 8601 UTC.
        unverified: what speaks against changed runs that the result was made of all the same.
    """

    result: str
    model: str
    gauge: str
    links_mm: tuple[float, float]
    nominal_mm: tuple[float, float]
    identified: str
    software: str
    created: str
    unverified: tuple[str, ...] = ()

    def sentences(self) -> list[str]:
        """Return what stands at the head of every form."""
        return [
            *map(unverified_text, self.unverified),
            f"made by {self.software} at {self.created} from {self.result} ({self.model}, identified "
            f"{self.identified})",
            f"gauge: {self.gauge}; distances cannot see a common turn of everything about J1",
            f"identified links {self.links_mm[0]:.4f} and {self.links_mm[1]:.4f} mm, nominal "
            f"{self.nominal_mm[0]:g} and {self.nominal_mm[1]:g} mm",
        ]


def compensated_columns(path: CompensatedPath) -> dict[str, list[float | None]]:
    """Return the columns; a row without a correction has its place and None elsewhere."""
    corrected, solved, tool = path.solution.commands, path.solution.solved, path.path.tool
    correction_mdeg, shift_um = 1e3 * np.rad2deg(path.correction_rad), 1e3 * path.shift_mm
    values: dict[str, Floats | Ints | Bools | None] = {
        "line": path.path.numbers,
        "x_mm": path.path.command_mm[:, 0],
        "y_mm": path.path.command_mm[:, 1],
        "z_mm": tool.z_mm,
        "c_deg": tool.c_deg,
        "speed_mm_s": tool.speed_mm_s,
        "theta1_deg": np.rad2deg(corrected.theta1_rad),
        "theta2_deg": np.rad2deg(corrected.theta2_rad),
        "j3_mm": path.j3_mm,
        "j4_deg": path.j4_deg,
        "direction1": corrected.direction1,
        "direction2": corrected.direction2,
        "take_up1": path.take_up[:, 0],
        "take_up2": path.take_up[:, 1],
        "correction1_mdeg": correction_mdeg[:, 0],
        "correction2_mdeg": correction_mdeg[:, 1],
        "shift_x_um": shift_um[:, 0],
        "shift_y_um": shift_um[:, 1],
        "u_x_um": 1e3 * path.solution.u_mm[:, 0],
        "u_y_um": 1e3 * path.solution.u_mm[:, 1],
        "rounding_um": 1e3 * path.rounding_mm,
    }
    return {
        name: _rounded(np.where(solved | (name in WISHED), column, np.nan), COLUMNS[name][1])
        for name, column in values.items()
        if column is not None
    }


def _rounded(column: Floats, decimals: int) -> list[float | None]:
    # Adding 0.0 turns a rounded −0 into 0.
    return [round(v, decimals) + 0.0 if np.isfinite(v) else None for v in column.tolist()]


def write_compensated_csv(path: CompensatedPath, origin: Origin, output: Path) -> None:
    """Write a row for each row of the path; cells of rows without a correction are empty."""
    columns = compensated_columns(path)
    rows = (
        [
            None if value is None else f"{value:.{COLUMNS[name][1]}f}"
            for name, value in zip(columns, row, strict=True)
        ]
        for row in zip(*columns.values(), strict=True)
    )
    write_atomically(output, csv_text(list(columns), rows, origin.sentences()))


def write_compensated_json(path: CompensatedPath, origin: Origin, take_up_deg: float, output: Path) -> None:
    """Write the same numbers with what they mean."""
    columns = compensated_columns(path)
    rows = [
        {name: _json_value(name, value) for name, value in zip(columns, row, strict=True)}
        for row in zip(*columns.values(), strict=True)
    ]
    document = {
        "format": FORMAT,
        "result": origin.result,
        "model": origin.model,
        "gauge": origin.gauge,
        "link1_mm": origin.links_mm[0],
        "link2_mm": origin.links_mm[1],
        "nominal": {"link1_mm": origin.nominal_mm[0], "link2_mm": origin.nominal_mm[1]},
        "take_up_deg": take_up_deg,
        "columns": {name: COLUMNS[name][0] for name in columns},
        "rows": rows,
        "provenance": {
            "software": origin.software,
            "created": origin.created,
            "identified": origin.identified,
            **({"unverified": list(origin.unverified)} if origin.unverified else {}),
        },
    }
    write_atomically(output, json.dumps(document, ensure_ascii=False, indent=1) + "\n")


def _json_value(name: str, value: float | None) -> float | int | None:
    return value if value is None or COLUMNS[name][1] else int(value)
