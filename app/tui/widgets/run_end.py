"""How a run ended, and what is sensible now."""

from collections.abc import Sequence
from typing import Final

from textual.app import ComposeResult
from textual.containers import Vertical, VerticalScroll
from textual.content import Content

from catseye.app.results.numbers import counted
from catseye.app.results.readiness.after_run import Advice
from catseye.app.tui.run_state import RunState
from catseye.app.tui.widgets.static_text import StaticText, lines

KEYS: Final = {"analyse": "i", "report": "p", "resume": "e", "clear": "x", "next": "F3"}


class RunEnd(Vertical):
    """Stands where questions stand while a run is under way."""

    DEFAULT_CSS = """
    RunEnd { height: auto; border: round $primary; padding: 0 1; display: none; }
    RunEnd.open { display: block; }
    RunEnd #how { height: auto; max-height: 7; scrollbar-size-vertical: 1; }
    RunEnd StaticText { height: auto; }
    """

    def __init__(self) -> None:
        super().__init__(id="end")
        self.border_title = "The run has ended"

    def compose(self) -> ComposeResult:
        """How it ended, and the keys for what is sensible now, which stay in sight however long the cause is."""
        with VerticalScroll(id="how", can_focus=False):
            yield StaticText(id="outcome")
        yield StaticText(id="advice")

    def show(self, run: RunState | None, advice: Sequence[Advice], doing: str) -> None:
        """Show the end of a run, or nothing.

        Args:
            doing: what a command that was begun here says.
        """
        ended = run is not None and not run.active
        self.set_class(ended, "open")
        if run is None or not ended:
            return
        shown = [
            Content.assemble((f"{KEYS[each.kind]:>3}  ", "bold $accent"), f"{each.name:<9} {each.text}")
            for each in advice
        ]
        if doing:
            shown.append(Content.styled(doing, "$text-muted"))
        self.query_one("#outcome", StaticText).set_text(_outcome(run))
        self.query_one("#advice", StaticText).set_text(lines(*shown))


def _outcome(run: RunState) -> Content:
    if run.ended is None:
        return Content("it ended while nobody here was connected: Runs (F7) has its record")
    status, text = run.ended.status, run.ended.text
    # The first screen is painted before procedures are imported.
    from catseye.app.protocol.procedures import point_name

    done = sum(step.status == "done" for step in run.steps.values())
    measured = f", {counted(run.points_seen, point_name(run.procedure))}" if run.points_seen else ""
    facts = f"  {counted(done, 'step')}{measured}"
    style = "bold $success" if status == "complete" else "bold $error"
    return Content.assemble((status.upper(), style), facts + (f": {text}" if text else ""))
