"""The bench of a SCARA with its interferometer, from a cell file."""

import math
from dataclasses import replace

from catseye.app.cell.axes import arm_of, axes_of
from catseye.app.cell.bodies import workspace_of
from catseye.app.cell.model import Cell
from catseye.drivers.roles.pose import Axes
from catseye.procedures.kit.bench import Timing
from catseye.procedures.scara.bench import Alignment, Noise, Optics, Reflector, ScaraBench

_RANGE_KEYS = ("limits_deg.j1", "limits_deg.j2", "j3_mm or j3_range_mm", "limits_deg.j4")


def scara_bench_of(cell: Cell) -> ScaraBench:
    """Return the bench that a cell file describes."""
    robot, measurement = cell.robot, cell.measurement
    heights = robot.j3_range_mm
    return ScaraBench(
        name=cell.name,
        arm=arm_of(cell, _axes(cell), _RANGE_KEYS),
        workspace=workspace_of(cell),
        timing=Timing(
            measurement.settle_time_s,
            measurement.dwell_time_s,
            measurement.readings,
            measurement.spread_limit_um * 1e-3,
        ),
        tracker=cell.tracker is not None,
        link1_mm=robot.link1_mm,
        link2_mm=robot.link2_mm,
        j3_mm=robot.j3_mm,
        j3_range_mm=None if heights is None else (heights[0], heights[1]),
        optics=Optics(**cell.optics.model_dump()),
        reflectors=tuple(
            Reflector(r.name, r.x_mm, r.y_mm, facing_deg(r.x_mm, r.y_mm, r.facing_deg))
            for r in cell.reflector
        ),
        nodes1_deg=tuple(measurement.theta1_deg),
        nodes2_deg=tuple(measurement.theta2_deg),
        take_up_deg=measurement.take_up_deg,
        alignment=Alignment(**cell.alignment.model_dump()),
        noise=_noise(cell),
    )


def facing_deg(x_mm: float, y_mm: float, given_deg: float | None) -> float:
    """Return the direction of a reflector's axis, deg: as given, else towards the J1 axis."""
    return math.degrees(math.atan2(y_mm, x_mm)) + 180.0 if given_deg is None else given_deg


def _axes(cell: Cell) -> Axes:
    """Return the axes with speeds, accelerations and the height of J3 as the cell file states them.

    The acceleration of J3 is not known, so estimates of time leave it out.
    """
    robot, (one, two, height, four) = cell.robot, axes_of(cell)
    low, high = robot.j3_range_mm or (robot.j3_mm, robot.j3_mm)
    turning = zip((one, two, four), robot.speed_deg_s, robot.acceleration_deg_s2, strict=True)
    one, two, four = (replace(axis, speed=speed, acceleration=ramp) for axis, speed, ramp in turning)
    return (one, two, replace(height, low=low, high=high, speed=robot.j3_speed_mm_s), four)


def _noise(cell: Cell) -> Noise:
    stated = cell.uncertainty
    one, two, four = (1e-3 * stated.radial_um(axis) for axis in ("j1", "j2", "j4"))
    return Noise(stated.white_um * 1e-3, (one, two, four), stated.radial_orders)
