"""Calibrations of an emulated ABB that are killed and go on, and what has to be true of them."""

import signal
from typing import Final

from catseye.app.store.seal import read_manifest
from catseye.app.store.verify import verify
from tests.system.command import Emulated
from tests.system.interruptions import Command, Story, commands

KILLED: Final = -signal.SIGKILL
SPEED: Final = "200"
POSES: Final = 11
MOST_LIVES: Final = 4
KEY: Final = ("pose", "target")

OFTEN: Final = {"before-motion": 12, "after-motion": 12, "before-commit": POSES, "after-commit": POSES}
"""Places that a calibration passes again and again, and how often at least."""

PASSED: Final = (
    *("directory-made", "run-opened", "devices-connected", *OFTEN),
    *("before-closing", "closed", "before-manifest", "sealed"),
)
"""Places on the way of a calibration that nothing interrupts: it zeroes no count and asks nothing."""

RETURNING: Final = ("unsealed", "reopened")
"""Places on the way back into a run."""

_PARAMS: Final = (f"count={POSES}", "candidates=200", "nests_every=5", "settle_s=0.2", "dwell_s=0.5")


def calibration(bench: Emulated) -> Story:
    """Return a short calibration with the tracker that has not begun."""
    params = [word for param in _PARAMS for word in ("--param", param)]
    words = ("run", "tracker-calibration", "--speed", SPEED, *params)
    return Story(bench, words, "targets", KEY)


def require_whole(story: Story) -> list[Command]:
    """Go on until the run is complete; check that it is sound and has every pose once; return its commands."""
    for _ in range(MOST_LIVES):
        if story.path is not None and read_manifest(story.path) is not None:
            break
        story.live()
    assert story.reader.status == "complete", story.lives[-1].stderr
    assert verify(story.reader.path).ok
    found = commands(story.reader, "targets", KEY)
    assert len(found) == len(set(found)), found
    assert len({pose for pose, _ in found}) == POSES, found
    return found
