"""How a run ended, what it came to, and what is sensible now."""

from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Final

from textual.app import ComposeResult
from textual.containers import Vertical, VerticalScroll
from textual.content import Content

from catseye.app.results.numbers import counted
from catseye.app.results.readiness.after_run import Advice
from catseye.app.tui.run_findings import RunFindings
from catseye.app.tui.run_state import RunState
from catseye.app.tui.widgets.static_text import StaticText, lines

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.results.said import Said

KEYS: Final = {
    "analyse": "i",
    "validate": "t",
    "report": "p",
    "compensate": "e",
    "trend": "b",
    "resume": "r",
    "clear": "x",
    "next": "F3",
}

_MOST_SAID: Final = 4
_LAST_WARNINGS: Final = 2


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

    def show(
        self, run: RunState | None, findings: RunFindings | None, advice: Sequence[Advice], doing: str
    ) -> None:
        """Show the end of a run, or nothing.

        Args:
            findings: what it came to; None before anybody has looked.
            doing: what a command that was begun here says.
        """
        ended = run is not None and not run.active
        self.set_class(ended, "open")
        if run is None or not ended:
            return
        shown = [_outcome(run)]
        if findings is not None:
            shown += [*_found(findings.said), *_warned(run), *_written(findings)]
        keys = [
            Content.assemble((f"{KEYS[each.kind]:>3}  ", "bold $accent"), f"{each.name:<9} {each.text}")
            for each in advice
        ]
        under_way = doing or ("" if findings is None else findings.looking)
        if under_way:
            keys.append(Content.styled(under_way, "$text-muted"))
        self.query_one("#outcome", StaticText).set_text(lines(*shown))
        self.query_one("#advice", StaticText).set_text(lines(*keys))


def _outcome(run: RunState) -> Content:
    if run.ended is None:
        return Content("the run ended while this screen was not connected: Runs (F7) has its record")
    status, text = run.ended.status, run.ended.text
    # The first screen is painted before procedures are imported.
    from catseye.app.protocol.procedures import point_name

    done = run.steps_done
    measured = f", {counted(run.points_seen, point_name(run.procedure))}" if run.points_seen else ""
    facts = f"  {counted(done, 'step')}{measured}"
    style = "bold $success" if status == "complete" else "bold $error"
    return Content.assemble((status.upper(), style), facts + (f": {text}" if text else ""))


def _found(said: "Sequence[Said]") -> list[Content]:
    """Return what was found: figures that stand for the whole where there are such, else the first sentences."""
    from catseye.app.render.signs import SIGNS

    whole = [each for each in said if each.short] or said
    shown = []
    for each in whole[:_MOST_SAID]:
        look = SIGNS[each.sign]
        # Before and after fit into a line; a figure alone needs its sentence.
        text = each.short if "→" in each.short else each.text
        style = f"bold ${look.theme}" if look.theme else "bold"
        shown.append(Content.assemble((f"{look.glyph} ", style), (text, "bold")))
    if len(whole) > _MOST_SAID:
        shown.append(Content.styled(f"  and {len(whole) - _MOST_SAID} more: p shows all", "dim"))
    return shown


def _warned(run: RunState) -> list[Content]:
    """Return how often the run warned, and the last of it."""
    warnings = [line for line in run.log if line.level == "warning"]
    if not warnings:
        return []
    last = list(islice(reversed(warnings), _LAST_WARNINGS))[::-1]
    many = f"{counted(len(warnings), 'warning')}{', the last:' if len(warnings) > len(last) else ':'}"
    return [
        Content.styled(f"! {many} {last[0].text}", "$warning"),
        *(Content.styled(f"  {line.text}", "$warning") for line in last[1:]),
    ]


def _written(findings: RunFindings) -> list[Content]:
    """Return the files of the run, each with the key that shows it."""
    return [
        Content.assemble((f"{name:<9} ", "bold"), (_key_of(name, file, findings.page), "dim"), f"{file}")
        for name, file in findings.written.items()
    ]


def _key_of(name: str, file: Path, page: Path | None) -> str:
    """Return the key that shows a file; of pages only the newest has one."""
    if name == "compensate":
        return "e shows it  "
    if file.suffix == ".html":
        return "o opens it  " if file == page else ""
    return "F6 shows it  " if file.suffix == ".json" else ""
