"""The two lines above every screen: what runs, in which state, on what; and the banner of a simulation."""

from textual.app import RenderResult
from textual.content import Content
from textual.widget import Widget

from catseye.app.cli.progress import duration_text as whole_duration_text
from catseye.app.tui.picture import Picture
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
        self._picture = Picture()
        self._now_s = 0.0
        self._lines: tuple[list[Part], ...] = ()

    def show(self, picture: Picture, now_s: float) -> None:
        """Show what is known now; drawn anew only where it says something else, as a dialog is with it."""
        self._picture, self._now_s = picture, now_s
        lines = (self._first_line(), self._second_line())
        if lines != self._lines:
            self._lines = lines
            self.refresh()

    def render(self) -> RenderResult:
        """Return both lines."""
        return Content("\n").join([Content.assemble(*line) for line in self._lines])

    def _first_line(self) -> list[Part]:
        picture = self._picture
        text: list[Part] = []
        if picture.simulated:
            text.append((" SIMULATION ", _BANNER))
            text.append((" ", ""))
        if not picture.connected:
            text.append(("no engine ", "$error bold"))
            if picture.run_out_of_sight and picture.run is not None:
                text.append((f"{picture.run.name} is out of sight ", "$error bold"))
            # An engine that did not start says it in several lines.
            text.append((" ".join(picture.trouble.split()), ""))
            return text
        if picture.silent_since_s is not None:
            silent = duration_text(self._now_s - picture.silent_since_s)
            text.append((f"THE ENGINE HAS NOT ANSWERED FOR {silent}", _ALARM))
            text.append((f" before: {picture.state}; F12 tries every way", "dim"))
            return text
        text.append((f"{picture.state} ", _STATES.get(picture.state, "bold")))
        if picture.jogging:
            text.append(("JOG ", "$secondary bold"))
        if picture.run is not None and picture.run.prompt is not None:
            text.append(("QUESTION: F4", _BANNER))
            text.append((" ", ""))
        if picture.run is not None:
            text.append((f"{picture.run.name} ", "" if picture.run.active else "dim"))
        # "aborted" stands before its reason, below.
        if picture.run is not None and not picture.run.active and not picture.aborted:
            ended = picture.run.ended
            word = str(ended["status"]) if ended else "ended unseen"
            text.append((f"{word} ", "$success bold" if word == "complete" else "$error bold"))
        if picture.aborted:
            text.append((f"aborted: {picture.aborted} ", "$error"))
        elif picture.reason and picture.state not in {"EXECUTE", "COMPLETE"}:
            text.append((picture.reason, ""))
        return text

    def _second_line(self) -> list[Part]:
        picture = self._picture
        text: list[Part] = []
        if picture.drives_off_at_s is not None:
            left_s = max(0.0, picture.drives_off_at_s - self._now_s)
            text.append((f"DRIVES ON, off in {whole_duration_text(left_s)} ", _BANNER))
            text.append((" ", ""))
        bench = picture.bench
        if bench is None:
            text.append(("bench: no sample yet" if picture.connected else "", "dim"))
            return text
        since_s = self._now_s - picture.bench_at_s
        for part, style in _bench_parts(bench, since_s):
            text.append((part, style))
            text.append(("  ", ""))
        holder = picture.control
        if holder is not None and not picture.in_control:
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
