"""One bench twice: with a counter that corrects for the air, and with one that counts in vacuum wavelengths."""

import json
from pathlib import Path
from typing import Any

import pytest

from tests.system.command import SPEED, catseye, emulated, last_run, only

_FEW_NODES = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-40.0, 0.0, 40.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [40.0, 80.0]",
}
_NOISE_MM = 1.5e-3
"""Far above the mean of ten readings, far below what 270 ppm do to the way of the beam."""


def measured(folder: Path, profile: str) -> dict[str, Any]:
    """Search and measure one reflector; return the export of the run."""
    folder.mkdir()
    edit = {**_FEW_NODES, **only("P2"), 'profile = "default"': f'profile = "{profile}"'}
    with emulated(folder, "--seed", "3", edit=edit) as bench:
        output = catseye("doctor", bench.cell, cwd=folder).stdout
        assert ("The program corrects" if profile == "vacuum" else "The instrument corrects") in output
        for procedure in ("reflector-search", "open-loop"):
            done = catseye("run", procedure, "--cell", bench.cell, "--speed", SPEED, cwd=folder)
            assert done.returncode == 0, done.stderr
    run = last_run(folder, "open-loop")
    assert catseye("export", run, "--format", "json", "-o", "points.json", cwd=folder).returncode == 0
    assert catseye("report", run, "-o", "run.html", cwd=folder).returncode == 0
    document: dict[str, Any] = json.loads((folder / "points.json").read_text())
    assert str(document["meta"]["compensation"]["sentence"])[:30] in (folder / "run.html").read_text()
    return document


@pytest.mark.slow
def test_both_ways_of_correcting_for_the_air_agree(tmp_path: Path) -> None:
    corrected = measured(tmp_path / "instrument", "default")
    counted = measured(tmp_path / "program", "vacuum")
    assert corrected["meta"]["compensation"]["by"] == "instrument"
    assert counted["meta"]["compensation"]["by"] == "program"
    pairs = list(zip(corrected["points"], counted["points"], strict=True))
    assert len(pairs) >= 12
    assert all(one["raw_displacement_mm"] == one["displacement_mm"] for one, _ in pairs)
    assert all(one["refractive_index"] is None for one, _ in pairs)
    assert all(other["formula"] == "ciddor" for _, other in pairs)

    def largest_mm(value: str, power: int) -> float:
        """Return the largest difference, with the program's value divided by n so often."""
        return max(
            abs(
                float(other[value]) / float(other["refractive_index"]) ** power
                - float(one["displacement_mm"])
            )
            for one, other in pairs
        )

    assert largest_mm("displacement_mm", 0) < _NOISE_MM
    not_at_all_mm, twice_mm = largest_mm("raw_displacement_mm", 0), largest_mm("displacement_mm", 1)
    assert min(not_at_all_mm, twice_mm) > 10.0 * _NOISE_MM
