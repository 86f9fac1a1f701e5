"""What becomes of a run whose front end is lost: the client with control, or whoever reads what the run says."""

from typing import Literal

from catseye.app.protocol.state import ENDED, ENDING, HELD, ControlState

LossPolicy = Literal["continue", "hold", "stop"]
"""`[engine] on_client_lost`."""

OutputPolicy = Literal["go-on", "hold", "stop"]
"""`[engine] on_output_lost`."""

Consequence = Literal["nothing", "warn", "hold", "stop"]


def after_loss(policy: LossPolicy | OutputPolicy, state: ControlState) -> Consequence:
    """Return what is done about a lost front end."""
    if state in ENDED | ENDING:
        return "nothing"
    match policy:
        case "continue" | "go-on":
            return "warn"
        case "stop":
            return "stop"
        case "hold":
            return "nothing" if state in HELD else "hold"


def output_policy(chosen: OutputPolicy | None, *, terminal: bool) -> OutputPolicy:
    """Return what becomes of a run that is read no more.

    What is told is not what is measured, which the run's folder keeps: a pipe or a file is done without. At a
    terminal somebody watches the arm.

    Args:
        chosen: what the cell file says; None for nothing.
        terminal: it was read at a terminal.
    """
    return chosen or ("hold" if terminal else "go-on")
