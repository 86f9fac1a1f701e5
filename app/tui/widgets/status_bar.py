"""The two lines above every screen: what runs, in which state, on what; and the banner of a simulation."""

from textual.app import RenderResult
from textual.content import Content
from textual.widget import Widget

from catseye.app.commands.progress import duration_text as whole_duration_text
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.words import bytes_text, duration_text

Part = tuple[str, str]
"""Text and style."""

_STATES = {
    "EXECUTE": "$success bold",
    "STARTING": "$primary bold",
    "HELD": "$warning bold",
    "HOLDING": "$warning bold",
    "SUSPENDED": "$warning bold",
    "SUSPENDING": "$error bold",
    "UNSUSPENDING": "$warning bold",
    "ABORTED": "$error bold",
    "ABORTING": "$error bold",
    "STOPPING": "$error bold",
    "STOPPED": "$error bold",
    "COMPLETE": "$success bold",
}
_BANNER = "bold black on orange"
_ALARM = "bold white on darkred"
_LITTLE_BYTES = 1_000_000_000


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
            text.append((" SIMULATION ", _BANNER))
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
        text.append((f"{engine.state} ", _STATES.get(engine.state, "bold")))
        if engine.jogging:
            text.append(("JOG ", "$secondary bold"))
        if engine.run is not None and engine.run.prompt is not None:
            text.append(("QUESTION: F4", _BANNER))
            text.append((" ", ""))
        if engine.run is not None:
            text.append((f"{engine.run.name} ", "" if engine.run.active else "dim"))
        # "aborted" stands before its reason, below.
        if engine.run is not None and not engine.run.active and not engine.aborted:
            ended = engine.run.ended
            word = str(ended["status"]) if ended else "ended unseen"
            text.append((f"{word} ", "$success bold" if word == "complete" else "$error bold"))
        if engine.aborted:
            text.append((f"aborted: {engine.aborted} ", "$error"))
        elif engine.reason and engine.state not in {"EXECUTE", "COMPLETE"}:
            text.append((engine.reason, ""))
        return text

    def _second_line(self) -> list[Part]:
        engine = self._engine
        text: list[Part] = []
        if engine.drives_off_at_s is not None:
            left_s = max(0.0, engine.drives_off_at_s - self._now_s)
            text.append((f"DRIVES ON, off in {whole_duration_text(left_s)} ", _BANNER))
            text.append((" ", ""))
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
            text.append((f"control: {holder.get('who')}", "$warning"))
        return text


def _bench_parts(bench: dict[str, object], since_s: float) -> list[Part]:
    """Return pieces of the second line with their styles; what is old is dim and says how old it is."""
    parts: list[Part] = [(str(bench.get("cell") or ""), "bold")]
    robot, beam = bench.get("robot"), bench.get("beam")
    if isinstance(robot, dict):
        style, age = age_style(robot.get("age_s"), since_s)
        alarm = f" ALARM {robot['alarm_number']}" if robot.get("alarm_number") else ""
        servo = "on" if robot.get("servo_on") else "off"
        parts.append((f"servo {servo} {robot.get('override_percent', 0):g} %{age}", style))
        if alarm:
            parts.append((alarm.strip(), "$error bold"))
        if robot.get("emergency_stop"):
            parts.append(("E-STOP", _ALARM))
    if isinstance(beam, dict):
        style, age = age_style(beam.get("age_s"), since_s)
        word = "beam ok" if beam.get("beam_ok") else "NO BEAM"
        parts.append(
            (
                f"{word} {100 * float(beam.get('signal') or 0):.0f} %{age}",
                style if beam.get("beam_ok") else "$error bold",
            )
        )
    free = bench.get("disk_free_bytes")
    if isinstance(free, (int, float)):
        parts.append((f"disk {bytes_text(free)}", "$error bold" if free < _LITTLE_BYTES else ""))
    return parts


STALE_S = 2.0
"""A value older than this is greyed and says its age."""


def age_style(age_s: object, since_s: float, stale_s: float = STALE_S) -> tuple[str, str]:
    """Return style and text for the age of a value.

    Args:
        age_s: its age when it was sent, s; None when it is not known.
        since_s: time since then.
        stale_s: older than this it is greyed and says its age.
    """
    if not isinstance(age_s, (int, float)):
        return "dim", " (no sample)"
    total_s = age_s + max(since_s, 0.0)
    return ("", "") if total_s <= stale_s else ("dim", f" ({duration_text(total_s)} old)")
