"""An override of 0 that a run finds: raised by the operator's word, never by the program's own."""

from collections.abc import Awaitable, Callable

from catseye.app.engine.questions import OVERRIDE
from catseye.app.errors import SafetyError
from catseye.drivers.roles.robot import Robot
from catseye.procedures.kit.context import Prompt


async def restore_override(robot: Robot, cap_percent: float, ask: Callable[[Prompt], Awaitable[str]]) -> None:
    """Ask whether an override of 0, as a stop leaves it on some controllers, is to be that of the plan again.

    Args:
        cap_percent: that the cell allows, and with which the run is planned.

    Raises:
        SafetyError: the operator does not agree.
        PromptUnansweredError: nobody is there.
    """
    if (await robot.status()).override_percent > 0.0:
        return
    prompt = OVERRIDE.prompt(
        OVERRIDE.id,
        "The controller's speed override is 0 %, as STOP and the guard leave it. Is nobody in the arm's way, and is "
        f"it to be set to the {cap_percent:g} % that the cell allows? No ends the run: raise it at the controller, "
        "as far as you like below that, then start or resume.",
    )
    if await ask(prompt) != "yes":
        raise SafetyError(
            "the controller's speed override is 0 %: see that the arm is clear, raise it at the controller to at "
            f"most the {cap_percent:g} % that the cell allows, then start or resume"
        )
    await robot.set_override(cap_percent)
