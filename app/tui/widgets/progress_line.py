"""How far a run is: a bar, percent, steps, time passed and left."""

from typing import TYPE_CHECKING, Final

from textual.content import Content

from catseye.app.protocol.state import ControlState
from catseye.app.results.numbers import counted, duration_text
from catseye.app.tui.run_pace import RunPace
from catseye.app.tui.run_state import RunState
from catseye.app.tui.widgets.static_text import StaticText

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.run_events import Progressed

_STANDS: Final = {
    ControlState.HELD: "held",
    ControlState.SUSPENDED: "suspended",
    ControlState.UNSUSPENDING: "stopped",
}
"""Why a run stands that asks nothing."""

_EIGHTHS = " ▏▎▍▌▋▊▉█"
_MOST_BEFORE_THE_END: Final = 0.99
"""What time alone makes of the part that is done: only the engine knows that nothing is left."""

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
        expected_s = _expected_s(run)
        # Past its end a rehearsal does not tell any more how far the run is.
        late = progress is None and since_s > expected_s + _PATIENCE_S
        if run.active and (progress is not None or (expected_s and not late)):
            share = _share(progress, since_s, expected_s)
            parts += [(bar(share, max(10, self.size.width // 5)), "$primary"), f" {100.0 * share:3.0f} %  "]
        parts.append(_steps_text(run))
        asked = run.active and run.prompt is not None
        if asked:
            # It stands where no width cuts it off.
            parts.append(
                (f"  waiting for you: {duration_text(max(now_s - run.prompt_at_s, 0.0))}", "$warning")
            )
        elif run.active and (why := _STANDS.get(run.state)) and run.pace.stands_since_s is not None:
            parts.append((f"  {why}: {duration_text(max(now_s - run.pace.stands_since_s, 0.0))}", "$warning"))
        if progress is None and expected_s:
            left = _left(run.pace, expected_s - since_s)
            parts.append("  longer than rehearsed" if late else f"  {left}, as rehearsed")
        if progress is not None:
            if run.active:
                # It stands where no width cuts it off.
                parts.append(f"  {_left(run.pace, progress.left_bench_s - since_s)}")
            if not asked:
                parts.append(f"  passed {duration_text(progress.elapsed_bench_s + since_s)}")
            if speed != 1.0:
                parts.append(" bench time")
            if run.active and not asked and progress.text:
                parts.append((f"  {progress.text}", "$text-muted"))
        if skipped:
            parts.append((f"  {skipped} updates skipped here, all are in the record", "dim"))
        self.set_text(Content.assemble(*parts))


def _steps_text(run: RunState) -> str:
    """Return how many steps are done, of how many: what was rehearsed may be fewer, and a run may end before."""
    done = run.steps_done
    complete = run.ended is not None and run.ended.status == "complete"
    if run.rehearsal is None or not done or complete:
        return counted(done, "step")
    return f"{done} of {len(run.steps.keys() | {step.step for step in run.rehearsal.steps})} steps"


def _expected_s(run: RunState) -> float:
    """Return how long the run takes by its rehearsal until its engine says a word of it; 0 where nobody knows."""
    return run.rehearsed_s if run.seen_begin and run.pace.progress is None and run.active else 0.0


def _share(progress: "Progressed | None", since_s: float, expected_s: float) -> float:
    """Return the part of the run that is done: by the last word of its engine, before that by its rehearsal."""
    if progress is None:
        return min(since_s / expected_s, _MOST_BEFORE_THE_END) if expected_s > 0.0 else 1.0
    share = min(progress.done / progress.total, 1.0) if progress.total > 0.0 else 1.0
    left_s = progress.left_bench_s
    reckoned = share + (1.0 - share) * min(since_s / left_s, 1.0) if left_s > 0.0 else share
    return max(share, min(reckoned, _MOST_BEFORE_THE_END))


def _left(pace: RunPace, left_s: float) -> str:
    """Return the time left; an end that has moved away says so."""
    if left_s < -_PATIENCE_S:
        return "longer than estimated"
    later = f", {duration_text(pace.grown_s)} more than expected" if pace.grown_s else ""
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
