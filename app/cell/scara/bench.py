"""The bench of a SCARA with its interferometer, from its sections of a cell file."""

import math
from dataclasses import replace

from catseye.app.cell.scara.sections import Plausibility, ScaraRobot, ScaraSections
from catseye.app.cell.scara.uncertainty import Uncertainty
from catseye.calibration.scara.plausibility.bounds import Bounds
from catseye.procedures.kit.bench import Arm, Bench
from catseye.procedures.scara.bench import Alignment, Noise, Optics, Reflector, ScaraBench

_UNITS = ["deg", "deg", "mm", "deg"]
_RANGE_KEYS = ("limits_deg.j1", "limits_deg.j2", "j3_mm or j3_range_mm", "limits_deg.j4")


def stated_arm(arm: Arm, robot: ScaraRobot) -> Arm:
    """Return a SCARA with the heights, speeds and accelerations of the cell file; any other arm as it is.

    The acceleration of J3 is not known: estimates of time reckon with its speed alone.
    """
    if [axis.unit for axis in arm.axes] != _UNITS:
        return arm
    one, two, height, four = arm.axes
    low, high = robot.j3_range_mm or height.range
    turning = zip((one, two, four), robot.speed_deg_s, robot.acceleration_deg_s2, strict=True)
    one, two, four = (replace(axis, speed=speed, acceleration=ramp) for axis, speed, ramp in turning)
    height = replace(height, low=low, high=high, speed=robot.j3_speed_mm_s)
    return replace(arm, axes=(one, two, height, four), range_keys=_RANGE_KEYS)


def scara_bench(bench: Bench, sections: ScaraSections) -> ScaraBench:
    """Return a bench with what open-loop tracking knows of it; J3 stays at its height unless it has a range.

    Args:
        sections: of the cell file; nothing is missing there.
    """
    robot, measurement, heights = sections.robot, sections.measurement, sections.robot.j3_range_mm
    link1_mm, link2_mm = robot.links_mm
    return ScaraBench(
        name=bench.name,
        arm=bench.arm if heights else _at_height(bench.arm, robot.j3_mm),
        workspace=bench.workspace,
        timing=bench.timing,
        tracker=bench.tracker,
        angular_optics=bench.angular_optics,
        linear_optics=bench.linear_optics,
        link1_mm=link1_mm,
        link2_mm=link2_mm,
        j3_mm=robot.j3_mm,
        j3_range_mm=None if heights is None else (heights[0], heights[1]),
        optics=Optics(**sections.optics.model_dump()),
        reflectors=tuple(
            Reflector(r.name, r.x_mm, r.y_mm, facing_deg(r.x_mm, r.y_mm, r.facing_deg))
            for r in sections.reflectors
        ),
        nodes1_deg=tuple(measurement.theta1_deg),
        nodes2_deg=tuple(measurement.theta2_deg),
        take_up_deg=measurement.take_up_deg,
        alignment=Alignment(**sections.alignment.model_dump()),
        noise=_noise(sections.uncertainty),
        gear_orders=(tuple(robot.gear_orders.j1), tuple(robot.gear_orders.j2)),
        plausibility=_bounds(sections.plausibility),
        tool_zero=robot.tool_zero,
    )


def facing_deg(x_mm: float, y_mm: float, given_deg: float | None) -> float:
    """Return the direction of a reflector's axis, deg: as given, else towards the J1 axis."""
    return math.degrees(math.atan2(y_mm, x_mm)) + 180.0 if given_deg is None else given_deg


def _at_height(arm: Arm, j3_mm: float) -> Arm:
    one, two, height, four = arm.axes
    return replace(arm, axes=(one, two, replace(height, low=j3_mm, high=j3_mm), four))


def _noise(stated: Uncertainty) -> Noise:
    one, two, four = (1e-3 * stated.radial_um(axis) for axis in ("j1", "j2", "j4"))
    changing = tuple(one for one in stated.budget.contributors if one.correlation == "time")
    return Noise(stated.white_um * 1e-3, (one, two, four), stated.radial_orders, changing)


def _bounds(stated: Plausibility) -> Bounds:
    return Bounds(math.radians(1e-3 * stated.deviation_mdeg), stated.link_mm, stated.place_mm)
