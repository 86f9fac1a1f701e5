"""What a MELFA controller says beyond its state: encoders, stop sources, the last line of its log."""

from collections.abc import Awaitable, Callable

from catseye.drivers.melfa.controller import MelfaController
from catseye.drivers.roles.device import Examination
from catseye.drivers.roles.errors import ProtocolError, RefusedError


async def examination_of(controller: MelfaController) -> Examination:
    """Return facts and advice about a connected controller.

    Raises:
        LinkError: lost or silent.
    """
    found = [await _tolerant(look, controller) for look in (_feedback, _stop_sources, _last_error)]
    return Examination(
        tuple(fact for one in found for fact in one.facts),
        tuple(text for one in found for text in one.advice),
    )


async def _tolerant(
    look: Callable[[MelfaController], Awaitable[Examination]], controller: MelfaController
) -> Examination:
    """Take a question that this firmware does not answer for a fact."""
    try:
        return await look(controller)
    except (RefusedError, ProtocolError) as error:
        return Examination((f"not answered by this controller: {error}",))


async def _feedback(controller: MelfaController) -> Examination:
    j1, j2, j3, j4 = await controller.feedback()
    return Examination((f"encoder feedback J1 {j1:.2f}°, J2 {j2:.2f}°, J3 {j3:.2f} mm, J4 {j4:.2f}°",))


async def _stop_sources(controller: MelfaController) -> Examination:
    sources = await controller.stop_sources()
    facts = [f"stop signals: {', '.join(sources.stop) or 'none'}"]
    if sources.emergency:
        facts.append(f"emergency stop by: {', '.join(sources.emergency)}")
    advice = (
        (f"a STOP signal is on ({', '.join(sources.stop)}): release it at its source",)
        if sources.stop
        else ()
    )
    return Examination(tuple(facts), advice)


async def _last_error(controller: MelfaController) -> Examination:
    entries = await controller.error_log(1)
    if not entries:
        return Examination(("error log: empty",))
    last = entries[0]
    return Examination((f"error log, last: {last.time} {last.level}{last.number:04d} {last.text}",))
