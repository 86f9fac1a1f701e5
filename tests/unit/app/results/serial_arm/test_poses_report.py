"""Targets at poses against the drawn arm."""

from pathlib import Path

import numpy as np
import pytest

from catseye.app.results.figures import Figure, Points
from catseye.app.results.model import Section, Table
from catseye.app.results.serial_arm.poses_report import poses_section
from catseye.app.store.reader import RunReader
from tests.unit.app.results.serial_arm.test_run_poses import validated
from tests.unit.procedures.serial_arm.benches import Room


def differences(section: Section) -> np.ndarray:
    """Return the size of each arrow."""
    figure = next(one for one in section.blocks if isinstance(one, Figure) and one.key == "pose-arrows")
    (panel, _) = figure.rows[0]
    assert panel is not None
    return next(np.asarray(mark.value) for mark in panel.marks if isinstance(mark, Points))


async def test_a_perfect_arm_shows_no_difference(tmp_path: Path) -> None:
    # The scripted arm's base stands elsewhere than stated; one frame takes that away.
    section = poses_section(RunReader(await validated(tmp_path)))
    assert differences(section).max() < 1e-6
    (table,) = [one for one in section.blocks if isinstance(one, Table)]
    assert sum(int(str(row[1])) for row in table.rows) == len(differences(section))


async def test_a_pose_that_is_off_stands_out(tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    runs.mkdir()
    room = Room(runs)
    move = room.robot.move_joints
    moved = [0]

    async def counted(target: tuple[float, ...]) -> None:
        await move(target)
        moved[0] += 1

    room.robot.move_joints = counted  # type: ignore[method-assign]  # counts motions
    place = room.tracker.place_mm

    def seen_off(target: str) -> np.ndarray:
        # Every target is seen 1 mm too far along x at the third pose, after three motions each.
        away = 1.0 if not target.startswith("W") and 7 <= moved[0] <= 9 else 0.0
        return np.asarray(place(target) + np.array([away, 0.0, 0.0]))

    room.tracker.place_mm = seen_off  # type: ignore[method-assign]  # a tracker that errs
    found = differences(poses_section(RunReader(await validated(tmp_path, room))))
    assert found.max() == pytest.approx(1.0, abs=0.4)
    assert np.median(found) < 0.4
