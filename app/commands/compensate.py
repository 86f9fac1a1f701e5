"""compensate: commands that bring the arm where it shall go, or tables that make its controller do so."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from catseye.app.analysis.compensating import CompensatedPath, compensate_path, require_clear, require_limits
from catseye.app.analysis.path_range import lines_text
from catseye.app.analysis.validation import TAKE_UP_DEG
from catseye.app.cell.bench import bench_of
from catseye.app.cell.load import load_cell
from catseye.app.cell.model import Cell
from catseye.app.commands.output import emit, emit_json, say, table
from catseye.app.errors import LimitError, MeasurementRejectedError, UsageError
from catseye.app.files.atomic import require_other_file, write_atomically
from catseye.app.files.compensated_path import Origin, write_compensated_csv, write_compensated_json
from catseye.app.files.identified_arm import arm_of, arm_remarks, nominal_of
from catseye.app.files.melfa_program import MelfaSettings, melfa_program
from catseye.app.files.path_csv import read_path_csv, start_states
from catseye.app.files.result_json import Result, read_result
from catseye.app.files.ssfk_table import maps_of, ssfk_table
from catseye.app.report.numbers import counted
from catseye.app.version import SOFTWARE
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.planar import Hand

_LARGE_DEG = 0.2
"""No joint of a sound arm needs such a correction; a stretched arm pays for its reach with it."""

_UNCHECKED = (
    "without --cell FILE neither the limits of the joints nor the bodies of the arm and around it were checked: "
    "give the cell file before anything is driven"
)


def compensate_command(
    result: Path,
    output: Path,
    path: Path | None,
    form: str,
    hand: Hand,
    start_direction: str,
    cell: Path | None,
    j4_deg: float,
    as_json: bool,
) -> None:
    """Write corrected commands or compensation tables.

    Raises:
        UsageError: a file or an option is wrong, or the form cannot hold what the result says.
        LimitError: a corrected command leaves the limits of the cell's joints, or something stands in its way.
        MeasurementRejectedError: no row has a correction, or a program would have to leave rows out.
    """
    require_other_file(output, result, path, cell)
    identified = read_result(result)
    arm = arm_of(identified)
    origin = _origin(result, identified)
    for text in arm_remarks(identified):
        say(f"warning: {text}")
    if form == "kw-ssfk":
        _write_tables(arm, origin, output, path, as_json)
        return
    if path is None:
        raise UsageError(f"--format {form} needs --path FILE, a path CSV with what shall be corrected")
    loaded = None if cell is None else _cell_of(cell, origin)
    settings = _settings(loaded, j4_deg) if form == "melfa" else None
    commanded = read_path_csv(path, origin.nominal_mm, hand, start_states(start_direction))
    take_up_deg = TAKE_UP_DEG if loaded is None else loaded.measurement.take_up_deg
    compensated = compensate_path(arm, commanded, origin.nominal_mm, take_up_deg)
    warnings = _checked(compensated, path, form, loaded, j4_deg)
    if settings is not None:
        write_atomically(output, melfa_program(compensated, origin, settings))
    elif form == "json":
        write_compensated_json(compensated, origin, take_up_deg, output)
    else:
        write_compensated_csv(compensated, origin, output)
    for text in warnings:
        say(f"warning: {text}")
    facts = _facts(compensated)
    if as_json:
        emit_json({"output": [str(output)], "form": form, **facts, "warnings": warnings})
    else:
        emit(_summary(facts))
    say(f"{output} written")


def _origin(path: Path, result: Result) -> Origin:
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


def _write_tables(arm: IdentifiedArm, origin: Origin, output: Path, path: Path | None, as_json: bool) -> None:
    if path is not None:
        raise UsageError("a table (--format kw-ssfk) holds for every path: leave --path away")
    # The controller reads one list for each axis.
    files = [output.with_name(f"{output.stem}-j{joint}{output.suffix}") for joint in (1, 2)]
    texts = [ssfk_table(joint, one, origin) for joint, one in zip((1, 2), maps_of(arm), strict=True)]
    for file, text in zip(files, texts, strict=True):
        write_atomically(file, text)
    say(
        f"links are not part of a table: give the controller's kinematics {origin.links_mm[0]:.4f} and "
        f"{origin.links_mm[1]:.4f} mm; read the comments at the head of the files before they are used"
    )
    if as_json:
        emit_json({"output": [str(file) for file in files], "form": "kw-ssfk", "links_mm": origin.links_mm})
    say(f"{files[0]} and {files[1]} written")


def _cell_of(file: Path, origin: Origin) -> Cell:
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


def _settings(cell: Cell | None, j4_deg: float) -> MelfaSettings:
    if cell is None:
        raise UsageError(
            "--format melfa needs --cell FILE: the program takes the height of J3, the cap of the speed, the limits "
            "of the joints, take-up and settling time from there"
        )
    return MelfaSettings(
        cell.robot.j3_mm, j4_deg, cell.robot.override_cap_percent, cell.measurement.settle_time_s
    )


def _checked(path: CompensatedPath, file: Path, form: str, cell: Cell | None, j4_deg: float) -> list[str]:
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


def _facts(path: CompensatedPath) -> dict[str, Any]:
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


def _summary(facts: dict[str, Any]) -> str:
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
