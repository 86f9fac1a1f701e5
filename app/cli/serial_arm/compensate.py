"""compensate, of a serial arm: commands that bring it where its program means."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from catseye.app.cli.output import note, warn, write_document
from catseye.app.cli.serial_arm.load import warn_of_load
from catseye.app.cli.serial_arm.sides import warn_of_sides
from catseye.app.files.atomic import require_output, write_atomically

if TYPE_CHECKING:
    from catseye.app.results.serial_arm.compensated_poses import Form

_MOST_NAMED = 8
"""Refused poses that are named one by one."""


def compensate(
    result: Path,
    poses: Path,
    form: "Form",
    output: Path,
    target: str | None,
    approach: float = 0.0,
    *,
    as_json: bool = False,
) -> None:
    """Write compensated commands of poses.

    Args:
        approach: deg (mm) on its side from where a module drives each pose; 0: it does not.
    """
    from catseye.app.results.serial_arm.compensated_poses import compensate_poses, compensated_text
    from catseye.app.results.serial_arm.facts import PoseCompensation
    from catseye.app.results.serial_arm.identified_arm import identified_arm
    from catseye.app.results.serial_arm.result import read_serial_arm

    require_output(output, result, poses)
    identified = read_serial_arm(result)
    arm = identified_arm(identified)
    warn_of_load(identified)
    found = compensate_poses(arm, poses, target, approach)
    warn_of_sides(arm, poses, sided=found.poses.sides is not None)
    header = [
        f"compensated commands of {poses.name} by {result.name}: {identified.arm}, model {identified.model}",
        "They hold for this arm, this tool and the base as it stood; try them slowly first.",
    ]
    write_atomically(output, compensated_text(found, form, header))
    refusals = found.refusals()
    for text in refusals[:_MOST_NAMED]:
        warn(text)
    if len(refusals) > _MOST_NAMED:
        warn(f"{len(refusals) - _MOST_NAMED} more poses are refused; --format csv lists each with its reason")
    corrected = found.found.uncorrected_mm[found.kept]
    facts = PoseCompensation(
        output=[str(output)],
        form=form,
        rows=len(found.poses.names),
        compensated=len(found.kept),
        mean_uncorrected_mm=float(np.mean(corrected)),
        max_uncorrected_mm=float(np.max(corrected)),
        refused=list(refusals),
    )
    if as_json:
        write_document("pose-compensation", facts.json_object())
    note(
        f"{output} written: {facts.compensated} of {facts.rows} poses; without compensation they would be "
        f"missed by {facts.mean_uncorrected_mm:.3f} mm on average"
    )
