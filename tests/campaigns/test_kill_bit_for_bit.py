"""A run with an injected clock, killed at every pass of every named place: it stores what another one does."""

import os
from pathlib import Path

import pytest

from catseye.app.files.crash_points import RUN_POINTS
from tests.system.clocked_kills import whole

OFTEN = {"before-motion", "after-motion", "before-commit", "after-commit"}
MOST_PASSES = 40
RETURNING = {"unsealed", "reopened"}


@pytest.mark.timeout(7200)
def test_killed_at_every_pass_of_every_place(tmp_path: Path) -> None:
    expected, kills = whole(tmp_path / "uninterrupted"), 0
    for place in RUN_POINTS:
        for number in range(1, MOST_PASSES if place in OFTEN else 2):
            before = ("after-commit:2",) if place in RETURNING else ()
            found = whole(tmp_path / f"{place}-{number}", *before, f"{place}:{number}")
            if not found:
                break
            assert found == expected, f"{place}:{number}"
            kills += 1
    report(f"{kills} kills at {len(RUN_POINTS)} named places: every measured value is the same, bit for bit")


def report(text: str) -> None:
    print(f"\n{text}, load {os.getloadavg()[0]:.1f}", flush=True)  # noqa: T201  # the figure
