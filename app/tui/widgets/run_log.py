"""What happened in a run, newest below."""

from typing import Final

from textual.content import Content

from catseye.app.tui.run_state import LogLine, RunState
from catseye.app.tui.widgets.frame_text import set_subtitle, set_title
from catseye.app.tui.widgets.static_text import StaticText, lines

LEVELS: Final = ("info", "warning", "error")
_SIGNS: Final = {"info": " ", "warning": "!", "error": "✗"}
_STYLES: Final = {"info": "", "warning": "$warning", "error": "bold $error"}


class RunLog(StaticText):
    """The last lines that have room, from a chosen level upwards."""

    DEFAULT_CSS = """
    RunLog { text-wrap: nowrap; text-overflow: ellipsis; }
    """

    def __init__(self) -> None:
        super().__init__(id="log", classes="panel")
        self.border_title = "Log"
        self.least = 0
        """Position in `LEVELS` of what is shown at least."""

    def next_level(self) -> None:
        """Show fewer levels, or all again."""
        self.least = (self.least + 1) % len(LEVELS)
        set_title(self, "Log" if self.least == 0 else f"Log: {LEVELS[self.least]} and worse")

    def show(self, run: RunState | None, control: str) -> None:
        """Show the last lines."""
        set_subtitle(self, Content(f"control: {control}"))
        wanted = LEVELS[self.least :]
        found: list[Content] = []
        room = max(self.size.height, 1)
        for line in reversed(run.log if run is not None else ()):
            if room <= 0:
                break
            if line.level in wanted:
                found.append(_line(line))
                room -= self._height(found[-1])
        if room < 0:
            # Rather the oldest line is away than the end of the newest one.
            found = found[:-1] or found
        self.set_text(lines(*reversed(found)))

    def _height(self, line: Content) -> int:
        wrapped = self.styles.text_wrap == "wrap" and self.size.width > 0
        return len(line.wrap(self.size.width)) if wrapped else 1


def _line(line: LogLine) -> Content:
    return Content.assemble(
        (line.t[11:19], "dim"), (f" {_SIGNS[line.level]} {line.text}", _STYLES[line.level])
    )
