"""Where the beam goes from a pose: its length, how wide it returns, how far J4 may look for it."""

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.scara.planar import forward, wrap_rad
from catseye.calibration.scara.pointing import beam_direction
from catseye.drivers.roles.pose import Pose
from catseye.procedures.scara.beam.beam_scan import half_window_deg
from catseye.procedures.scara.bench import Reflector, ScaraBench

LOOK_AROUND_DEG = 0.5
"""How far J4 is turned to either side to find a beam again."""


def beam_mm(joints: Pose, bench: ScaraBench, reflector: Reflector) -> float:
    """Return the length of the beam from a pose to a reflector, mm."""
    return float(np.hypot(*(reflector.xy_mm - _position_mm(joints, bench))))


def window_deg(joints: Pose, bench: ScaraBench, reflector: Reflector) -> float:
    """Return half the width of the return window from a pose, deg."""
    return half_window_deg(bench.optics.acceptance_mm, beam_mm(joints, bench, reflector))


def look_around_deg(joints: Pose, bench: ScaraBench, reflector: Reflector) -> float:
    """Return how far J4 may turn from a pose without meeting another reflector, deg.

    The distance to that one would be taken for this one's.
    """
    if bench.optics.one_reflector:
        return LOOK_AROUND_DEG
    here = _position_mm(joints, bench)
    own = beam_direction(here, reflector.xy_mm)
    margin_deg = 2.0 * window_deg(joints, bench, reflector)
    off_deg = [
        float(np.rad2deg(np.abs(wrap_rad(beam_direction(here, other.xy_mm) - own)))) - margin_deg
        for other in bench.reflectors
        if other != reflector
    ]
    return max(0.0, min(LOOK_AROUND_DEG, *off_deg)) if off_deg else LOOK_AROUND_DEG


def _position_mm(joints: Pose, bench: ScaraBench) -> NDArray[np.float64]:
    one, two = np.deg2rad(joints[:2])
    return forward(one, two, bench.link1_mm, bench.link2_mm)
