"""Why a beam was lost, as far as that can be known, and what to do about it."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.pointing import column_clearance, field_angle
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.beam.loss import Cause
from catseye.procedures.scara.bench import Reflector, ScaraBench

_NEAR_COLUMN_MM = 20.0
"""A beam that passes the column's stated margin by less is suspected to be cut off by the real column."""

_NEAR_FIELD_DEG = 5.0


@dataclass(frozen=True)
class Loss:
    """A count that is worth nothing any more.

    Attributes:
        cause: why; None when that has to be found out.
    """

    cause: Cause | None = None


NOT_SUBDIVIDED = Cause(
    "not-subdivided",
    "the way is driven without sub-steps (param subdivide), so the beam misses the reflector",
    said_once=True,
)

MOVED_BY_HAND = Cause(
    "moved-by-hand",
    "the arm no longer stands where it was sent: somebody has moved it; leave it alone while a run is under way",
)

INTERRUPTED = Cause(
    "interrupted",
    "something was in the beam for a moment; it returns where it is aimed: keep out of its way",
)


def no_return(half_range_deg: float) -> Cause:
    """Return the cause of a beam that does not come back at all."""
    return Cause(
        "no-return",
        f"nothing returns within ±{half_range_deg:g}° of the aim: take away what is in the beam, and check that "
        "the reflector stands in its place and faces the arm",
        {"half_range_deg": half_range_deg},
    )


def weak(signal: float, bench: ScaraBench) -> Cause:
    """Return the cause of a beam that returns too weak to be measured with."""
    return Cause(
        "weak-signal",
        f"the signal is {signal:.2f}, signal_min is {bench.optics.signal_min:g}: clean the reflector, check that it "
        "faces the arm and that the beam is aligned (beam-level, beam-to-j4)",
        {"signal": signal},
    )


def off_aim(off_deg: float, beam_mm: float) -> Cause:
    """Return the cause of a beam that returns at another J4 than the plan's."""
    off_mm = float(np.radians(off_deg)) * beam_mm
    return Cause(
        "aim",
        f"the beam returns at J4 {off_deg * 1e3:+.0f} mdeg from its aim, {off_mm:+.2f} mm beside the reflector: has "
        "the reflector or the interferometer been moved? If this goes on, search again (reflector-search)",
        {"off_mdeg": off_deg * 1e3, "off_mm": off_mm},
    )


def hidden(joints: Pose, bench: ScaraBench, reflector: Reflector) -> Cause | None:
    """Return the cause that geometry lets suspect where nothing returns: base column or field."""
    optics = bench.optics
    one, two = np.deg2rad(joints[:2])
    here = forward(one, two, bench.link1_mm, bench.link2_mm)
    clearance_mm = float(column_clearance(here, reflector.xy_mm))
    if clearance_mm < optics.column_radius_mm + optics.column_margin_mm + _NEAR_COLUMN_MM:
        return Cause(
            "column",
            f"nothing returns, and the beam passes the J1 axis at {clearance_mm:.0f} mm (column_radius_mm "
            f"{optics.column_radius_mm:g}): if nothing else stands in its way the base column does; then skip the "
            "point, and raise column_margin_mm in the cell file",
            {"clearance_mm": clearance_mm},
        )
    angle_deg = float(np.rad2deg(field_angle(here, reflector.xy_mm, float(np.deg2rad(reflector.facing_deg)))))
    if angle_deg > optics.field_half_angle_deg - _NEAR_FIELD_DEG:
        return Cause(
            "field",
            f"nothing returns, and the beam meets the reflector at {angle_deg:.0f}° to its axis "
            f"(field_half_angle_deg {optics.field_half_angle_deg:g}): if nothing stands in its way, skip the point, "
            "and lower that angle in the cell file",
            {"angle_deg": angle_deg},
        )
    return None
