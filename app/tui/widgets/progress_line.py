"""How far a run is: a bar, percent, steps, time passed and left."""

from textual.content import Content

from catseye.app.results.numbers import counted, duration_text
from catseye.app.tui.run_state import RunState
from catseye.app.tui.widgets.static_text import StaticText

_EIGHTHS = " ▏▎▍▌▋▊▉█"


class ProgressLine(StaticText):
    """One line."""

    DEFAULT_CSS = """
    ProgressLine { height: 1; padding: 0 1; text-wrap: nowrap; text-overflow: ellipsis; }
    """

    def show(self, run: RunState | None, planned: int, skipped: int, *, fast: bool) -> None:
        """Show what is known.

        Args:
            planned: steps of the whole run; 0 where that is not known.
            skipped: updates that did not reach this client.
            fast: bench time runs faster than real time.
        """
        if run is None:
            self.set_text(Content.styled("no run yet: start one on Procedures (F3)", "dim"))
            return
        parts: list[Content | str | tuple[str, str]] = []
        if run.progress is not None and run.active:
            share = run.progress.share
            parts += [(bar(share, max(10, self.size.width // 5)), "$primary"), f" {100.0 * share:3.0f} %  "]
        done = sum(step.status == "done" for step in run.steps.values())
        parts.append(f"{done} of {planned} steps" if planned >= done > 0 else counted(done, "step"))
        if run.progress is not None:
            parts.append(f"  passed {duration_text(run.progress.elapsed_s)}")
            if run.active:
                parts.append(f"  left {duration_text(run.progress.remaining_s)}")
            if fast:
                parts.append(" bench time")
            if run.active and run.progress.text:
                parts.append((f"  {run.progress.text}", "$text-muted"))
        if skipped:
            parts.append((f"  {skipped} updates skipped here, all are in the record", "dim"))
        self.set_text(Content.assemble(*parts))


def bar(share: float, width: int, empty: str = "░") -> str:
    """Return a bar of block characters, to an eighth of a cell.

    Args:
        share: 0…1 of it is full.
        width: in characters.
        empty: character of a cell that is not full at all.
    """
    eighths = round(min(max(share, 0.0), 1.0) * width * 8)
    full, rest = divmod(eighths, 8)
    return ("█" * full + (_EIGHTHS[rest] if rest else "")).ljust(width, empty)
