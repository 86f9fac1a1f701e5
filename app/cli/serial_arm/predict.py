"""predict, of a serial arm: where targets are at poses."""

from pathlib import Path

import numpy as np

from catseye.app.cli.output import note, warn, write_document
from catseye.app.cli.serial_arm.load import warn_of_load
from catseye.app.cli.serial_arm.sides import warn_of_sides
from catseye.app.files.atomic import require_output
from catseye.app.results.numbers import EXPANDED


def predict(result: Path, poses: Path, output: Path, *, as_json: bool = False) -> None:
    """Predict the places of targets at the rows of a poses CSV."""
    from catseye.app.results.serial_arm.facts import PosePrediction
    from catseye.app.results.serial_arm.identified_arm import identified_arm
    from catseye.app.results.serial_arm.prediction import (
        predict_distances,
        predict_places,
        read_asked,
        write_predicted_distances,
        write_predicted_places,
    )
    from catseye.app.results.serial_arm.result import read_serial_arm

    require_output(output, result, poses)
    identified = read_serial_arm(result)
    arm = identified_arm(identified)
    warn_of_load(identified)
    asked = read_asked(poses, arm)
    if asked.of_distances:
        found = predict_distances(arm, asked)
        write_predicted_distances(asked, found, identified.joints, output)
        u_mm = found.u_mm
    else:
        predicted = predict_places(arm, asked)
        write_predicted_places(predicted, identified.joints, output)
        u_mm = predicted.u_mm
    facts = PosePrediction(
        output=str(output),
        model=identified.model,
        joints=identified.joints,
        rows=len(u_mm),
        median_u_mm=float(np.median(u_mm)),
        max_u_mm=float(u_mm.max()),
    )
    if identified.joints == "read back":
        warn(
            "the result is of joints that the controller reads back: the places hold for these, and the arm stands "
            "elsewhere at such commands"
        )
    warn_of_sides(arm, poses, sided=asked.sided)
    if as_json:
        write_document("pose-prediction", facts.json_object())
    note(
        f"{output} written: {facts.rows} rows, U = {EXPANDED * facts.median_u_mm:.4f} mm "
        f"(median), {EXPANDED * facts.max_u_mm:.4f} mm at most (k = 2)"
    )
