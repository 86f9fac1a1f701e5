"""What the screen Run says of a run, and which plots belong to it."""

from functools import cache
from typing import TYPE_CHECKING, Final

from textual.content import Content

from catseye.app.protocol.state import ENDING, ControlState
from catseye.app.tui.engine_state import EngineState

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.procedures.kit.procedure import LivePlots

WALK: Final = "walk"
"""Name of the procedure under which a walk is stored."""


def holder_text(engine: EngineState) -> str:
    """Return who has control."""
    if engine.control is None:
        return "nobody"
    return "you" if engine.in_control else engine.control.text


def idle_plots(engine: EngineState) -> "LivePlots":
    """Return what runs on this bench plot as a rule; what a record shows while no bench is known."""
    if engine.bench is None:
        return "record"
    return "record" if engine.layout is not None or engine.bench.optics is None else "steps"


@cache
def live_plots(procedure: str) -> "LivePlots":
    """Return what is plotted of a procedure's runs."""
    # The first screen is painted before procedures are imported.
    from catseye.app.protocol.procedures import declared_by

    declared = declared_by(procedure)
    return "record" if declared is None else declared.live_plots


def instruction_text(engine: EngineState) -> Content:
    """Return what to do now, in one sentence."""
    run = engine.run
    if run is None and engine.aborted:
        return Content("Find and remove the cause, then press x.")
    if run is None:
        return Content("Start a procedure on Procedures (F3).")
    if not run.active:
        return Content("")
    if run.prompt is not None and run.state not in ENDING:
        return Content.styled("Answer the question below.", "$warning")
    match run.state:
        case ControlState.HELD | ControlState.HOLDING:
            return Content.styled(
                f"F8 continues it; {run.reason}" if run.reason else "F8 continues it.", "$warning"
            )
        case ControlState.SUSPENDED:
            return Content.styled(f"Suspended: {run.reason}", "$warning")
        case ControlState.SUSPENDING:
            return Content.styled(f"Keep clear until the arm is at rest: {run.reason}", "$error")
        case ControlState.UNSUSPENDING:
            return Content.styled(f"Stopped, and nothing moves before you agree: {run.reason}", "$warning")
        case ControlState.ABORTING:
            # The line on top says it.
            return Content("")
        case ControlState.STOPPING:
            return Content.styled(f"Wait for standstill: {run.reason}", "$error")
        case ControlState.STARTING | ControlState.IDLE:
            return Content("Wait while the devices are connected.")
    if run.procedure == WALK:
        to = "" if run.current is None else f" {run.current.title}"
        return Content.styled(
            f"Walking{to}: hold Space, let go to stop. This is not an enabling device.", "$warning"
        )
    return Content(
        "Keep out of the arm's reach." if run.current is None else f"Keep clear: {run.current.title}"
    )
