"""What the engine tells of the bench, as lines that people read."""

from typing import Any, Final

from textual.content import Content

from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.session import EMULATED_BENCH
from catseye.app.tui.widgets.status_bar import STALE_S, age_style
from catseye.app.tui.words import bytes_text, duration_text

Part = dict[str, Any]

_SLOW_STALE_S: Final = {"environment": 6.0, "material": 6.0, "tracker": 15.0}
"""Devices that the engine asks every few seconds only: three times that is old."""

_LINKS: Final = {
    "ok": ("●", "$success"),
    "connecting": ("◌", "$warning"),
    "lost": ("✗", "$error bold"),
    "closed": ("○", "dim"),
    "raw": ("≡", "$accent"),
}
_LITTLE_BYTES: Final = 1_000_000_000
_BLOCKS: Final = " ▏▎▍▌▋▊▉█"
_BAR_CELLS: Final = 14
_OFTEN: Final = 20.0
"""Ages below are told to a tenth of a second."""


def device_line(device: Part, since_s: float) -> Content:
    """Return a device in one line: name, link, identity, age of the last answer.

    Args:
        device: of the message about the bench.
        since_s: time since that message, s.
    """
    sign, style = _LINKS.get(str(device["link"]), ("?", ""))
    return Content.assemble(
        (f"{sign} ", style),
        f"{device['name']:<15} ",
        (f"{device['link']:<10} ", style),
        (f"{_age_text(device.get('age_s'), since_s):>8}  ", "dim" if _is_old(device, since_s) else ""),
        device_identity(device),
    )


def device_identity(device: Part) -> str:
    """Return who answers, or where somebody should."""
    identity = device.get("identity")
    if not identity:
        return f"{device['driver']} at {device['endpoint']}"
    number = f" s/n {identity['serial']}" if identity.get("serial") else ""
    simulated = "  simulated" if identity.get("simulated") else ""
    return f"{identity['model']} {identity['firmware']}{number}{simulated}"


def device_text(device: Part, alarm: str, since_s: float) -> str:
    """Return everything about a device, to be read and copied."""
    identity = device.get("identity") or {}
    rows = [
        ("link", str(device["link"])),
        ("endpoint", str(device["endpoint"])),
        ("driver", str(device["driver"])),
        ("model", str(identity.get("model") or "not known")),
        ("firmware", str(identity.get("firmware") or "not known")),
        ("serial", str(identity.get("serial") or "not known")),
        ("simulated", _yes_no(identity.get("simulated"))),
        ("last answer", _age_text(device.get("age_s"), since_s)),
    ]
    told = "\n".join(f"{name:<12} {value}" for name, value in rows)
    troubles = [text for text in (device.get("error"), alarm) if text]
    return "\n\n".join([told, *map(str, troubles)])


def troubles(bench: Part) -> list[tuple[str, str]]:
    """Return what is wrong, what forbids motion first: name of the device, and the text with its remedy."""
    found: list[tuple[str, str]] = []
    robot, beam = bench.get("robot") or {}, bench.get("beam") or {}
    if robot.get("emergency_stop"):
        found.append(
            ("robot", "the emergency stop is pressed; remove the danger, release it, reset the alarm")
        )
    if robot.get("alarm_number"):
        found.append(("robot", alarm_text(robot)))
    if bench.get("door_closed") is False:
        found.append(("door", "it is open and nothing may move; close it when nobody is inside"))
    if remedy := _without_emulators(bench):
        found.append(("emulators", remedy))
    found += [
        (str(each["name"]), str(each["error"])) for each in bench.get("devices", ()) if each.get("error")
    ]
    if beam and not beam.get("laser_ready", True):
        found.append(("interferometer", "the laser is not ready; wait until it has warmed up"))
    if beam.get("overspeed"):
        found.append(
            ("interferometer", "the beam was moved too fast and counts are lost; zero it, go slower")
        )
    return found


def _without_emulators(bench: Part) -> str:
    """Return how to start the emulators where every device should answer on this machine and none does."""
    devices = bench.get("devices") or ()
    here = all("://127.0.0.1:" in str(each["endpoint"]) for each in devices)
    if not devices or not here or any(each["link"] != "lost" for each in devices):
        return ""
    if bench.get("cell") == EMULATED_BENCH:
        return "nobody answers on this machine; F10 and e start the emulators again"
    return "nobody answers on this machine; where this cell is emulated, start them: catseye emulate CELL"


def alarm_text(robot: Part) -> str:
    """Return a controller's alarm with its remedy; empty when there is none."""
    if not robot.get("alarm_number"):
        return ""
    return str(robot.get("alarm_text") or f"alarm {robot['alarm_number']}; see the controller's manual")


def robot_lines(bench: Part, since_s: float) -> list[Content]:
    """Return joints, place, drives and speed of the arm.

    Args:
        bench: message about the bench.
        since_s: time since it came, s.
    """
    robot = bench.get("robot")
    if not robot:
        return [Content.styled("no robot answers", "dim")]
    style, age = age_style(robot.get("age_s"), since_s)
    return [
        *(Content.styled(line, style) for line in _joint_lines(robot.get("joints"), bench.get("layout"))),
        Content.styled(_drives_text(robot), style),
        _alarm_line(robot, age),
    ]


def beam_lines(bench: Part, since_s: float) -> list[Content]:
    """Return signal, state and length of the beam.

    Args:
        bench: message about the bench.
        since_s: time since it came, s.
    """
    beam = bench.get("beam")
    if not beam:
        return [Content.styled("no interferometer answers", "dim")]
    style, age = age_style(beam.get("age_s"), since_s)
    return [_signal_line(beam, style), _state_line(bench, beam, style, age), *_length_lines(beam, style)]


def air_lines(bench: Part, since_s: float) -> list[Content]:
    """Return state and refractive index of the air, door and disk."""
    return [*_air(bench.get("air"), since_s), _surroundings(bench)]


def engine_lines(engine: EngineState, most: int) -> list[Content]:
    """Return who is connected, who has control, how many messages newer ones replaced, and the last of the log.

    Args:
        engine: as far as it is known.
        most: lines of the log.
    """
    if not engine.connected:
        return [Content.styled(engine.trouble or "no engine yet", "$warning")]
    people = ", ".join(str(each.get("who")) for each in engine.clients) or "—"
    holder = engine.control
    control = "nobody" if holder is None else f"{holder.get('who')}{' (you)' if engine.in_control else ''}"
    styles = {"warning": "$warning", "error": "$error"}
    log = [
        Content.styled(f"{line.t[11:19]} {line.text}", styles.get(line.level, "dim"))
        for line in list(engine.log)[-most:]
    ]
    skipped = engine.missed.get("bench", 0) + engine.missed.get("samples", 0)
    if skipped:
        log = [Content.styled(f"skipped    {skipped} older values; the newest are shown", "dim"), *log]
    return [Content(f"connected  {people}"), Content(f"control    {control}"), *log]


def signal_bar(signal: float, cells: int = _BAR_CELLS) -> str:
    """Return a bar that is filled by a share from 0 to 1, to an eighth of a cell."""
    eighths = round(min(max(signal, 0.0), 1.0) * cells * 8)
    full, rest = divmod(eighths, 8)
    return ("█" * full + (_BLOCKS[rest] if rest else "")).ljust(cells, "·")


def length_text(length_mm: float) -> str:
    """Return a length to a nanometre, grouped: 743.123 456 mm."""
    whole, _, part = f"{length_mm:.6f}".partition(".")
    return f"{whole}.{part[:3]} {part[3:]} mm"


def _joint_lines(joints: list[float] | None, layout: Part | None) -> list[str]:
    if joints is None:
        return ["joints not known"]
    from catseye.app.tui.widgets.plan_drawing import pose_of

    one, two, three, four = joints
    lines = [f"J1 {one:9.3f} deg   J2 {two:9.3f} deg", f"J3 {three:9.3f} mm    J4 {four:9.3f} deg"]
    if layout:
        x_mm, y_mm = pose_of(layout, joints).place_mm
        lines.append(f"X  {x_mm:9.3f} mm    Y  {y_mm:9.3f} mm")
    return lines


def _drives_text(robot: Part) -> str:
    servo = "on" if robot.get("servo_on") else "off"
    moving = "MOVES" if robot.get("moving") else "stands"
    cap = robot.get("override_cap_percent")
    capped = f" (cap {cap:g})" if cap is not None else ""
    return f"servo {servo} · {moving} · {robot.get('override_percent', 0):g} %{capped}"


def _alarm_line(robot: Part, age: str) -> Content:
    teach = " · TEACH mode" if robot.get("teach_mode") else ""
    if robot.get("emergency_stop"):
        return Content.styled(f"✗ E-STOP pressed{teach}{age}", "$error bold")
    if robot.get("alarm_number"):
        return Content.styled(f"✗ ALARM {robot['alarm_number']}{teach}{age}", "$error bold")
    return Content.styled(f"no alarm{teach}{age}", "$warning bold" if teach else "dim")


def _signal_line(beam: Part, style: str) -> Content:
    signal = float(beam.get("signal") or 0.0)
    colour = style or ("$success" if beam.get("beam_ok") else "$error")
    native = f"  {beam['signal_native']}" if beam.get("signal_native") else ""
    return Content.assemble(
        ("signal ", style), (signal_bar(signal), colour), (f" {100.0 * signal:3.0f} %{native}", style)
    )


def _state_line(bench: Part, beam: Part, style: str, age: str) -> Content:
    if beam.get("beam_ok"):
        word, colour = "● BEAM OK", style or "$success bold"
    else:
        word, colour = "✗ NO BEAM", style or "$error bold"
    latched = "  lost since the zero" if beam.get("beam_lost") else ""
    aim = (bench.get("layout") or {}).get("aim")
    return Content.assemble(
        (word, colour), (f" → {aim}" if aim else "", style), (latched, style or "$warning"), (age, style)
    )


def _length_lines(beam: Part, style: str) -> list[Content]:
    length_mm, spread_um, mean_mm = (beam.get(name) for name in ("displacement_mm", "spread_um", "mean_mm"))
    if length_mm is None:
        return [Content.styled("displacement not known", "dim")]
    spread = "—" if spread_um is None else f"{spread_um:.2f} µm"
    lines = [Content.styled(f"{length_text(length_mm):<20}σ {spread}", style)]
    if mean_mm is not None:
        lines.append(Content.styled(f"{length_text(mean_mm):<20}mean, 1 s", style))
    return lines


def _air(air: Part | None, since_s: float) -> list[Content]:
    if not air:
        return [Content.styled("no air sensor answers", "dim")]
    style, age = age_style(air.get("age_s"), since_s, _SLOW_STALE_S["environment"])
    quantities = (
        ("temperature_c", ".2f", "°C"),
        ("pressure_hpa", ".1f", "hPa"),
        ("humidity_percent", ".1f", "%RH"),
    )
    state = "  ".join(
        f"{air[name]:{form}} {unit}" if air.get(name) is not None else f"— {unit}"
        for name, form, unit in quantities
    )
    index = air.get("refractive_index")
    told = f"n = {index:.8f}" if index is not None else "n not known"
    return [
        Content.styled(f"{state}{age}", style),
        Content.styled(f"{told}  {air.get('formula') or ''}", style),
    ]


def _surroundings(bench: Part) -> Content:
    closed = bench.get("door_closed")
    door = "" if closed is None else "door closed  " if closed else "DOOR OPEN  "
    free = bench.get("disk_free_bytes")
    disk = f"disk {bytes_text(free)} free" if isinstance(free, (int, float)) else ""
    little = isinstance(free, (int, float)) and free < _LITTLE_BYTES
    return Content.assemble(
        (door, "$error bold" if closed is False else ""),
        (f"✗ {disk}" if little else disk, "$error bold" if little else ""),
    )


def _yes_no(flag: bool | None) -> str:
    return "not known" if flag is None else "yes" if flag else "no"


def _is_old(device: Part, since_s: float) -> bool:
    age_s = device.get("age_s")
    return age_s is None or age_s + since_s > _SLOW_STALE_S.get(str(device.get("name")), STALE_S)


def _age_text(age_s: float | None, since_s: float) -> str:
    if age_s is None:
        return "never"
    total_s = age_s + max(since_s, 0.0)
    return f"{total_s:.1f} s" if total_s < _OFTEN else duration_text(total_s)
