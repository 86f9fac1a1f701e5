"""What compensate checks before it writes, and what it says about a corrected path."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

from catseye.app.cell.bench import scara_bench_of, scara_sections
from catseye.app.cell.load import load_cell
from catseye.app.cell.model import Cell
from catseye.app.errors import LimitError, MeasurementRejectedError, UsageError
from catseye.app.files.atomic import write_atomically
from catseye.app.results.scara.compensated_path import Origin, write_compensated_csv, write_compensated_json
from catseye.app.results.scara.compensation import (
    J4_RANGE_DEG,
    CompensatedPath,
    compensate_path,
    require_clear,
    require_limits,
)
from catseye.app.results.scara.compensation_report import advice, unsolved_text
from catseye.app.results.scara.identified_arm import nominal_of
from catseye.app.results.scara.melfa_program import MelfaSettings, melfa_program
from catseye.app.results.scara.path_csv import read_path_csv, start_states
from catseye.app.results.scara.result import Result
from catseye.app.results.scara.validation import TAKE_UP_DEG
from catseye.app.store.software import SOFTWARE
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.procedures.scara.tool_zero import AS_THE_JOINTS

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
    links = scara_sections(cell, "catseye compensate").robot.links_mm
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


@dataclass(frozen=True)
class Correction:
    """A corrected path, checked, and what its files are made with.

    Attributes:
        path: the corrected path.
        warnings: what has to be known before it is driven.
        take_up_deg: overshoot that brings a joint to its target from the proper side.
        program: what a robot program takes from the cell file; None without one.
    """

    path: CompensatedPath
    warnings: list[str]
    take_up_deg: float
    program: MelfaSettings | None


def correction_of(
    arm: IdentifiedArm,
    origin: Origin,
    commanded: Path,
    form: str,
    *,
    hand: Literal["right", "left"],
    start: str,
    cell: Path | None,
    j4_deg: float,
) -> Correction:
    """Correct a path and check it.

    Args:
        hand: of Cartesian rows.
        start: states of approach before the first row, as typed.
        cell: cell file that the commands have to keep to.
        j4_deg: angle of J4 all along a path that states no orientation.

    Raises:
        UsageError: files do not belong together, or the program lacks its cell file.
        MeasurementRejectedError: rows cannot be corrected.
        LimitError: a limit or a body is in the way.
    """
    loaded = None if cell is None else cell_of(cell, origin)
    program = settings_of(loaded, j4_deg) if form == "melfa" else None
    path = read_path_csv(commanded, origin.nominal_mm, hand, start_states(start))
    take_up_deg = TAKE_UP_DEG if loaded is None else loaded.measurement.take_up_deg
    if path.tool.c_deg is not None and j4_deg != 0.0:
        raise UsageError(f"{commanded} states c_deg, from which J4 follows: omit --j4")
    zero = AS_THE_JOINTS if loaded is None else loaded.robot.tool_zero
    j4_limits = J4_RANGE_DEG if loaded is None else _range(loaded.robot.limits_deg.j4)
    compensated = compensate_path(arm, path, origin.nominal_mm, take_up_deg, zero, j4_limits)
    return Correction(
        compensated, checked(compensated, commanded, form, loaded, j4_deg), take_up_deg, program
    )


def write_correction(correction: Correction, origin: Origin, form: str, output: Path) -> None:
    """Write a corrected path in the form that was asked for."""
    if correction.program is not None:
        write_atomically(output, melfa_program(correction.path, origin, correction.program))
    elif form == "json":
        write_compensated_json(correction.path, origin, correction.take_up_deg, output)
    else:
        write_compensated_csv(correction.path, origin, output)


def checked(path: CompensatedPath, file: Path, form: str, cell: Cell | None, j4_deg: float) -> list[str]:
    """Refuse what cannot be driven; return what has to be known about the rest."""
    lines = path.path.places
    unsolved = unsolved_text(path, lines)
    solved = path.solution.solved
    if unsolved and (form == "melfa" or not solved.any()):
        why = "nothing is left to correct" if not solved.any() else "a program leaves no row out"
        raise MeasurementRejectedError(f"{file}: {unsolved}; {why}, and nothing was written")
    if cell is not None:
        _require_drivable(path, lines, cell, j4_deg)
    unchecked = _UNCHECKED if cell is None else ""
    return [text for text in (unsolved, unchecked, *advice(path, lines)) if text]


def _require_drivable(path: CompensatedPath, lines: Sequence[int], cell: Cell, j4_deg: float) -> None:
    bench = scara_bench_of(cell)
    limits = dict(zip(("J1", "J2", "J3", "J4"), (axis.range for axis in bench.arm.axes), strict=True))
    low, high = limits["J4"]
    if not low <= j4_deg <= high:
        raise LimitError(f"--j4 {j4_deg:g} is outside the limits {low:g}°…{high:g}° of the cell file")
    require_limits(path, limits, lines)
    require_clear(path, bench, j4_deg, lines)


def _range(limits: list[float]) -> tuple[float, float]:
    return limits[0], limits[1]
