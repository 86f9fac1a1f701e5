"""Results of a calibrated serial arm, as the screen Results lists and shows them; no widget in here."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from catseye.app.results.model import Report
from catseye.app.results.numbers import counted
from catseye.app.results.serial_arm.calibration_report import calibration_file_report
from catseye.app.results.serial_arm.result import SerialArmResult
from catseye.app.tui.report_kind import ReportKind, Words


def _row(result: SerialArmResult) -> tuple[str, str, str]:
    return result.model, f"{counted(result.fit.n_rows, 'row'):>10}", f"{1e3 * result.fit.rms_mm:>7.1f}"


def _heading(result: SerialArmResult) -> Sequence[str]:
    left_out = result.cross_validation.mean_mm
    joints = ("joints as read back",) if _is_read_back(result) else ()
    return result.arm, result.model, *joints, f"poses left out missed by {left_out:.3f} mm on average"


def _is_read_back(result: SerialArmResult) -> bool:
    return result.joints == "read back"


def _steps(path: Path, result: SerialArmResult) -> Sequence[tuple[str, Words]]:
    return (
        (
            "where the arm really goes at poses",
            ("predict", str(path), "--poses", "POSES.csv", "-o", "predicted.csv"),
        ),
        (
            "what is left at poses measured independently",
            ("validate", str(path), "--measured", "MEASURED.csv"),
        ),
        (
            "compensate and ballbar refuse this result: it does not know by how much the arm misses its commands; "
            "calibrate\nanew from a table without the columns q1_read_deg …",
            ("calibrate", "--poses", "POSES.csv", "--arm", result.arm, "-o", "commanded.json"),
        )
        if _is_read_back(result)
        else (
            "commands that bring the arm there",
            ("compensate", str(path), "--poses", "POSES.csv", "--format", "rapid", "-o", "targets.mod"),
        ),
    )


def _files(path: Path, result: SerialArmResult) -> list[Path]:
    del result
    return [path]


def _report(files: list[Path]) -> Report:
    return calibration_file_report(files[0])


KIND: Final = ReportKind("serial-arm", SerialArmResult, _row, _heading, _steps, _files, _report)
