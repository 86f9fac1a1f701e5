"""What `calibrate --json` says of a result, whose file has the rest."""

from pathlib import Path
from typing import Any

from pydantic import Field

from catseye.app.results.serial_arm.result import SerialArmResult


class SerialArmSummary(SerialArmResult):
    """An identified serial arm without descriptions, correlations and single errors."""

    correlation: list[list[float]] = Field(exclude=True)
    description: None = Field(default=None, exclude=True)
    tool: None = Field(default=None, exclude=True)
    errors: None = Field(default=None, exclude=True)


class CalibrationDocument(SerialArmSummary):
    """A summary of the result that is written to a file."""

    output: str


_LEFT_OUT = {name for name, field in SerialArmSummary.model_fields.items() if field.exclude}


def serial_arm_summary(result: SerialArmResult) -> dict[str, Any]:
    """Return a result as the file has it, without what `SerialArmSummary` leaves out."""
    return result.model_dump(mode="json", by_alias=True, exclude=_LEFT_OUT)


def calibration_document(result: SerialArmResult, output: Path) -> dict[str, Any]:
    """Return what is said of a result that is written to a file."""
    return {"output": str(output), **serial_arm_summary(result)}
