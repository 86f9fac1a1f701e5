"""A calibration on an emulated ABB that dies is gone on with: no pose twice, none that was reported missing."""

from collections.abc import Iterator

import pytest

from catseye.app.cell.templates import SIX_AXIS, TEMPLATES
from tests.system.command import Emulated, emulated
from tests.system.serial_kills import KILLED, SPEED, calibration, require_whole


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    folder = tmp_path_factory.mktemp("kills")
    with emulated(folder, "--seed", "3", "--speed", SPEED, text=TEMPLATES[SIX_AXIS].text) as running:
        yield running


@pytest.mark.parametrize("crash", ["before-motion:5", "after-commit:2"])
def test_a_killed_calibration_has_every_pose_once(bench: Emulated, crash: str) -> None:
    story = calibration(bench)
    assert story.live(crash=crash).returncode == KILLED
    require_whole(story)
