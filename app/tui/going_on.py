"""What moves when a run goes on, after a hold or a question, and whether it is still the hold that was read of."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from catseye.app.results.numbers import duration_text
from catseye.app.results.rehearsal import brief_text
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.motion_text import distance_text, rehearsed_row, row, speed_rows, way_rows
from catseye.app.tui.run_state import RunState

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.rehearsal import RehearsedStep


def going_on_lines(engine: EngineState, run: RunState, now_s: float) -> list[str]:
    """Return where the arm goes when the run is let go, how far, how fast, and whether that was rehearsed.

    Args:
        now_s: monotonic time, s.
    """
    progress = run.pace.progress
    left = [] if progress is None else [row("time left", duration_text(progress.left_bench_s, whole=True))]
    return [
        f"{run.name} goes on where it was held",
        *_next_lines(engine, run, now_s),
        *left,
        *speed_rows(engine),
        rehearsed_row(run.rehearsal),
    ]


def ahead_text(engine: EngineState, run: RunState, now_s: float) -> str:
    """Return how far the arm goes after the open question, for how long, and what the rehearsal found.

    Args:
        now_s: monotonic time, s.

    Returns:
        Empty where nothing moves after it.
    """
    asked = run.prompt
    if asked is None or not asked.motion:
        return ""
    step = next_step(run)
    if asked.target is not None:
        way = f"distance {distance_text(engine, asked.target, now_s, asked.override_percent)}"
    elif step is not None:
        target = _goes_first(run, step)
        way = f"{step.title}, distance {distance_text(engine, target, now_s, asked.override_percent)}"
    else:
        way = ""
    found = "not rehearsed here" if run.rehearsal is None else f"rehearsed: {brief_text(run.rehearsal)}"
    return "; ".join(part for part in (way, found) if part)


def hold_changed(engine: EngineState) -> Callable[[], str]:
    """Return what says how a hold differs from the one of now; empty as long as it is the same."""

    def hold() -> tuple[object, ...]:
        run = engine.run
        return (run, engine.states_told, None if run is None else run.prompt)

    def override_percent() -> float | None:
        return None if engine.robot is None else engine.robot.override_percent

    before, read_percent = hold(), override_percent()

    def changed() -> str:
        if not engine.held:
            return "the run is not held any more"
        if hold() != before:
            return "the run has been held again"
        return "" if override_percent() == read_percent else "the override has changed"

    return changed


def _next_lines(engine: EngineState, run: RunState, now_s: float) -> list[str]:
    """Return the target of the step under way, or of the next one, as far as the rehearsal knows it."""
    step = next_step(run)
    if step is not None:
        return [row("step", step.title), *way_rows(engine, _goes_first(run, step), now_s)]
    under_way = [] if run.current is None else [row("step", run.current.title)]
    return [*under_way, row("target", f"not known: {_why_unknown(run)}")]


def _why_unknown(run: RunState) -> str:
    if run.rehearsal is not None:
        return "the rehearsal has no motion from this step on"
    if not run.command:
        return "how to rehearse this run is not known"
    return "this run is not rehearsed yet; Run (F4) rehearses it while it is shown"


def _goes_first(run: RunState, step: "RehearsedStep") -> tuple[float, ...]:
    """Return where a step takes the arm first; of one under way, whose next motion nobody knows, where it ends."""
    begun = run.current is not None and run.current.id == step.step
    return step.end if begun or step.first is None else step.first


def next_step(run: RunState) -> "RehearsedStep | None":
    """Return the step of the rehearsal that moves the arm next; None where nobody knows."""
    planned = () if run.rehearsal is None else run.rehearsal.steps
    current = run.current
    ahead = [step for step in planned if current is not None and step.step == current.id]
    return next((step for step in (*ahead, *run.to_come) if step.moves), None)
