"""What becomes of a run whose front end is lost: the client with control, or the reader of the headless events."""

from typing import Literal

from catseye.app.protocol.state import ENDED, ENDING, HELD, ControlState

LossPolicy = Literal["continue", "hold", "stop"]
"""`[engine] on_client_lost`; for a lost reader of the headless events "hold": no cell file says anything of it."""

Consequence = Literal["nothing", "warn", "hold", "stop"]


def after_loss(policy: LossPolicy, state: ControlState) -> Consequence:
    """Return what is done about a lost front end."""
    if state in ENDED | ENDING:
        return "nothing"
    match policy:
        case "continue":
            return "warn"
        case "stop":
            return "stop"
        case "hold":
            return "nothing" if state in HELD else "hold"
