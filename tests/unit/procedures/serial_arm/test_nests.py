"""What a run says of a motion of the nests is what becomes of it when the run is evaluated."""

from pathlib import Path

import numpy as np
import pytest

from catseye.app.results.serial_arm.run_poses import pose_rows
from catseye.app.store.reader import RunReader
from tests.unit.app.results.serial_arm.test_run_poses import place_of, validated
from tests.unit.procedures.serial_arm.benches import Room

# Stated of a coordinate are 0.031 mm rms: three nests show a common shift beyond
# 3 * sqrt(3) * sqrt(2) * 0.031 / sqrt(3) = 0.132 mm only.
STATES = [(0.10, "takes none out"), (0.16, "takes this motion out of the poses measured since")]


@pytest.mark.parametrize(("drift_mm", "said"), STATES)
async def test_a_warning_of_drift_says_what_becomes_of_it(tmp_path: Path, drift_mm: float, said: str) -> None:
    runs = tmp_path / "runs"
    runs.mkdir()
    still = pose_rows(RunReader(await validated(tmp_path, Room(runs))))
    room = Room(runs)
    # After four poses everything seems to have moved.
    room.tracker.drift_mm = {7: drift_mm}
    moved = pose_rows(RunReader(await validated(tmp_path, room)))
    warned = [str(one["text"]) for one in room.said("warning") if "has moved by" in str(one["text"])]
    assert warned
    assert all(said in text for text in warned)
    apart_mm = [
        np.linalg.norm(place_of(one) - place_of(other)) for one, other in zip(moved, still, strict=True)
    ]
    taken_out = max(apart_mm) < 1e-6
    assert taken_out == ("takes this motion out" in said)
