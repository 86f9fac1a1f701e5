"""The steps of a run: done, under way, and those to come."""

from itertools import islice
from typing import TYPE_CHECKING, Final

from textual.content import Content

from catseye.app.results.numbers import duration_text
from catseye.app.tui.run_state import RunState
from catseye.app.tui.widgets.frame_text import set_subtitle
from catseye.app.tui.widgets.static_text import StaticText, lines

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.rehearsal import RehearsedStep

DONE: Final = "✓"
STORED: Final = "↺"
CURRENT: Final = "▶"
NEXT: Final = "·"


class StepList(StaticText):
    """As many steps around the one under way as there is room for; it can be moved to earlier and later ones."""

    DEFAULT_CSS = """
    StepList { height: 1fr; text-wrap: nowrap; text-overflow: ellipsis; }
    """

    def __init__(self) -> None:
        super().__init__(id="steps", classes="panel")
        self.border_title = "Steps"
        self.moved = 0
        """Lines by which the view is moved from the step under way."""

    def show(self, run: RunState | None) -> None:
        """Show the steps."""
        if run is None:
            self.set_text(Content(""))
            return
        rows = max(self.size.height, 1)
        following = run.to_come
        done, count = len(run.steps), len(run.steps) + len(following)
        # Two thirds of the room for what is done, the rest for what comes.
        room_after = min(len(following), rows // 3)
        start = min(max(done + room_after - rows + self.moved, 0), max(count - rows, 0))
        shown = [_begun(run, step_id) for step_id in islice(run.steps, start, start + rows)]
        first = max(start - done, 0)
        shown += [_to_come(step) for step in following[first : first + rows - len(shown)]]
        self.set_text(lines(*shown) if shown else Content.styled("none yet", "dim"))
        set_subtitle(self, f"{NEXT} {len(following)} to come" if following else "")

    def move(self, by: int, run: RunState | None) -> None:
        """Move the view by lines; beyond the newest it is back at the step under way."""
        most = 0 if run is None else len(run.steps)
        self.moved = max(min(self.moved + by, most), -most)


def _begun(run: RunState, step_id: str) -> Content:
    step = run.steps[step_id]
    if step.status == "current" and run.active:
        return Content.styled(f"{CURRENT} {step.title}", "bold $primary")
    if step.status == "current":
        return Content.styled(f"✗ {step.title}", "$error")
    sign = STORED if step.stored else DONE
    return Content.assemble(
        (sign, "$success"), (f" {step.title}" + (" (done before)" if step.stored else ""), "")
    )


def _to_come(step: "RehearsedStep") -> Content:
    return Content.styled(f"{NEXT} {step.title}  {duration_text(step.duration_s)}", "dim")
