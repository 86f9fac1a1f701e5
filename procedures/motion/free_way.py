"""No reflector may stand where the arm passes: the wrist would run into it."""

import numpy as np
from numpy.typing import NDArray

from calibration.kinematics import forward
from procedures.bench import Bench
from procedures.errors import PlanError

_SAMPLES = 33
"""Samples of a leg; the wrist of a small SCARA moves by a few mm from one to the next."""


def require_free_way(theta_deg: NDArray[np.float64], bench: Bench) -> None:
    """Refuse a way on which the J4 axis comes nearer to a reflector than the shortest beam.

    A reflector can be out of the beam's range and still be in the arm's way: all of them stand on the bench while
    any one is measured.

    Args:
        theta_deg: J1 and J2 at the stops; straight joint moves lie between them, deg, shape (n, 2).
        bench: nominal arm, all its reflectors, shortest beam.

    Raises:
        PlanError: names the reflector, how near the arm comes and where.
    """
    start, step = theta_deg[:-1, None, :], np.diff(theta_deg, axis=0)[:, None, :]
    way = (start + np.linspace(0.0, 1.0, _SAMPLES)[None, :, None] * step).reshape(-1, 2)
    one, two = np.deg2rad(way).T
    positions = forward(one, two, bench.arm.link1_mm, bench.arm.link2_mm)
    for reflector in bench.reflectors:
        gap = np.hypot(*(reflector.xy_mm - positions).T)
        nearest = int(np.argmin(gap))
        if gap[nearest] < bench.optics.beam_min_mm:
            raise PlanError(
                f"reflector {reflector.name} at ({reflector.x_mm:g}, {reflector.y_mm:g}) mm stands in the arm's way: "
                f"the J4 axis passes it at {gap[nearest]:.0f} mm near θ1 = {way[nearest, 0]:.0f}°, "
                f"θ2 = {way[nearest, 1]:.0f}°, beam_min_mm is {bench.optics.beam_min_mm:g} mm: put the reflector out "
                "of the arm's reach, or take nodes near it out of [measurement]"
            )
