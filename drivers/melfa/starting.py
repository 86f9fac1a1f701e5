"""The start of a stored program: once, and never on top of one that runs (sheet 1.9)."""

from collections.abc import Callable
from functools import partial

from catseye.drivers.links.healing import Repeat
from catseye.drivers.melfa.motion import sent_once, unstarted_polls
from catseye.drivers.melfa.session import Session
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import LinkError, NotReadyError, NotSentError, ProtocolError

_WHILE_RUNNING = 5640
_LOOKS = unstarted_polls(0.0)


async def start_once(
    session: Session, clock: Clock, settings: MelfaSettings, name: str, permit: Callable[[], None]
) -> None:
    """Reset the slot and start a program from its first line; leave it alone if it runs.

    RUN is written once. When its answer is lost, the controller is asked whether the program runs.

    Args:
        name: by which RUN starts it.
        permit: is asked right before the start is written; what it raises keeps it from being sent.

    Raises:
        AlarmError: an alarm is active.
        NotReadyError: another program runs, or refused for a reason that an operator has to look at.
        RefusedError: there is no such program, or it cannot be started.
        LinkError: lost or silent, or it is not seen to run after the answer to its start was lost.
    """
    if await _runs(session, name):
        return
    await sent_once(
        partial(session.command, "RSTPRG", repeat=Repeat.HARMLESS),
        partial(_run, session, clock, settings, name, permit),
    )


async def _run(
    session: Session, clock: Clock, settings: MelfaSettings, name: str, permit: Callable[[], None]
) -> None:
    """Start the program; look whether it runs when the answer is lost."""
    try:
        await session.command(f"RUN{name};1", permit=permit)
    except NotSentError:
        raise
    except (LinkError, ProtocolError) as lost:
        for _ in range(_LOOKS):
            # A stop that overtook the start is the reason that counts.
            permit()
            await session.raise_alarm("RUN")
            if await _runs(session, name):
                return
            await clock.sleep(settings.poll_s)
        raise LinkError(
            f"{session.where}: the answer to the start of {name} is lost ({lost}), and it does not run: it was not "
            "started a second time; look at the controller, then go on"
        ) from lost


async def _runs(session: Session, name: str) -> bool:
    """Return whether the program runs.

    Raises:
        NotReadyError: another one does.
    """
    state = await session.state()
    running = state.program.upper().partition(".")[0]
    # A controller may give no name.
    if state.running and running not in {"", name.upper()}:
        raise NotReadyError(
            f"{session.where}: the program {running} runs on the controller, {name} was not started: stop it there",
            _WHILE_RUNNING,
        )
    return state.running
