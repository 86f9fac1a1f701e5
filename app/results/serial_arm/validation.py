"""A calibrated serial arm against poses that were measured independently."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from catseye.app.cell.arm import arm_description
from catseye.app.results.model import Column, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import counted, fixed
from catseye.app.results.origin import origin_now
from catseye.app.results.serial_arm.identified_arm import arm_with_frames, identified_arm
from catseye.app.results.serial_arm.measured_poses import read_measured_poses
from catseye.app.results.serial_arm.result import SerialArmResult
from catseye.calibration.core.types import Floats

_CHI2_95_OF_3 = 7.814727903251179
"""0.95 quantile of χ² with three degrees of freedom."""

_MM = fixed(3)


@dataclass(frozen=True)
class Errors:
    """3-D errors at targets, mm, shape (n,)."""

    error_mm: Floats

    def figures(self) -> dict[str, float]:
        """Return mean, standard deviation and maximum by the names of the JSON output."""
        return {
            "mean_mm": float(self.error_mm.mean()),
            "std_mm": float(self.error_mm.std()),
            "max_mm": float(self.error_mm.max()),
        }


@dataclass(frozen=True)
class ArmValidation:
    """How a calibration does on measurements that it has not seen.

    Attributes:
        frames_only: the links as drawn, with base and targets of the result; None where the result has none.
        inside_95_percent: share of errors within the 95 % region of the stated uncertainties, in percent.
    """

    calibrated: Errors
    frames_only: Errors | None
    inside_95_percent: float

    def document(self) -> dict[str, Any]:
        """Return the JSON output."""
        return {
            "n": len(self.calibrated.error_mm),
            "frames_only": None if self.frames_only is None else self.frames_only.figures(),
            "calibrated": self.calibrated.figures(),
            "inside_95_percent": self.inside_95_percent,
        }


def validate_arm(result: SerialArmResult, measured: Path) -> ArmValidation:
    """Compare a result with a table of measured poses.

    Raises:
        UsageError: the table is missing or wrong, or has distances only; names file and line.
    """
    arm, frames = identified_arm(result), arm_with_frames(result)
    description = result.description or arm_description(result.arm)
    tables = read_measured_poses([measured], description, arm.arm, {})
    rows, commands = tables.measurements.points, tables.measurements.commands
    missed = np.zeros((len(rows.pose), 3))
    bare = np.zeros(len(rows.pose))
    square = np.zeros(len(rows.pose))
    for number in np.unique(rows.target).tolist():
        of_it = np.flatnonzero(rows.target == number)
        there = commands.some(rows.pose[of_it])
        places, covariance = arm.places_mm(there, number)
        if rows.covariance_mm2 is not None:
            covariance = covariance + rows.covariance_mm2[of_it]
        missed[of_it] = places - rows.place_mm[of_it]
        square[of_it] = np.einsum(
            "ni,ni->n", missed[of_it], np.linalg.solve(covariance, missed[of_it][:, :, None])[:, :, 0]
        )
        if frames is not None:
            drawn = frames.places_mm(frames.frames(there)[-1], np.full(len(of_it), number))
            bare[of_it] = np.linalg.norm(drawn - rows.place_mm[of_it], axis=1)
    return ArmValidation(
        Errors(np.asarray(np.linalg.norm(missed, axis=1))),
        None if frames is None else Errors(bare),
        100.0 * float(np.mean(square <= _CHI2_95_OF_3)),
    )


def arm_validation_report(found: ArmValidation, name: str) -> Report:
    """Return the report of a validation."""
    after = found.calibrated.figures()
    said = [
        Statement(
            Sign.GOOD,
            f"{counted(len(found.calibrated.error_mm), 'measured target')}: the calibrated arm misses them by "
            f"{after['mean_mm']:.3f} mm on the average, {after['max_mm']:.3f} mm at most.",
        ),
        Statement(
            Sign.NEUTRAL if found.inside_95_percent >= 90.0 else Sign.ATTENTION,
            f"{found.inside_95_percent:.0f} % of the errors lie within the 95 % region of the stated uncertainties.",
        ),
    ]
    columns = (
        Column("state", "state"),
        Column("mean_mm", "mean error", "mm", _MM),
        Column("std_mm", "standard deviation", "mm", _MM),
        Column("max_mm", "largest", "mm", _MM),
    )
    states = (("links as drawn, frames fitted", found.frames_only), ("calibrated", found.calibrated))
    rows: list[tuple[str | float, ...]] = [
        (state, *errors.figures().values()) for state, errors in states if errors is not None
    ]
    table = Table(
        "validation", "Position errors on poses that the calibration has not seen", columns, tuple(rows)
    )
    return Report(
        f"Validation with {name}",
        origin_now(simulated=False, unverified=()),
        (section("validation", "Validation", [*said, table], brief=True),),
    )
