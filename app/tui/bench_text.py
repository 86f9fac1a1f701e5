"""The bench as lines that people read."""

import math
from typing import TYPE_CHECKING, Final

from textual.content import Content

from catseye.app.results.numbers import duration_text, fixed, number
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.serial.range_bar import range_bar
from catseye.app.tui.session import EMULATED_ARM, EMULATED_BENCH, EMULATED_TRACKER
from catseye.app.tui.widgets.progress_line import bar
from catseye.app.tui.widgets.status_bar import LITTLE_BYTES, STALE_S, is_dead, override_text, value_style
from catseye.app.tui.words import bytes_text
from catseye.procedures.kit.angular_optics import angle_deg

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.bench import (
        AirStatus,
        AxisRange,
        BeamStatus,
        BenchStatus,
        DeviceStatus,
        RobotStatus,
    )

_SLOW_STALE_S: Final = {"environment": 6.0, "material": 6.0, "tracker": 15.0}
"""Devices that the engine asks every few seconds only: three times that is old."""

_LINKS: Final = {
    "ok": ("●", "$success"),
    "connecting": ("◌", "$warning"),
    "lost": ("✗", "$error bold"),
    "closed": ("○", "dim"),
    "raw": ("≡", "$accent"),
}
_BAR_CELLS: Final = 14
_RANGE_CELLS: Final = 16
_SHORT_RANGE_CELLS: Final = 5
_OFTEN: Final = 20.0
"""Ages below are given to a tenth of a second."""


def device_line(device: "DeviceStatus", since_s: float) -> Content:
    """Return a device in one line: name, link, identity, age of the last answer.

    Args:
        since_s: time since then, s.
    """
    sign, style = _LINKS[device.link]
    # What a dead link said last is as red as the link itself.
    rest = style if device.link == "lost" else ""
    return Content.assemble(
        (f"{sign} ", style),
        (f"{device.name:<15} ", rest),
        (f"{device.link:<10} ", style),
        (f"{_age_text(device.age_s, since_s):>8}  ", rest or ("dim" if _is_old(device, since_s) else "")),
        (device_identity(device), rest),
    )


def device_identity(device: "DeviceStatus") -> str:
    """Return who answers, or where somebody should."""
    identity = device.identity
    if identity is None:
        return f"{device.driver} at {device.endpoint}"
    number = f" s/n {identity.serial}" if identity.serial else ""
    simulated = "  simulated" if identity.simulated else ""
    return f"{identity.model} {identity.firmware}{number}{simulated}"


def device_text(device: "DeviceStatus", alarm: str, since_s: float) -> str:
    """Return everything about a device, to be read and copied."""
    identity = device.identity
    model, firmware, serial, simulated = (
        ("", "", "", None)
        if identity is None
        else (identity.model, identity.firmware, identity.serial, identity.simulated)
    )
    rows = [
        ("link", device.link),
        ("endpoint", device.endpoint),
        ("driver", device.driver),
        ("model", model or "not known"),
        ("firmware", firmware or "not known"),
        ("serial", serial or "not known"),
        ("simulated", _yes_no(simulated)),
        ("last answer", _age_text(device.age_s, since_s)),
    ]
    facts = "\n".join(f"{name:<12} {value}" for name, value in rows)
    return "\n\n".join(text for text in (facts, device.error, alarm) if text)


def troubles(bench: "BenchStatus") -> list[tuple[str, str]]:
    """Return what is wrong, what forbids motion first: name of the device, and the text with its remedy."""
    found: list[tuple[str, str]] = []
    robot, beam = bench.robot, bench.beam
    if robot is not None and robot.emergency_stop:
        found.append(
            ("robot", "the emergency stop is pressed; remove the danger, release it, reset the alarm")
        )
    if robot is not None and robot.alarm_number:
        found.append(("robot", alarm_text(robot) + (" (! resets it)" if robot.resets_alarms else "")))
    if bench.door_closed is False:
        found.append(("door", "it is open, so nothing may move; close it when nobody is inside"))
    if remedy := _without_emulators(bench):
        found.append(("emulators", remedy))
    found += [(device.name, device.error) for device in bench.devices if device.error]
    if beam is not None and not beam.laser_ready:
        found.append(("interferometer", "the laser is not ready; wait until it has warmed up"))
    if beam is not None and beam.overspeed:
        found.append(
            ("interferometer", "the beam was moved too fast and counts are lost; zero it, go slower")
        )
    return found


def _without_emulators(bench: "BenchStatus") -> str:
    """Return how to start the emulators where every device should answer on this machine and none does."""
    devices = bench.devices
    here = all("://127.0.0.1:" in device.endpoint for device in devices)
    if not devices or not here or any(device.link != "lost" for device in devices):
        return ""
    if bench.cell in {EMULATED_BENCH, EMULATED_ARM, EMULATED_TRACKER}:
        return "nothing answers on this machine; F10 starts the emulators again"
    return (
        "nothing answers on this machine; if this cell is emulated, start its emulators: catseye emulate CELL"
    )


def alarm_text(robot: "RobotStatus") -> str:
    """Return a controller's alarm with its remedy; empty when there is none."""
    if not robot.alarm_number:
        return ""
    return robot.alarm_text or f"alarm {robot.alarm_number}; see the controller's manual"


def robot_lines(bench: "BenchStatus | None", since_s: float, *, roomy: bool) -> list[Content]:
    """Return joints, place, drives and speed of the arm.

    Args:
        bench: as it was last; None while nothing is known of it.
        since_s: time since then, s.
        roomy: an arm of many axes has a line for each, with its range.
    """
    if bench is None or bench.robot is None:
        return [Content.styled("no robot answers", "dim")]
    robot = bench.robot
    style, age = value_style(bench, "robot", robot.age_s, since_s)
    return [
        *(Content.styled(line, style) for line in _joint_lines(bench, robot, roomy=roomy)),
        Content.styled(_drives_text(robot), style),
        _alarm_line(robot, age),
        *([] if roomy else [Content.styled(line, style) for line in _torque_lines(robot)]),
    ]


def beam_lines(bench: "BenchStatus | None", since_s: float, spacing_mm: float | None = None) -> list[Content]:
    """Return signal, state and length of the beam, or the angle that it stands for.

    Args:
        bench: as it was last; None while nothing is known of it.
        since_s: time since then, s.
        spacing_mm: of angular optics; None for the length.
    """
    if bench is None or bench.beam is None:
        return [_nobody(bench, "interferometer", "interferometer")]
    beam = bench.beam
    style, age = value_style(bench, "interferometer", beam.age_s, since_s)
    aim = None if bench.layout is None else bench.layout.aim
    state = (
        Content.styled(f"✗ NO LINK{age}", "$error bold")
        if is_dead(bench, "interferometer")
        else _state_line(aim, beam, style, age)
    )
    # Without a beam the count says nothing.
    count = style or ("" if beam.beam_ok else "dim")
    return [
        _signal_line(beam, style),
        state,
        *(_length_lines(beam, count) if spacing_mm is None else _angle_lines(beam, count, spacing_mm)),
    ]


def air_lines(bench: "BenchStatus | None", since_s: float) -> list[Content]:
    """Return state and refractive index of the air, door and disk."""
    air = None if bench is None else bench.air
    if bench is not None and not has_air(bench):
        shown = []
    else:
        shown = [_nobody(bench, "environment", "air sensor")] if air is None else _air(bench, air, since_s)
    return [*shown, *([] if bench is None else [_surroundings(bench)])]


def has_air(bench: "BenchStatus") -> bool:
    """Return whether the cell has a sensor of the air, or a beam that wants one."""
    return bench.device("environment") is not None or not bench.is_without_beam


def engine_lines(engine: EngineState, most: int) -> list[Content]:
    """Return who is connected, who has control, how many messages newer ones replaced, and the last of the log.

    Args:
        most: lines of the log.
    """
    if not engine.connected:
        return [Content.styled(engine.trouble or "no engine yet", "$warning")]
    people = ", ".join(client.who for client in engine.clients) or "—"
    holder = engine.control
    control = "nobody" if holder is None else f"{holder.who}{' (you)' if engine.in_control else ''}"
    styles = {"warning": "$warning", "error": "$error"}
    log = [
        Content.styled(f"{line.t[11:19]} {line.text}", styles.get(line.level, "dim"))
        for line in list(engine.log)[-most:]
    ]
    skipped = engine.missed["bench"] + engine.missed["samples"]
    if skipped:
        log = [Content.styled(f"skipped    {skipped} older values; the newest are shown", "dim"), *log]
    return [Content(f"connected  {people}"), Content(f"control    {control}"), *log]


def length_text(length_mm: float) -> str:
    """Return a length to a nanometre, grouped: 743.123 456 mm."""
    return f"{_grouped(length_mm)} mm"


def _grouped(value: float) -> str:
    whole, _, part = number(value, fixed(6), minus="-").partition(".")
    return f"{whole}.{part[:3]} {part[3:]}"


def _joint_lines(bench: "BenchStatus", robot: "RobotStatus", *, roomy: bool) -> list[str]:
    if robot.joints is None:
        return ["joints not known"]
    if roomy and bench.layout is None:
        torques = robot.torques_nm or [None] * len(robot.joints)
        return [
            _axis_line(axis, value, torque)
            for axis, value, torque in zip(bench.axes, robot.joints, torques, strict=False)
        ]
    values = [
        f"{axis.name} {_joint_text(value)} {axis.unit:<3}"
        for axis, value in zip(bench.axes, robot.joints, strict=False)
    ]
    found = ["   ".join(values[place : place + 2]).rstrip() for place in range(0, len(values), 2)]
    if (known := robot.known_joints) is not None and bench.layout is not None:
        from catseye.app.tui.scara.plan_drawing import pose_of

        x_mm, y_mm = pose_of(bench.layout, known).place_mm
        found.append(f"X  {x_mm:9.3f} mm    Y  {y_mm:9.3f} mm")
    return found


def _axis_line(axis: "AxisRange", value: float | None, torque_nm: float | None) -> str:
    """Return an axis with its range; where its motor's torque is known, the range is shorter."""
    begin = f"{axis.name:<4}{_joint_text(value)} {axis.unit:<4}"
    if torque_nm is None:
        return f"{begin}{range_bar(axis, value, _RANGE_CELLS)}"
    return (
        f"{begin}{range_bar(axis, value, _SHORT_RANGE_CELLS)}{number(torque_nm, fixed(1), minus='-'):>7} N m"
    )


def _torque_lines(robot: "RobotStatus") -> list[str]:
    """Return the torques of all motors in one line, where the axes have no line of their own."""
    if robot.torques_nm is None:
        return []
    values = "".join(f"{number(value, fixed(0), minus='-'):>5}" for value in robot.torques_nm)
    return [f"N m{values}"]


def _joint_text(value: float | None) -> str:
    return f"{'—' if value is None else number(value, fixed(3), minus='-'):>9}"


def _drives_text(robot: "RobotStatus") -> str:
    servo = "on" if robot.servo_on else "off"
    moving = "MOVES" if robot.moving else "stands"
    return f"servo {servo} · {moving} · {override_text(robot)} (cap {robot.override_cap_percent:g})"


def _alarm_line(robot: "RobotStatus", age: str) -> Content:
    modes = " · TEACH mode" * robot.teach_mode + " · MACHINE LOCK" * robot.machine_locked
    if robot.emergency_stop:
        return Content.styled(f"✗ E-STOP pressed{modes}{age}", "$error bold")
    if robot.alarm_number:
        return Content.styled(f"✗ ALARM {robot.alarm_number}{modes}{age}", "$error bold")
    return Content.styled(f"no alarm{modes}{age}", "$warning bold" if modes else "dim")


def _signal_line(beam: "BeamStatus", style: str) -> Content:
    signal = beam.signal or 0.0
    colour = style or ("$success" if beam.beam_ok else "$error")
    native = f"  {beam.signal_native}" if beam.signal_native else ""
    return Content.assemble(
        ("signal ", style),
        (bar(signal, _BAR_CELLS, "·"), colour),
        (f" {100.0 * signal:3.0f} %{native}", style),
    )


def _state_line(aim: str | None, beam: "BeamStatus", style: str, age: str) -> Content:
    if beam.beam_ok:
        word, colour = "● BEAM OK", style or "$success bold"
    else:
        word, colour = "✗ NO BEAM", style or "$error bold"
    latched = "  lost since the zero" if beam.beam_lost else ""
    return Content.assemble(
        (word, colour), (f" → {aim}" if aim else "", style), (latched, style or "$warning"), (age, style)
    )


def _length_lines(beam: "BeamStatus", style: str) -> list[Content]:
    if beam.displacement_mm is None:
        return [Content.styled("displacement not known", "dim")]
    spread = "—" if beam.spread_um is None else f"{beam.spread_um:.2f} µm"
    found = [Content.styled(f"{length_text(beam.displacement_mm):<20}σ {spread}", style)]
    if beam.mean_mm is not None:
        found.append(Content.styled(f"{length_text(beam.mean_mm):<20}mean, 1 s", style))
    return found


def _angle_lines(beam: "BeamStatus", style: str, spacing_mm: float) -> list[Content]:
    turned_deg = None if beam.displacement_mm is None else angle_deg(beam.displacement_mm, spacing_mm)
    if turned_deg is None:
        return [Content.styled("angle not known", "dim")]
    spread = "—"
    if beam.spread_um is not None:
        across_um = 1e3 * spacing_mm * math.cos(math.radians(turned_deg))
        spread = f"{1e3 * math.degrees(beam.spread_um / max(across_um, 1e-9)):.3f} mdeg"
    found = [Content.styled(f"{f'{_grouped(turned_deg)} deg':<20}σ {spread}", style)]
    mean_deg = None if beam.mean_mm is None else angle_deg(beam.mean_mm, spacing_mm)
    if mean_deg is not None:
        found.append(Content.styled(f"{f'{_grouped(mean_deg)} deg':<20}mean, 1 s", style))
    return found


def _nobody(bench: "BenchStatus | None", device: str, name: str) -> Content:
    """Return that a device does not answer, or that the cell has none and where one is described."""
    if bench is not None and bench.device(device) is None:
        return Content.styled(f"the cell has no {name}: F10, 2", "dim")
    return Content.styled(f"no {name} answers", "dim")


def _air(bench: "BenchStatus | None", air: "AirStatus", since_s: float) -> list[Content]:
    style, age = value_style(bench, "environment", air.age_s, since_s, _SLOW_STALE_S["environment"])
    quantities = (
        (air.temperature_c, ".2f", "°C"),
        (air.pressure_hpa, ".1f", "hPa"),
        (air.humidity_percent, ".1f", "%RH"),
    )
    state = "  ".join(
        f"— {unit}" if value is None else f"{value:{form}} {unit}" for value, form, unit in quantities
    )
    index = "n not known" if air.refractive_index is None else f"n = {air.refractive_index:.8f}"
    # The age has room beside the formula alone.
    return [Content.styled(state, style), Content.styled(f"{index}  {air.formula}{age}", style)]


def _surroundings(bench: "BenchStatus") -> Content:
    closed, free = bench.door_closed, bench.disk_free_bytes
    door = "" if closed is None else "door closed  " if closed else "DOOR OPEN  "
    disk = "" if free is None else f"disk {bytes_text(free)} free"
    little = free is not None and free < LITTLE_BYTES
    return Content.assemble(
        (door, "$error bold" if closed is False else ""),
        (f"✗ {disk}" if little else disk, "$error bold" if little else ""),
    )


def _yes_no(flag: bool | None) -> str:
    return "not known" if flag is None else "yes" if flag else "no"


def _is_old(device: "DeviceStatus", since_s: float) -> bool:
    return device.age_s is None or device.age_s + since_s > _SLOW_STALE_S.get(device.name, STALE_S)


def _age_text(age_s: float | None, since_s: float) -> str:
    if age_s is None:
        return "never"
    total_s = age_s + max(since_s, 0.0)
    return f"{total_s:.1f} s" if total_s < _OFTEN else duration_text(total_s)
