"""Gravity torques that nobody stated the load of the tool for."""

from typing import Final

from catseye.app.results.serial_arm.result import SerialArmResult

_COMPLIANCE: Final = ".compliance_rad_per_nmm"


def calibrated_without_load(result: SerialArmResult) -> str | None:
    """Return what is remarked of a calibration with compliances whose tool has no mass; None for others."""
    if result.tool is not None or not _is_elastic(result):
        return None
    return (
        "no tool was stated, so the gravity torques are those of the links alone: if the arm carried a tool, its "
        "mass is missing from them, and compliances and predictions are wrong by that. State it by --tool"
    )


def read_without_load(result: SerialArmResult) -> str | None:
    """Return what is warned of a result that says nothing of the loads behind its torques; None for others."""
    if result.tool is not None or result.description is not None or not _is_elastic(result):
        return None
    return (
        "the result names neither its tool nor its arm's description, so the gravity torques are those of the "
        f"links of {result.arm} alone: if it was identified with a tool, predictions lack the deflection caused by "
        "its mass. Use the result as calibrate wrote it, with the keys tool and description"
    )


def _is_elastic(result: SerialArmResult) -> bool:
    return any(part.name.endswith(_COMPLIANCE) and part.value != 0.0 for part in result.parameters)
