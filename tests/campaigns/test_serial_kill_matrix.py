"""Calibrations on an emulated ABB that are killed at every named place and at random moments, and go on.

`CATSEYE_KILLS` shortens it, `CATSEYE_SEED` repeats it.
"""

import os
import random
from collections.abc import Iterator
from pathlib import Path

import pytest

from catseye.app.cell.templates import SIX_AXIS, TEMPLATES
from tests.system.command import Emulated, emulated
from tests.system.interruptions import Moment
from tests.system.serial_kills import KILLED, OFTEN, PASSED, RETURNING, SPEED, calibration, require_whole

KILLS = int(os.environ.get("CATSEYE_KILLS", "50"))
SEED = int(os.environ.get("CATSEYE_SEED", "20261126"))


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Emulated]:
    with emulated(tmp_path, "--seed", "3", "--speed", SPEED, text=TEMPLATES[SIX_AXIS].text) as running:
        yield running


@pytest.mark.timeout(7200)
def test_killed_at_every_named_place(bench: Emulated) -> None:
    moments = random.Random(SEED)
    for name in (*PASSED, *RETURNING):
        story = calibration(bench)
        if name in RETURNING:
            assert story.live(crash="after-commit:2").returncode == KILLED
        crash = f"{name}:{moments.randint(1, OFTEN[name])}" if name in OFTEN else name
        assert story.live(crash=crash).returncode == KILLED, crash
        require_whole(story)
    report(f"{len(PASSED) + len(RETURNING)} named places: every pose once, nothing reported is missing")


@pytest.mark.timeout(7200)
def test_killed_at_random_moments(bench: Emulated) -> None:
    reference = calibration(bench)
    events = reference.live().events
    expected = require_whole(reference)
    moments, kills, points = random.Random(SEED), 0, 0
    while kills < KILLS:
        story = calibration(bench)
        kills += story.live(moment=Moment.drawn(moments, events)).returncode == KILLED
        assert {pose for pose, _ in require_whole(story)} == {pose for pose, _ in expected}
        points += len(story.lives[0].points)
    report(f"{kills} kills at random (seed {SEED}), {points} targets reported before them, every pose once")


def report(text: str) -> None:
    print(f"\n{text}, load {os.getloadavg()[0]:.1f}", flush=True)  # noqa: T201  # the figure
