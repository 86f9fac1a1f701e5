"""Signal, state and length of the beam, with the strip below."""

from textual.app import ComposeResult
from textual.containers import Vertical

from catseye.app.tui.bench_text import beam_lines
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.widgets.frame_text import set_title
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
        self._plain = False

    def compose(self) -> ComposeResult:
        """Numbers above, strip below."""
        yield StaticText()
        yield Strip()

    def next_unit(self) -> None:
        """Show displacements where angles are shown, or angles again."""
        self._plain = not self._plain

    def next_window(self) -> None:
        """Show another length of time."""
        self.query_one(Strip).next_window()

    def show(self, engine: EngineState, now_s: float) -> None:
        """Show the beam."""
        spacing_mm = None if self._plain else _spacing_mm(engine)
        set_title(self, "Beam" if spacing_mm is None else f"Beam as angle, S = {spacing_mm:g} mm")
        since_s = now_s - engine.bench_at_s
        self.query_one(StaticText).set_text(lines(*beam_lines(engine.bench, since_s, spacing_mm)))
        strip = self.query_one(Strip)
        strip.spacing_mm = spacing_mm
        strip.show(engine, now_s)


def _spacing_mm(engine: EngineState) -> float | None:
    """Return the spacing of the angular optics; None without any, and while straight steps are recorded."""
    optics = None if engine.bench is None else engine.bench.optics
    run = engine.run
    straight = run is not None and run.active and run.staircase and run.staircase[-1].unit == "mm"
    return None if optics is None or straight else optics.spacing_mm
