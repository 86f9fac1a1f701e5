"""The two lines above every screen: what runs, in which state, on what; and the banner of a simulation."""

from rich.text import Text
from textual.app import RenderResult
from textual.reactive import reactive
from textual.widget import Widget

from app.tui.picture import Picture
from app.tui.words import bytes_text, duration_text

_STATES = {
    "EXECUTE": "bold green",
    "STARTING": "bold cyan",
    "HELD": "bold yellow",
    "HOLDING": "bold yellow",
    "SUSPENDED": "bold yellow",
    "ABORTED": "bold red",
    "ABORTING": "bold red",
    "STOPPING": "bold red",
    "STOPPED": "bold red",
    "COMPLETE": "bold green",
}
_LITTLE_BYTES = 1_000_000_000


class StatusBar(Widget):
    """State of engine and bench in two lines."""

    DEFAULT_CSS = """
    StatusBar { height: 2; background: $panel; color: $foreground; }
    """

    revision: reactive[int] = reactive(0)

    def __init__(self) -> None:
        super().__init__()
        self._picture = Picture()
        self._now_s = 0.0

    def show(self, picture: Picture, now_s: float) -> None:
        """Show what is known now."""
        self._picture, self._now_s = picture, now_s
        self.refresh()

    def render(self) -> RenderResult:
        """Return both lines."""
        text = self._first_line()
        text.append("\n")
        text.append_text(self._second_line())
        return text

    def _first_line(self) -> Text:
        picture, text = self._picture, Text(no_wrap=True, overflow="ellipsis")
        if picture.simulated:
            text.append(" SIMULATION ", "bold black on yellow")
            text.append(" ")
        if not picture.connected:
            text.append("no engine ", "bold red")
            if picture.run_out_of_sight and picture.run is not None:
                text.append(f"{picture.run.name} is out of sight ", "bold red")
            text.append(picture.trouble)
            return text
        if picture.silent_since_s is not None:
            silent = duration_text(self._now_s - picture.silent_since_s)
            text.append(f"THE ENGINE HAS NOT ANSWERED FOR {silent}", "bold white on red")
            text.append(f" before: {picture.state}; F12 tries every way", "dim")
            return text
        text.append(f"{picture.state} ", _STATES.get(picture.state, "bold"))
        if picture.jogging:
            text.append("JOG ", "bold magenta")
        if picture.run is not None and picture.run.prompt is not None:
            text.append("QUESTION: F4", "bold black on yellow")
            text.append(" ")
        if picture.run is not None:
            text.append(f"{picture.run.name} ", "" if picture.run.active else "dim")
        if picture.run is not None and not picture.run.active:
            ended = picture.run.ended
            word = str(ended["status"]) if ended else "ended unseen"
            text.append(f"{word} ", "bold green" if word == "complete" else "bold red")
        if picture.aborted:
            text.append(f"aborted: {picture.aborted} ", "red")
        elif picture.reason and picture.state not in {"EXECUTE", "COMPLETE"}:
            text.append(picture.reason)
        return text

    def _second_line(self) -> Text:
        picture, text = self._picture, Text(no_wrap=True, overflow="ellipsis")
        bench = picture.bench
        if bench is None:
            text.append("bench: no sample yet" if picture.connected else "", "dim")
            return text
        since_s = self._now_s - picture.bench_at_s
        for part, style in _bench_parts(bench, since_s):
            text.append(part, style)
            text.append("  ")
        holder = picture.control
        if holder is not None and not picture.in_control:
            text.append(f"control: {holder.get('who')}", "yellow")
        return text


def _bench_parts(bench: dict[str, object], since_s: float) -> list[tuple[str, str]]:
    """Return pieces of the second line with their styles; what is old is dim and says how old it is."""
    parts: list[tuple[str, str]] = [(str(bench.get("cell") or ""), "bold")]
    robot, beam = bench.get("robot"), bench.get("beam")
    if isinstance(robot, dict):
        style, age = age_style(robot.get("age_s"), since_s)
        alarm = f" ALARM {robot['alarm_number']}" if robot.get("alarm_number") else ""
        servo = "on" if robot.get("servo_on") else "off"
        parts.append((f"servo {servo} {robot.get('override_percent', 0):g} %{age}", style))
        if alarm:
            parts.append((alarm.strip(), "bold red"))
        if robot.get("emergency_stop"):
            parts.append(("E-STOP", "bold white on red"))
    if isinstance(beam, dict):
        style, age = age_style(beam.get("age_s"), since_s)
        word = "beam ok" if beam.get("beam_ok") else "NO BEAM"
        parts.append(
            (
                f"{word} {100 * float(beam.get('signal') or 0):.0f} %{age}",
                style if beam.get("beam_ok") else "bold red",
            )
        )
    free = bench.get("disk_free_bytes")
    if isinstance(free, (int, float)):
        parts.append((f"disk {bytes_text(free)}", "bold red" if free < _LITTLE_BYTES else ""))
    return parts


STALE_S = 2.0
"""A value older than this is greyed and says its age."""


def age_style(age_s: object, since_s: float) -> tuple[str, str]:
    """Return style and text for the age of a value.

    Args:
        age_s: its age when it was sent, s; None when it is not known.
        since_s: time since then.
    """
    if not isinstance(age_s, (int, float)):
        return "dim", " (no sample)"
    total_s = age_s + max(since_s, 0.0)
    return ("", "") if total_s <= STALE_S else ("dim", f" ({duration_text(total_s)} old)")
