"""predict, of a serial arm: where targets are at poses."""

from pathlib import Path

import numpy as np

from catseye.app.cli.output import note, write_json
from catseye.app.files.atomic import require_output


def predict(result: Path, poses: Path, output: Path, *, as_json: bool = False) -> None:
    """Predict the places of targets at the rows of a poses CSV."""
    from catseye.app.results.serial_arm.identified_arm import identified_arm
    from catseye.app.results.serial_arm.prediction import predict_places, read_asked, write_predicted_places
    from catseye.app.results.serial_arm.result import read_serial_arm

    require_output(output, result, poses)
    identified = read_serial_arm(result)
    arm = identified_arm(identified)
    predicted = predict_places(arm, read_asked(poses, arm))
    write_predicted_places(predicted, output)
    facts = {
        "output": str(output),
        "model": identified.model,
        "rows": len(predicted.u_mm),
        "median_u_mm": float(np.median(predicted.u_mm)),
        "max_u_mm": float(predicted.u_mm.max()),
    }
    if as_json:
        write_json(facts)
    note(
        f"{output} written: {facts['rows']} rows, standard uncertainty of a coordinate {facts['median_u_mm']:.4f} mm "
        f"(median), {facts['max_u_mm']:.4f} mm at most"
    )
