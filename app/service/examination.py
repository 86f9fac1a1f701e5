"""Who answers behind each endpoint of a cell, what is wrong and what to do."""

import asyncio
from collections import defaultdict
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any

from catseye.app.cell.bench import bench_of
from catseye.app.cell.model import Air, Cell
from catseye.app.engine.before_motion import beyond
from catseye.app.engine.compensation import Compensation
from catseye.app.engine.instruments import device_builder, further_device
from catseye.app.engine.interlock import NO_DOOR
from catseye.app.errors import UsageError
from catseye.app.protocol.examination import DeviceExamination
from catseye.drivers.roles.air import AirSensor
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.device import Device, Entry, Role
from catseye.drivers.roles.errors import DeviceError, ProtocolError, RefusedError
from catseye.drivers.roles.interferometer import Interferometer
from catseye.drivers.roles.io import Io
from catseye.drivers.roles.pose import pose_text
from catseye.drivers.roles.registry import load_driver
from catseye.drivers.roles.robot import Robot
from catseye.drivers.roles.tracker import Tracker
from catseye.procedures.kit.bench import Arm, Bench
from catseye.procedures.kit.expanded import EXPANDED
from catseye.procedures.kit.motion.body_speed import top_speed_mm_s

Look = Callable[[], Awaitable[tuple[list[str], list[str]]]]
"""Returns facts and advice about a connected device."""


@dataclass(frozen=True)
class StopCause:
    """Why the arm is stopped, and how long that takes.

    Attributes:
        text: what happens.
        limit_s: longest time from there to STOP on the controller's wire, s; docs/evidence.md
            has the figures.
    """

    text: str
    limit_s: float


STOP_CAUSES = (
    StopCause("the STOP key", 0.05),
    StopCause("the program killed", 0.1),
    StopCause("the door opened", 0.3),
    StopCause("the door's input silent", 0.4),
    StopCause("the program stopped or blocked", 0.7),
)


async def examine(cell: Cell, only: str | None) -> list[DeviceExamination]:
    """Connect to every device of a cell, or to one of them, and look at it.

    Raises:
        UsageError: the cell has no such device.
    """
    clock, rule, bench = SystemClock(), cell.air, bench_of(cell)
    heals: dict[str, list[str]] = defaultdict(list)

    def record(device: str, entry: Entry, data: bytes) -> None:
        if entry == "heal":
            heals[device].append(data.decode())

    devices = device_builder(cell, clock)(record)
    further = [(device, further_device(device, clock, record)) for device in cell.device]
    drivers: list[tuple[str, str, Role, Any]] = [
        (role, section.endpoint, role, devices.named()[role]) for role, section in cell.instruments.items()
    ]
    drivers += [
        (device.name, device.endpoint, load_driver(device.driver).role, driver) for device, driver in further
    ]
    names = [name for name, *_ in drivers]
    if only is not None and only not in names:
        raise UsageError(f"--device {only}: the cell has no such device; there are {', '.join(names)}")
    examinations = list(
        await asyncio.gather(
            *(
                _examine(name, endpoint, driver, _look_at(role, driver, rule, bench.arm))
                for name, endpoint, role, driver in drivers
                if only in {None, name}
            )
        )
    )
    for examined in examinations:
        examined.healed = heals[examined.device]
        if examined.device == "robot" and examined.identity:
            examined.status.append(stopping_text(bench, cell.robot.override_cap_percent))
            if not examined.simulated and cell.io is None:
                examined.status.append(f"note: {NO_DOOR}")
    return examinations


def _look_at(role: Role, driver: Any, rule: Air, arm: Arm) -> Look:
    """Return the look at a driver of a role."""
    looks: dict[Role, Look] = {
        "robot": lambda: look_at_robot(driver, arm),
        "interferometer": lambda: _beam(driver, rule),
        "environment": lambda: _air(driver),
        "io": lambda: _door(driver),
        "tracker": lambda: _tracker(driver),
    }
    return looks[role]


async def _examine(
    device: str,
    endpoint: str,
    driver: Device,
    look: Look,
) -> DeviceExamination:
    examined = DeviceExamination(device=device, endpoint=endpoint)
    try:
        who = await driver.connect()
        examined.identity = " ".join(part for part in (who.model, who.firmware, who.serial) if part)
        examined.simulated = who.simulated
        examined.status, examined.advice = await look()
        more = await driver.examine()
        examined.status += [*more.facts, *(f"note: {note}" for note in driver.notes)]
        examined.advice += more.advice
        examined.ok = not examined.advice
    except DeviceError as error:
        examined.advice.append(str(error))
    finally:
        await driver.close()
    return examined


async def look_at_robot(robot: Robot, arm: Arm) -> tuple[list[str], list[str]]:
    """Return where the robot stands and its controller's state, and what to do about it."""
    status, joints = await robot.status(), await robot.joints()
    facts = [
        f"joints {pose_text(arm.axes, joints)}",
        f"servo {'on' if status.servo_on else 'off'}, override {status.override_percent:g} %",
    ]
    advice = []
    if status.alarm_number:
        advice.append(f"alarm {status.alarm_number}: {status.alarm_text}")
    if status.emergency_stop:
        advice.append("the emergency stop is pressed: release it at the bench, then reset the alarm")
    if status.teach_mode:
        advice.append("the key switch is at TEACH: turn it to AUTO and disable the teach pendant")
    if status.machine_locked:
        advice.append("the machine lock is on, the arm does not move: switch it off at the controller")
    more_facts, more_advice = await look_at_limits(robot, arm)
    return facts + more_facts, advice + more_advice


async def look_at_limits(robot: Robot, arm: Arm) -> tuple[list[str], list[str]]:
    """Return the controller's own limits, and what to do about ranges of the cell file beyond them."""
    try:
        own = await robot.joint_limits()
    except (RefusedError, ProtocolError) as error:
        return [f"not answered by this controller: {error}"], []
    if own is None:
        return [], []
    listed = ", ".join(
        f"{axis.name} {low:g}…{high:g}" for axis, (low, high) in zip(arm.axes, own, strict=True)
    )
    return [f"controller's limits (MEJAR): {listed}"], beyond(arm, own)


async def _beam(counter: Interferometer, air: Air) -> tuple[list[str], list[str]]:
    status, reading = await counter.status(), await counter.read()
    facts = [
        f"displacement {reading.displacement_mm:+.6f} mm, signal {status.signal:.0%}, "
        f"beam {'returns' if status.beam_ok else 'does not return'}"
        f"{', lost since the last zero' if status.beam_lost else ''}"
        f"{', overspeed since the last zero' if status.overspeed else ''}",
        Compensation(counter.compensated, air).sentence,
        assumed_count(counter.count_mm),
    ]
    return facts, [] if status.laser_ready else ["the laser is not stable: let it warm up"]


def assumed_count(count_mm: float | None) -> str:
    """Return in words which sign and scale of the count the driver assumes.

    Args:
        count_mm: displacement that 1 in the instrument's number means, mm; None where the driver does not say.
    """
    if count_mm is None:
        counted = "displacements grow with the beam and are in mm, as the driver gives them"
    else:
        way = "longer" if count_mm > 0.0 else "shorter"
        counted = f"the instrument's number grows while the beam grows {way}, and 1 in it is {_length(abs(count_mm))}"
    return f"assumed, not checked since nothing moves: {counted}"


def _length(length_mm: float) -> str:
    return f"{length_mm:g} mm" if length_mm >= 1e-3 else f"{1e6 * length_mm:.9g} nm"


async def _air(sensor: AirSensor) -> tuple[list[str], list[str]]:
    air = await sensor.sample()
    parts = [
        ("temperature", air.temperature_c, "°C"),
        ("pressure", air.pressure_hpa, "hPa"),
        ("humidity", air.humidity_percent, "%RH"),
    ]
    facts = [", ".join(f"{name} {value:.2f} {unit}" for name, value, unit in parts if value is not None)]
    missing = [name for name, value, _ in parts if value is None]
    advice = [
        f"no {name}: check the sensor, and its register in [environment] against the sensor's manual"
        for name in missing
    ]
    return facts, advice


async def _door(io: Io) -> tuple[list[str], list[str]]:
    if await io.door_closed():
        return ["door closed"], []
    return ["door open"], ["the door is open: nothing will move; close it when nobody is inside"]


async def _tracker(tracker: Tracker) -> tuple[list[str], list[str]]:
    if tracker.abilities.points or tracker.abilities.poses:
        # It says itself how it is; a measurement might search a target, and a table is waited for.
        return [], []
    seen = await tracker.locate()
    return [f"x {seen.x_mm:.4f} mm, y {seen.y_mm:.4f} mm, U {1e3 * EXPANDED * seen.u_mm:.1f} µm (k = 2)"], []


def stopping_text(bench: Bench, percent: float) -> str:
    """Return how far the fastest point of the arm can travel until STOP is written, by cause, in words.

    Args:
        bench: bodies and fastest joints, as the cell file states them.
        percent: speed override.
    """
    speed_mm_s = top_speed_mm_s(bench, percent)
    travels = ", ".join(f"{cause.text} {speed_mm_s * cause.limit_s:.0f} mm" for cause in STOP_CAUSES)
    return (
        f"at an override of {percent:g} % nothing on the arm is faster than {speed_mm_s:.0f} mm/s; until STOP is "
        f"written it travels at most: {travels}; the controller's own reaction and braking come on top: measure them"
    )
