"""What a real IRB 120 is like: Tables III, IV, VI and VII of the six-axis paper, with its slips mended.

Table VII mixes degrees with rad per N mm: its compliances are rad/(N mm), which agrees with the ranges of Table III.
Table IV exchanges the two tools; nothing here depends on that, the tool is that of the cell.
"""

from typing import Final

from catseye.simulators.config import SerialArm, SerialLoad

BASE: Final = {
    "x_mm": -0.075,
    "y_mm": -0.096,
    "z_mm": 0.103,
    "rx_deg": 0.003,
    "ry_deg": 0.008,
    "rz_deg": -0.033,
}
"""Table VI: errors of the base."""

_PARTS: Final = ("alpha_deg", "a_mm", "theta_offset_deg", "d_mm")

_NOMINAL: Final = (
    (0.0, 0.0, 0.0, 290.0),
    (-90.0, 0.0, -90.0, 0.0),
    (0.0, 270.0, 0.0, 0.0),
    (-90.0, 70.0, 0.0, 302.0),
    (90.0, 0.0, 0.0, 0.0),
    (-90.0, 0.0, 180.0, 72.0),
)
"""Table II: α, a, offset of θ, d."""

_IDENTIFIED: Final = (
    (0.0, 0.0, 0.0, 290.0),
    (-90.006, 0.134, -89.909, 0.0),
    (-0.011, 270.236, 0.054, 0.006),
    (-90.009, 70.138, -0.027, 302.246),
    (89.984, -0.061, 0.067, -0.067),
    (-89.969, 0.022, 179.913, 72.050),
)
"""Table VII."""

COMPLIANCES_RAD_PER_NMM: Final = (0.0, 0.032e-6, 0.130e-6, 0.605e-6, 0.419e-6, 0.647e-6)
"""Table VII; of J1 nothing is known, gravity never loads it."""

LOADS: Final = (SerialLoad(2, 4.2, (140.0, 0.0, 0.0)), SerialLoad(4, 5.0, (0.0, 0.0, -193.6)))
"""Table IV, without tools."""


def is_irb120(arm: SerialArm) -> bool:
    """Return whether an arm is drawn as Table II has it."""
    drawn = tuple((joint.alpha_deg, joint.a_mm, joint.theta_offset_deg, joint.d_mm) for joint in arm.joints)
    return drawn == _NOMINAL


def identified_parts() -> list[dict[str, float]]:
    """Return Table VII's geometry, a joint each."""
    return [dict(zip(_PARTS, row, strict=True)) for row in _IDENTIFIED]
