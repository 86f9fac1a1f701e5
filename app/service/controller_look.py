"""What doctor asks a MELFA controller beyond its state: stop sources, its own limits, the last line of its log."""

from collections.abc import Awaitable, Callable

from catseye.app.engine.before_motion import beyond
from catseye.app.engine.gate import JointLimits
from catseye.drivers.melfa.controller import MelfaController
from catseye.drivers.roles.errors import ProtocolError, RefusedError

Look = tuple[list[str], list[str]]
"""Facts and advice."""


async def look_at_controller(controller: MelfaController, limits: JointLimits) -> Look:
    """Return facts and advice about a connected controller.

    Args:
        controller: to ask.
        limits: of the joints, as the cell file has them.

    Raises:
        LinkError: lost or silent.
    """
    facts: list[str] = []
    advice: list[str] = []
    for look in (_feedback, _stop_sources, lambda c: _limits(c, limits), _last_error):
        said, todo = await _tolerant(look, controller)
        facts += said
        advice += todo
    return facts, advice


async def _tolerant(look: Callable[[MelfaController], Awaitable[Look]], controller: MelfaController) -> Look:
    """Take a question that this firmware does not answer for a fact."""
    try:
        return await look(controller)
    except (RefusedError, ProtocolError) as error:
        return [f"not told by this controller: {error}"], []


async def _feedback(controller: MelfaController) -> Look:
    j1, j2, j3, j4 = await controller.feedback()
    return [f"encoder feedback J1 {j1:.2f}°, J2 {j2:.2f}°, J3 {j3:.2f} mm, J4 {j4:.2f}°"], []


async def _stop_sources(controller: MelfaController) -> Look:
    sources = await controller.stop_sources()
    facts = [f"stop signals: {', '.join(sources.stop) or 'none'}"]
    if sources.emergency:
        facts.append(f"emergency stop by: {', '.join(sources.emergency)}")
    advice = (
        [f"a STOP signal is on ({', '.join(sources.stop)}): release it at its source"] if sources.stop else []
    )
    return facts, advice


async def _limits(controller: MelfaController, limits: JointLimits) -> Look:
    own = await controller.joint_limits()
    told = ", ".join(f"J{n} {low:g}…{high:g}" for n, (low, high) in enumerate(own, start=1))
    return [f"controller's limits (MEJAR): {told}"], beyond(limits, own)


async def _last_error(controller: MelfaController) -> Look:
    entries = await controller.error_log(1)
    if not entries:
        return ["error log: empty"], []
    last = entries[0]
    return [f"error log, last: {last.time} {last.level}{last.number:04d} {last.text}"], []
