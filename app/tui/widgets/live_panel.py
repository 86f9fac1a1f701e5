"""The value that is watched, big, with its acceptance band."""

from typing import TYPE_CHECKING, Final

from textual.app import ComposeResult
from textual.containers import Horizontal
from textual.content import Content
from textual.widgets import Digits

from catseye.app.tui.run_state import RunState
from catseye.app.tui.widgets.band_bar import band_bar, band_text, value_text
from catseye.app.tui.widgets.frame_text import set_title
from catseye.app.tui.widgets.static_text import StaticText, lines
from catseye.app.tui.widgets.status_bar import STALE_S, age_style

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.run_events import LiveData

_NUMBER_ROOM: Final = 28
"""Cells beside the bar: the number, and margins."""


class LivePanel(Horizontal):
    """Shows the newest live value; an old one is greyed and says its age."""

    DEFAULT_CSS = """
    LivePanel { height: 5; }
    LivePanel Digits { width: auto; height: 3; margin-right: 2; }
    LivePanel #band { width: 1fr; }
    LivePanel .stale { color: $text-disabled; }
    """

    def __init__(self) -> None:
        super().__init__(id="live", classes="panel")
        self.border_title = "Live value"

    def compose(self) -> ComposeResult:
        """The number, then band and what to do."""
        yield Digits("")
        yield StaticText(id="band")

    def show(self, run: RunState | None, now_s: float, key: str = "") -> None:
        """Show the value that matters now.

        Args:
            now_s: monotonic time, s.
            key: that answers the open question when the value is as wanted; empty where none does.
        """
        live = None if run is None else run.watched
        number, band = self.query_one(Digits), self.query_one("#band", StaticText)
        if live is None or run is None:
            _set_number(number, "")
            band.set_text(Content.styled("nothing is watched now", "dim"))
            set_title(self, "Live value")
            return
        since_s = now_s - live.at_s
        stale = not run.active or since_s > STALE_S
        text = value_text(live.data.value)
        _set_number(number, text)
        number.set_class(stale, "stale")
        set_title(self, f"{live.data.name}{f' / {live.data.unit}' if live.data.unit else ''}")
        age = age_style(0.0, since_s)[1] if run.active else " (the last one)"
        if run.prompt is None:
            key = age_and_peak = ""
        else:
            judged = live is run.beam or bool(band_text(live.data.low, live.data.high, live.data.unit))
            age_and_peak = f"  peak {value_text(live.peak)}" if judged else ""
            key = key if live.was_out and live.data.accepted and not stale else ""
        shown = _band(live.data, self.size.width - _NUMBER_ROOM, age_and_peak + age, stale=stale)
        if key:
            back = Content.styled(f"the {live.data.name} is back: {key}", "bold $success")
            shown = lines(shown, back)
        band.set_text(shown)


def _set_number(number: Digits, text: str) -> None:
    if number.value != text:
        number.update(text)


def _band(live: "LiveData", width: int, age: str, *, stale: bool) -> Content:
    accepted = band_text(live.low, live.high, live.unit)
    if not accepted:
        return Content.styled(live.text + age, "dim" if stale else "" if live.accepted else "bold $error")
    if live.expanded:
        accepted += f", U {value_text(live.expanded)}"
    word, style = ("IN", "$success") if live.accepted else ("OUT", "bold $error")
    style = "dim" if stale else style
    shown = [
        Content.styled(band_bar(live, width), style),
        Content.assemble((word, style), f"  {accepted}{age}"),
    ]
    if live.text and not live.accepted:
        shown.append(Content(live.text))
    return lines(*shown)
