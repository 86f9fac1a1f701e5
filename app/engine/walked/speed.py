"""The override that keeps everything on the arm slow enough for a walk-through."""

import math
from typing import Final

from catseye.app.engine.walked.tube import Leg
from catseye.app.errors import SafetyError
from catseye.drivers.roles.pose import pose_text
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.motion.body_speed import fastest_mm_s

FASTEST_MM_S: Final = 250.0
"""Of anything on the arm while it is walked."""

MOST_PERCENT: Final = 10.0
"""Override of a walk."""

_LEAST_PERCENT: Final = 1.0


def walking_percent(bench: Bench, leg: Leg, cap_percent: float) -> float:
    """Return the highest whole override with which a motion is walked.

    Raises:
        SafetyError: the motion is too fast with the lowest override that controllers take.
    """
    most = min(MOST_PERCENT, cap_percent)
    at_one = fastest_mm_s(bench, leg.start, leg.end, _LEAST_PERCENT)
    percent = most if at_one * most <= FASTEST_MM_S else float(math.floor(FASTEST_MM_S / at_one))
    if percent < _LEAST_PERCENT:
        raise SafetyError(
            f"the motion to {pose_text(bench.arm.axes, leg.end)} moves the outermost body at up to {at_one:.0f} mm/s "
            f"with an override of {_LEAST_PERCENT:g} %, and a walk at {FASTEST_MM_S:g} mm/s at most: it cannot be "
            "walked, no override is lower; check [robot] speed_deg_s and the bodies, or drive it by hand"
        )
    return percent
