"""The two lines above every screen: what runs, in which state, on what; and the banner of a simulation."""

from typing import TYPE_CHECKING, Final

from textual.app import RenderResult
from textual.content import Content
from textual.widget import Widget

from catseye.app.protocol.banners import SIMULATION
from catseye.app.protocol.state import ControlState
from catseye.app.results.numbers import duration_text
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.words import bytes_text

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.bench import BenchStatus, RobotStatus

Part = tuple[str, str]
"""Text and style."""

_STATES: Final[dict[ControlState, str]] = {
    ControlState.EXECUTE: "$success bold",
    ControlState.STARTING: "$primary bold",
    ControlState.HELD: "$warning bold",
    ControlState.HOLDING: "$warning bold",
    ControlState.SUSPENDED: "$warning bold",
    ControlState.SUSPENDING: "$error bold",
    ControlState.UNSUSPENDING: "$warning bold",
    ControlState.ABORTED: "$error bold",
    ControlState.STOPPING: "$error bold",
    ControlState.STOPPED: "$error bold",
    ControlState.COMPLETE: "$success bold",
}
_BANNER = "bold black on orange"
_ALARM = "bold white on darkred"
LITTLE_BYTES = 1_000_000_000
"""Less free disk than this stands out."""


class StatusBar(Widget):
    """State of engine and bench in two lines."""

    DEFAULT_CSS = """
    StatusBar { height: 2; background: $panel; color: $foreground; text-wrap: nowrap; text-overflow: ellipsis; }
    """

    def __init__(self) -> None:
        super().__init__()
        self._engine = EngineState()
        self._now_s = 0.0
        self._lines: tuple[list[Part], ...] = ()

    def show(self, engine: EngineState, now_s: float) -> None:
        """Show what is known now; drawn anew only where it says something else, as a dialog is with it."""
        self._engine, self._now_s = engine, now_s
        lines = (self._first_line(), self._second_line())
        if lines != self._lines:
            self._lines = lines
            self.refresh()

    def render(self) -> RenderResult:
        """Return both lines."""
        return Content("\n").join([Content.assemble(*line) for line in self._lines])

    def _first_line(self) -> list[Part]:
        engine = self._engine
        text: list[Part] = []
        if engine.simulated:
            text.append((f" {SIMULATION} ", _BANNER))
            text.append((" ", ""))
        if not engine.connected:
            text.append(("no engine ", "$error bold"))
            if engine.run_out_of_sight and engine.run is not None:
                text.append((f"{engine.run.name} is out of sight ", "$error bold"))
            # An engine that did not start says it in several lines.
            text.append((" ".join(engine.trouble.split()), ""))
            return text
        if engine.silent_since_s is not None:
            silent = duration_text(self._now_s - engine.silent_since_s)
            text.append((f"THE ENGINE HAS NOT ANSWERED FOR {silent}", _ALARM))
            text.append((f" before: {engine.state}; F12 tries every way", "dim"))
            return text
        if what := _abort_text(engine):
            text.append((f" {what} ", _ALARM))
            return text
        text.append((f"{engine.state} ", _STATES.get(engine.state, "bold")))
        if engine.jogging:
            text.append(("JOG ", "$secondary bold"))
        if engine.run is not None and engine.run.prompt is not None:
            text.append(("QUESTION: F4", _BANNER))
            text.append((" ", ""))
        if engine.run is not None:
            text.append((f"{engine.run.name} ", "" if engine.run.active else "dim"))
        if engine.run is not None and not engine.run.active:
            ended = engine.run.ended
            word = "ended unseen" if ended is None else ended.status
            text.append((f"{word} ", "$success bold" if word == "complete" else "$error bold"))
        if engine.reason and engine.state not in {ControlState.EXECUTE, ControlState.COMPLETE}:
            text.append((engine.reason, ""))
        return text

    def _second_line(self) -> list[Part]:
        engine = self._engine
        text: list[Part] = []
        if drives := _drives_text(engine, self._now_s):
            text += [(f"{drives} ", _BANNER), (" ", "")]
        bench = engine.bench
        if bench is None:
            text.append(("bench: no sample yet" if engine.connected else "", "dim"))
            return text
        since_s = self._now_s - engine.bench_at_s
        for part, style in _bench_parts(bench, since_s):
            text.append((part, style))
            text.append(("  ", ""))
        holder = engine.control
        if holder is not None and not engine.in_control:
            text.append((f"control: {holder.who}", "$warning"))
        return text


def _drives_text(engine: EngineState, now_s: float) -> str:
    """Return when the drives go off by themselves; empty where they are off, or nothing switches them off."""
    if engine.drives_off_at_s is None:
        return ""
    if is_dead(engine.bench, "robot"):
        return "DRIVES ON when last seen"
    robot = engine.robot
    if robot is not None and not robot.servo_on and robot.age_s + now_s - engine.bench_at_s <= STALE_S:
        # Somebody has switched them off at the controller, or it was restarted.
        return ""
    left_s = max(0.0, engine.drives_off_at_s - now_s)
    return f"DRIVES ON, off in {duration_text(left_s, whole=True)}"


def _abort_text(engine: EngineState) -> str:
    """Return what to do about an abort, then why it came; empty without one."""
    if engine.aborted:
        return f"Look at the bench, then F4 and x.  ABORTED: {engine.aborted}"
    if engine.state is ControlState.ABORTING:
        return f"Keep clear until the arm is at rest.  ABORTING: {engine.reason}"
    return ""


def _bench_parts(bench: "BenchStatus", since_s: float) -> list[Part]:
    """Return pieces of the second line with their styles; what is old is dim and says how old it is."""
    parts: list[Part] = [(bench.cell, "bold")]
    robot, beam, free = bench.robot, bench.beam, bench.disk_free_bytes
    if robot is not None:
        style, age = value_style(bench, "robot", robot.age_s, since_s)
        servo = "on" if robot.servo_on else "off"
        parts.append((f"servo {servo} {override_text(robot)}{age}", style))
        if robot.alarm_number:
            parts.append((f"ALARM {robot.alarm_number}", "$error bold"))
        if robot.emergency_stop:
            parts.append(("E-STOP", _ALARM))
    if beam is not None:
        style, age = value_style(bench, "interferometer", beam.age_s, since_s)
        word = "NO LINK" if is_dead(bench, "interferometer") else "beam ok" if beam.beam_ok else "NO BEAM"
        parts.append(
            (f"{word} {100 * (beam.signal or 0.0):.0f} %{age}", style if beam.beam_ok else "$error bold")
        )
    if free is not None:
        parts.append((f"disk {bytes_text(free)}", "$error bold" if free < LITTLE_BYTES else ""))
    return parts


STALE_S = 2.0
"""A value older than this is greyed and says its age."""


def age_style(age_s: float | None, since_s: float, stale_s: float = STALE_S) -> tuple[str, str]:
    """Return style and text for the age of a value.

    Args:
        age_s: its age when it was sent, s; None when it is not known.
        stale_s: older than this it is greyed and says its age.
    """
    if age_s is None:
        return "dim", " (no sample)"
    total_s = age_s + max(since_s, 0.0)
    return ("", "") if total_s <= stale_s else ("dim", f" ({duration_text(total_s)} old)")


def is_dead(bench: "BenchStatus | None", device: str) -> bool:
    """Return whether the link of a device is lost: what it said last says nothing about now."""
    found = None if bench is None else bench.device(device)
    return found is not None and found.link == "lost"


def value_style(
    bench: "BenchStatus | None", device: str, age_s: float | None, since_s: float, stale_s: float = STALE_S
) -> tuple[str, str]:
    """Return style and text for the age of a value of a device: red at once where its link is lost.

    Args:
        device: its name in the cell file.
        age_s: its age when it was sent, s; None when it is not known.
        stale_s: older than this it is greyed and says its age.
    """
    style, age = age_style(age_s, since_s, stale_s)
    return ("$error", age or " (link lost)") if is_dead(bench, device) else (style, age)


def override_text(robot: "RobotStatus") -> str:
    """Return the speed override now; a dash where the controller gives no number."""
    return "—" if robot.override_percent is None else f"{robot.override_percent:g} %"
