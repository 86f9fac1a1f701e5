"""A result file, and a reference, against a measured file: the comparison and its report."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from catseye.app.errors import UsageError
from catseye.app.results.model import Report, Section, Sign, Statement
from catseye.app.results.origin import origin_now
from catseye.app.results.scara.arm_report import arm_report
from catseye.app.results.scara.findings import Findings
from catseye.app.results.scara.identified_arm import arm_of, arm_remarks, nominal_of
from catseye.app.results.scara.instrument_positions import ForeignPositions
from catseye.app.results.scara.joint_maps import JointMap, joint_maps
from catseye.app.results.scara.measured import measured_path
from catseye.app.results.scara.mirrored import mirrored_text
from catseye.app.results.scara.path_csv import start_states
from catseye.app.results.scara.path_range import lines_text, outside_text
from catseye.app.results.scara.repeated_poses import RepeatedPoses, repeated_poses
from catseye.app.results.scara.result import Result, read_result
from catseye.app.results.scara.validation import TAKE_UP_DEG, PathValidation, validate_on_path
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.planar import Hand


@dataclass(frozen=True)
class FileValidation:
    """What can be said about a result on a measured file.

    Attributes:
        validation: the reference, where there is one, then the result.
        results: as in `validation`.
        lines: line of each row in the measured file.
        left_out: sentences about rows that are not compared.
        remarks: what a reader has to know about results and measurement.
        repeats: poses that were attained several times.
        maps: of the result, none for the conventional model.
    """

    validation: PathValidation
    results: tuple[Result, ...]
    lines: list[int]
    left_out: list[str]
    remarks: list[str]
    repeats: RepeatedPoses
    maps: tuple[JointMap, ...]


def validate_files(
    result: Path,
    measured: Path,
    reference: Path | None,
    hand: Hand,
    start_direction: str,
    foreign: ForeignPositions | None = None,
) -> FileValidation:
    """Compare results with a measured file.

    Args:
        hand: of Cartesian commands.
        start_direction: option with the states of approach of the first Cartesian command.
        foreign: how a file is read that another program wrote, and what was driven; None for a measured CSV.

    Raises:
        UsageError: a file or an option is wrong, or the measurement's frame is left-handed.
        CalibrationError: too little is left to compare.
    """
    files = [result] if reference is None else [reference, result]
    results = tuple(read_result(file) for file in files)
    arms, nominal = [arm_of(one) for one in results], _nominal(files, results)
    path, lines, start = measured_path(measured, nominal, hand, start_states(start_direction), foreign)
    validation = validate_on_path(path, arms, nominal, _titles(files, results))
    if mirrored := mirrored_text(validation):
        raise UsageError(f"{measured}: {mirrored}")
    remarks = list(dict.fromkeys(text for one in results for text in arm_remarks(one)))
    if start:
        remarks.append(f"{start}. It is left out of the comparison")
    if not validation.models[-1].agreement.instrument:
        remarks.append(
            "the instrument's uncertainty is not stated at every row (column u_mm, or u_mm of a mapping) and counts "
            "as nothing there"
        )
    return FileValidation(
        validation=validation,
        results=results,
        lines=lines,
        left_out=_left_out(arms, validation, lines),
        remarks=remarks,
        repeats=repeated_poses(path, validation.models[-1]),
        maps=joint_maps(arms[-1]),
    )


def _nominal(files: Sequence[Path], results: Sequence[Result]) -> tuple[float, float]:
    found = [nominal_of(result)[0] for result in results]
    if found[0] != found[-1]:
        raise UsageError(
            f"{files[0]} and {files[-1]} were identified with other nominal links ({found[0][0]:g}, {found[0][1]:g} "
            f"and {found[-1][0]:g}, {found[-1][1]:g} mm): both have to belong to one arm"
        )
    return found[-1]


def _titles(files: Sequence[Path], results: Sequence[Result]) -> list[str]:
    """Return names where the models alone do not distinguish the results."""
    if len(results) < 2 or results[0].model != results[1].model:
        return []
    return [file.stem for file in files]


def _left_out(arms: Sequence[IdentifiedArm], validation: PathValidation, lines: Sequence[int]) -> list[str]:
    path = validation.path
    texts = [outside_text(arm, path.commands, lines) for arm in arms]
    loose = ~path.established
    if loose.any():
        texts.append(
            f"{int(loose.sum())} of {loose.size} rows are left out because a joint has moved less than "
            f"{TAKE_UP_DEG:g}° since it reversed or set off, so that no direction of approach holds "
            f"({lines_text(lines, loose)}). A result file does not state the arm's take-up angle; {TAKE_UP_DEG:g}° "
            "is what a cell file has by default"
        )
    return list(dict.fromkeys(text for text in texts if text))


def file_validation_report(validation: FileValidation, measured: str) -> Report:
    """Return what models leave on the path of a file."""
    simulated = any(bool(result.provenance.simulated) for result in validation.results)
    report = arm_report(
        f"Validation on {measured}",
        origin_now(simulated=simulated),
        Findings(validation.results, validation=validation.validation, lines=validation.lines),
    )
    first, *others = report.sections
    return replace(report, sections=(_with_remarks(first, validation), *others))


def _with_remarks(verdict: Section, validation: FileValidation) -> Section:
    left_out = (Statement(Sign.NEUTRAL, f"Left out: {text}.") for text in validation.left_out)
    remarks = (Statement(Sign.ATTENTION, f"{text}.") for text in validation.remarks)
    return replace(verdict, blocks=(*verdict.blocks, *left_out, *remarks))
