"""What compensate checks before it writes, and what it says about a corrected path."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from catseye.app.analysis.compensating import CompensatedPath, require_clear, require_limits
from catseye.app.analysis.path_range import lines_text
from catseye.app.cell.bench import bench_of
from catseye.app.cell.load import load_cell
from catseye.app.cell.model import Cell
from catseye.app.cli.output import table
from catseye.app.errors import LimitError, MeasurementRejectedError, UsageError
from catseye.app.files.compensated_path import Origin
from catseye.app.files.identified_arm import nominal_of
from catseye.app.files.melfa_program import MelfaSettings
from catseye.app.files.result_json import Result
from catseye.app.report.numbers import counted
from catseye.app.store.software import SOFTWARE

_LARGE_DEG = 0.2
"""No joint of a sound arm needs such a correction; a stretched arm pays for its reach with it."""

_UNCHECKED = (
    "without --cell FILE neither the limits of the joints nor the bodies of the arm and around it were checked: "
    "give the cell file before anything is driven"
)


def origin_of(path: Path, result: Result) -> Origin:
    """Return what the files that are written say about where they come from."""
    return Origin(
        path.name,
        result.model,
        result.gauge,
        (result.link1_mm.value, result.link2_mm.value),
        nominal_of(result)[0],
        result.provenance.created or "at an unknown time",
        SOFTWARE,
        datetime.now(UTC).isoformat(timespec="seconds"),
        tuple(result.provenance.unverified or ()),
    )


def cell_of(file: Path, origin: Origin) -> Cell:
    """Return the cell of the arm that was identified."""
    cell = load_cell(file).cell
    links = (cell.robot.link1_mm, cell.robot.link2_mm)
    if links != origin.nominal_mm:
        raise UsageError(
            f"{file}: its arm has the nominal links {links[0]:g} and {links[1]:g} mm, that of {origin.result} "
            f"{origin.nominal_mm[0]:g} and {origin.nominal_mm[1]:g} mm: take the cell file of the arm that was "
            "identified"
        )
    return cell


def settings_of(cell: Cell | None, j4_deg: float) -> MelfaSettings:
    """Return what a program takes from the cell file.

    Raises:
        UsageError: there is none.
    """
    if cell is None:
        raise UsageError(
            "--format melfa needs --cell FILE: the program takes the height of J3, the cap of the speed, the limits "
            "of the joints, take-up and settling time from there"
        )
    return MelfaSettings(
        cell.robot.j3_mm, j4_deg, cell.robot.override_cap_percent, cell.measurement.settle_time_s
    )


def checked(path: CompensatedPath, file: Path, form: str, cell: Cell | None, j4_deg: float) -> list[str]:
    """Refuse what cannot be driven; return what has to be known about the rest."""
    lines = [row.line for row in path.path.rows]
    unsolved = _unsolved_text(path, lines)
    solved = path.solution.solved
    if unsolved and (form == "melfa" or not solved.any()):
        why = "nothing is left to correct" if not solved.any() else "a program leaves no row out"
        raise MeasurementRejectedError(f"{file}: {unsolved}; {why}, and nothing was written")
    if cell is not None:
        _require_drivable(path, lines, cell, j4_deg)
    unchecked = _UNCHECKED if cell is None else ""
    return [text for text in (unsolved, unchecked, *_advice(path, lines)) if text]


def _require_drivable(path: CompensatedPath, lines: list[int], cell: Cell, j4_deg: float) -> None:
    limits = cell.robot.limits_deg
    low, high = limits.j4
    if not low <= j4_deg <= high:
        raise LimitError(f"--j4 {j4_deg:g} is outside the limits {low:g}°…{high:g}° of the cell file")
    require_limits(path, _range(limits.j1), _range(limits.j2), lines)
    require_clear(path, bench_of(cell), j4_deg, lines)


def _range(limits: list[float]) -> tuple[float, float]:
    return limits[0], limits[1]


def _unsolved_text(path: CompensatedPath, lines: list[int]) -> str:
    solution = path.solution
    far, beyond = ~solution.reachable, solution.reachable & ~solution.inside
    parts = []
    if far.any():
        parts.append(f"the identified arm does not reach the positions of {lines_text(lines, far)}")
    if beyond.any():
        parts.append(
            f"the corrected commands of {lines_text(lines, beyond)} lie outside the nodes of the maps, which are "
            "never extrapolated: identify with nodes that enclose them"
        )
    return "; ".join(parts)


def _advice(path: CompensatedPath, lines: list[int]) -> list[str]:
    texts = []
    loose = path.loose_mm > 0.0
    if loose.any():
        texts.append(
            f"{counted(int(loose.sum()), 'row')} ({lines_text(lines, loose)}) begin or reverse the motion of a joint "
            "and need a take-up (columns take_up1, take_up2): without it the arm may stand up to "
            f"{1e3 * np.nanmax(path.loose_mm):.0f} µm off"
        )
    against = np.logical_or(path.contradicted[:, 0], path.contradicted[:, 1])
    if against.any():
        texts.append(
            f"in {lines_text(lines, against)} the step to the row goes against the side from which it has to be "
            "approached: only a take-up gets there from that side"
        )
    large = np.any(np.abs(np.rad2deg(path.correction_rad)) > _LARGE_DEG, axis=1)
    if large.any():
        texts.append(
            f"in {lines_text(lines, large)} a joint is corrected by more than {_LARGE_DEG:g}°: the arm is nearly "
            "stretched or folded there, where little reach takes much of its angles; keep away from it"
        )
    return texts


def correction_facts(path: CompensatedPath) -> dict[str, Any]:
    """Return a corrected path in a few numbers."""
    solved = path.solution.solved
    correction_mdeg = 1e3 * np.rad2deg(np.abs(path.correction_rad[solved]))
    shift_um = 1e3 * np.hypot(*path.shift_mm[solved].T)
    u_um = 1e3 * np.hypot(*path.solution.u_mm[solved].T)
    rounding_um = 1e3 * path.rounding_mm[solved]
    return {
        "rows": int(solved.size),
        "corrected": int(solved.sum()),
        "largest_correction1_mdeg": float(correction_mdeg[:, 0].max()),
        "largest_correction2_mdeg": float(correction_mdeg[:, 1].max()),
        "rms_shift_um": float(np.sqrt(np.mean(shift_um**2))),
        "largest_shift_um": float(shift_um.max()),
        "median_u_um": float(np.median(u_um)),
        "largest_rounding_um": float(np.nanmax(rounding_um)),
        "take_ups": int(path.take_up.any(axis=1).sum()),
    }


def correction_table(facts: dict[str, Any]) -> str:
    """Return the same numbers as a table."""
    rows = [
        ["rows corrected", "", f"{facts['corrected']} of {facts['rows']}"],
        ["largest correction of J1", "mdeg", f"{facts['largest_correction1_mdeg']:.1f}"],
        ["largest correction of J2", "mdeg", f"{facts['largest_correction2_mdeg']:.1f}"],
        ["correction in the plane, rms", "µm", f"{facts['rms_shift_um']:.1f}"],
        ["correction in the plane, largest", "µm", f"{facts['largest_shift_um']:.1f}"],
        ["standard uncertainty left, 2-D median", "µm", f"{facts['median_u_um']:.1f}"],
        ["left by steps of 1 mdeg, largest", "µm", f"{facts['largest_rounding_um']:.1f}"],
        ["rows that need a take-up", "", f"{facts['take_ups']}"],
    ]
    return table(["corrected commands", "unit", "value"], rows)
