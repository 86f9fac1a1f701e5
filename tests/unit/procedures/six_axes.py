"""A bench of six revolute axes in the proportions of an IRB 120, written down by hand."""

import math
from dataclasses import replace

from catseye.calibration.kinematics.bodies import Box, Capsule
from catseye.calibration.kinematics.chain import Chain, Joint
from catseye.drivers.roles.pose import Axis, Pose
from catseye.procedures.kit.bench import Arm, Bench, Timing, Workspace

STRETCHED: Pose = (0.0,) * 6
"""Forearm level: the flange is 302 + 72 mm in front of the first axis and 290 + 270 + 70 mm above the foot."""

REACH_MM, HEIGHT_MM = 374.0, 630.0
TOOL_MM = 50.0
LIMITS_DEG = (165.0, 110.0, 90.0, 160.0, 120.0, 400.0)
SPEEDS_DEG_S = (250.0, 250.0, 250.0, 320.0, 320.0, 420.0)

_ROWS = (
    (0.0, 0.0, 0.0, 290.0),
    (-90.0, 0.0, -90.0, 0.0),
    (0.0, 270.0, 0.0, 0.0),
    (-90.0, 70.0, 0.0, 302.0),
    (90.0, 0.0, 0.0, 0.0),
    (-90.0, 0.0, 180.0, 72.0),
)

CHAIN = Chain(
    tuple(
        Joint(f"A{n}", "revolute", *row, 1.0, -limit, limit)
        for n, (row, limit) in enumerate(zip(_ROWS, LIMITS_DEG, strict=True), 1)
    )
)
AXES = tuple(
    Axis(f"A{n}", "deg", -limit, limit, speed, acceleration=1000.0)
    for n, (limit, speed) in enumerate(zip(LIMITS_DEG, SPEEDS_DEG_S, strict=True), 1)
)
BENCH = Bench(
    name="lab-6",
    arm=Arm(AXES, tuple(f"limits_deg.a{n}" for n in range(1, 7)), override_percent=10.0),
    workspace=Workspace(
        chain=CHAIN,
        bodies=(
            Capsule("foot", 0, (0.0, 0.0, 0.0), (0.0, 0.0, 200.0), 90.0),
            Capsule("forearm", 4, (0.0, 0.0, -200.0), (0.0, 0.0, 0.0), 50.0),
            Capsule("tool", 6, (0.0, 0.0, 0.0), (TOOL_MM, 0.0, 0.0), 10.0),
        ),
        table_z_mm=0.0,
        stand_radius_mm=15.0,
        clearance_mm=5.0,
    ),
    timing=Timing(settle_time_s=0.5, dwell_time_s=0.5, readings=10),
)


def with_post(angle_deg: float) -> Bench:
    """Return the bench with a post where the stretched arm ends when the first axis stands at an angle."""
    x_mm, y_mm = (REACH_MM * turn(math.radians(angle_deg)) for turn in (math.cos, math.sin))
    post = Box("post", (x_mm - 20.0, y_mm - 20.0, 0.0), (x_mm + 20.0, y_mm + 20.0, HEIGHT_MM + 100.0))
    return replace(BENCH, workspace=replace(BENCH.workspace, keep_out=(post,)))
