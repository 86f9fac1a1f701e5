"""The cell file as procedures and emulators need it."""

import math
from typing import cast

from catseye.app.cell.bodies import workspace_of
from catseye.app.cell.model import Cell
from catseye.app.errors import ConfigError
from catseye.drivers.roles.registry import driver_names, load_driver
from catseye.drivers.roles.robot import RobotClass
from catseye.procedures.kit.bench import Alignment, Arm, Bench, Noise, Optics, Reflector, Timing


def bench_of(cell: Cell) -> Bench:
    """Return the bench that a cell file describes."""
    return Bench(
        name=cell.name,
        arm=_arm(cell),
        workspace=workspace_of(cell),
        optics=Optics(**cell.optics.model_dump()),
        timing=Timing(
            cell.measurement.settle_time_s,
            cell.measurement.dwell_time_s,
            cell.measurement.readings,
            cell.measurement.spread_limit_um * 1e-3,
        ),
        reflectors=tuple(
            Reflector(r.name, r.x_mm, r.y_mm, facing_deg(r.x_mm, r.y_mm, r.facing_deg))
            for r in cell.reflector
        ),
        nodes1_deg=tuple(cell.measurement.theta1_deg),
        nodes2_deg=tuple(cell.measurement.theta2_deg),
        take_up_deg=cell.measurement.take_up_deg,
        alignment=Alignment(**cell.alignment.model_dump()),
        noise=_noise(cell),
        tracker=cell.tracker is not None,
    )


def facing_deg(x_mm: float, y_mm: float, given_deg: float | None) -> float:
    """Return the direction of a reflector's axis, deg: as given, else towards the J1 axis."""
    return math.degrees(math.atan2(y_mm, x_mm)) + 180.0 if given_deg is None else given_deg


def _noise(cell: Cell) -> Noise:
    stated = cell.uncertainty
    one, two, four = (1e-3 * stated.radial_um(axis) for axis in ("j1", "j2", "j4"))
    return Noise(stated.white_um * 1e-3, (one, two, four), stated.radial_orders)


def _arm(cell: Cell) -> Arm:
    robot, limits = cell.robot, cell.robot.limits_deg
    return Arm(
        link1_mm=robot.link1_mm,
        link2_mm=robot.link2_mm,
        j1_limits_deg=(limits.j1[0], limits.j1[1]),
        j2_limits_deg=(limits.j2[0], limits.j2[1]),
        j4_limits_deg=(limits.j4[0], limits.j4[1]),
        j3_mm=robot.j3_mm,
        j3_range_mm=None if robot.j3_range_mm is None else (robot.j3_range_mm[0], robot.j3_range_mm[1]),
        speed_deg_s=_triple(robot.speed_deg_s),
        j3_speed_mm_s=robot.j3_speed_mm_s,
        acceleration_deg_s2=_triple(robot.acceleration_deg_s2),
        override_percent=robot.override_cap_percent,
        following=robot_driver(robot.driver).abilities.following,
        follow_speed_deg_s=robot.follow_speed_deg_s,
        follow_acceleration_deg_s2=robot.follow_acceleration_deg_s2,
    )


def robot_driver(driver: str) -> type[RobotClass]:
    """Return the class of a robot's driver.

    Raises:
        ConfigError: no such driver is installed, or it is none of a robot.
    """
    try:
        return cast("type[RobotClass]", load_driver(driver, "robot"))
    except LookupError as error:
        raise ConfigError(f"[robot] driver: {error.args[0]}") from error


def _triple(values: list[float]) -> tuple[float, float, float]:
    first, second, third = values
    return first, second, third


def may_move_an_arm(device: str, driver: str) -> bool:
    """Return whether bytes that are sent to a device of a cell file may move an arm."""
    return device == "robot" or (driver in driver_names() and load_driver(driver).role == "robot")
