"""How far a run is: a bar, percent, steps, time passed and left."""

from textual.content import Content

from catseye.app.results.numbers import counted, duration_text
from catseye.app.tui.run_pace import RunPace
from catseye.app.tui.run_state import RunState
from catseye.app.tui.widgets.static_text import StaticText

_EIGHTHS = " ▏▎▍▌▋▊▉█"
_PATIENCE_S = 2.0
"""So much past its estimate a run counts as on time."""


class ProgressLine(StaticText):
    """One line."""

    DEFAULT_CSS = """
    ProgressLine { height: 1; padding: 0 1; text-wrap: nowrap; text-overflow: ellipsis; }
    """

    def show(self, run: RunState | None, skipped: int, now_s: float, speed: float) -> None:
        """Show what is known.

        Args:
            skipped: updates that did not reach this client.
            now_s: monotonic time, s.
            speed: bench seconds in one real second.
        """
        if run is None:
            self.set_text(Content.styled("no run yet: start one on Procedures (F3)", "dim"))
            return
        parts: list[Content | str | tuple[str, str]] = []
        progress, since_s = run.pace.progress, run.pace.since_s(now_s, speed) if run.active else 0.0
        if progress is not None and run.active:
            share = min((progress.done + since_s) / progress.total, 1.0) if progress.total > 0.0 else 1.0
            parts += [(bar(share, max(10, self.size.width // 5)), "$primary"), f" {100.0 * share:3.0f} %  "]
        done = sum(step.status == "done" for step in run.steps.values())
        planned = 0 if run.rehearsal is None else len(run.rehearsal.steps)
        parts.append(f"{done} of {planned} steps" if planned >= done > 0 else counted(done, "step"))
        asked = run.active and run.prompt is not None
        if asked:
            # It stands where no width cuts it off.
            parts.append(
                (f"  waiting for you: {duration_text(max(now_s - run.prompt_at_s, 0.0))}", "$warning")
            )
        if progress is not None:
            if not asked:
                parts.append(f"  passed {duration_text(progress.elapsed_s + since_s)}")
            if run.active:
                parts.append(f"  {_left(run.pace, progress.remaining_s - since_s)}")
            if speed != 1.0:
                parts.append(" bench time")
            if run.active and not asked and progress.text:
                parts.append((f"  {progress.text}", "$text-muted"))
        if skipped:
            parts.append((f"  {skipped} updates skipped here, all are in the record", "dim"))
        self.set_text(Content.assemble(*parts))


def _left(pace: RunPace, left_s: float) -> str:
    """Return the time left; an end that has moved away says so."""
    if left_s < -_PATIENCE_S:
        return "longer than estimated"
    later = f", {duration_text(pace.grown_s)} more than it looked" if pace.grown_s else ""
    return f"left {duration_text(max(left_s, 0.0))}{later}"


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
