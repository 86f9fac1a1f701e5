"""Signal, state and length of the beam, with the strip below."""

from textual.app import ComposeResult
from textual.containers import Vertical

from catseye.app.tui.bench_text import beam_lines
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.widgets.static_text import StaticText, lines
from catseye.app.tui.widgets.strip import Strip


class BeamPanel(Vertical):
    """The beam as it is now and was in the last seconds."""

    DEFAULT_CSS = """
    BeamPanel { height: 1fr; }
    BeamPanel StaticText { height: auto; text-wrap: nowrap; text-overflow: ellipsis; }
    """

    def __init__(self) -> None:
        super().__init__(classes="panel")
        self.border_title = "Beam"

    def compose(self) -> ComposeResult:
        """Numbers above, strip below."""
        yield StaticText()
        yield Strip()

    def next_window(self) -> None:
        """Show another length of time."""
        self.query_one(Strip).next_window()

    def show(self, engine: EngineState, now_s: float) -> None:
        """Show the beam."""
        self.query_one(StaticText).set_text(lines(*beam_lines(engine.bench, now_s - engine.bench_at_s)))
        self.query_one(Strip).show(engine, now_s)
