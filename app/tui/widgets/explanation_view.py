"""What a procedure does, and a sketch of its set-up."""

from typing import TYPE_CHECKING

from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.content import Content

from catseye.app.tui.widgets.static_text import StaticText

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.results.readiness.survey_document import ProcedureEntry


class ExplanationView(VerticalScroll):
    """A paragraph and a sketch; the arrow keys scroll what has no room."""

    DEFAULT_CSS = """
    ExplanationView { height: auto; scrollbar-size-vertical: 1; }
    ExplanationView StaticText { height: auto; width: 1fr; }
    ExplanationView .sketch { text-wrap: nowrap; color: $accent; margin-top: 1; }
    """

    def compose(self) -> ComposeResult:
        """The paragraph and the sketch."""
        yield StaticText(classes="paragraph")
        yield StaticText(classes="sketch")

    def show(self, procedure: "ProcedureEntry") -> None:
        """Show a procedure."""
        text = procedure.about or "there is no description of this procedure"
        self.query_one(".paragraph", StaticText).set_text(Content(text))
        self.query_one(".sketch", StaticText).set_text(Content(procedure.sketch))
        self.scroll_home(animate=False)
