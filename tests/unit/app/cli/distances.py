"""Points files of an arm that is written down in tests/unit/calibration/diagnostics/bench."""

from pathlib import Path

import numpy as np

from catseye.app.cell.scara.template import TEMPLATE
from catseye.calibration.scara.points import Points


def write_points(points: Points, folder: Path, name: str = "points.csv") -> Path:
    """Write points and a cell file that fits them; return the points file."""
    (folder / "cell.toml").write_text(TEMPLATE, encoding="utf-8")
    commands = points.commands
    columns = {
        "reflector": [points.reflector_names[i] for i in points.reflector],
        "segment": [points.dead_paths[i][1] for i in points.dead_path],
        "theta1_deg": np.rad2deg(commands.theta1_rad).tolist(),
        "theta2_deg": np.rad2deg(commands.theta2_rad).tolist(),
        "direction1": commands.direction1.tolist(),
        "direction2": commands.direction2.tolist(),
        "displacement_mm": points.displacement_mm.tolist(),
    }
    if points.sigma_mm is not None:
        columns["sigma_mm"] = points.sigma_mm.tolist()
    if points.mount_rad is not None:
        columns["mount_deg"] = np.rad2deg(points.mount_rad).tolist()
    lines = [",".join(columns), *(",".join(map(str, row)) for row in zip(*columns.values(), strict=True))]
    path = folder / name
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path
