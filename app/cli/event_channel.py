"""What a command reports to the program that started it, beside what people read on stderr."""

import asyncio
import os
import select
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from catseye.app.protocol.channel import EVENTS_FD

if TYPE_CHECKING:
    # A command that nobody listens to starts without these.
    from catseye.app.protocol.commands import CommandEvent


_LOOK_S: Final = 1.0
"""How often somebody looks whether the starter is still there, real s."""

_descriptor: int | None = None


def open_channel() -> None:
    """Take the descriptor to report on from the environment; processes that this one starts do not see it."""
    global _descriptor  # one process reports to one starter
    number = os.environ.pop(EVENTS_FD, "")
    if number.isdecimal():
        with suppress(OSError):
            os.set_inheritable(int(number), False)
            _descriptor = int(number)


async def starter_gone() -> None:
    """Return when the program that started this one has gone; never where none listens."""
    if (descriptor := _descriptor) is None:
        await asyncio.get_running_loop().create_future()
        return
    # Of the writing end of a pipe nothing is asked but whether anybody reads.
    watched = select.poll()
    watched.register(descriptor, 0)
    while not watched.poll(0):  # noqa: ASYNC110  # the kernel tells no event loop
        await asyncio.sleep(_LOOK_S)


def report_progress(title: str, share: float, elapsed_s: float, left_s: float | None, text: str) -> None:
    """Report how far the command is; see `CommandProgress`."""
    if _descriptor is not None:
        from catseye.app.protocol.commands import CommandProgress

        _write(CommandProgress(title=title, share=share, elapsed_s=elapsed_s, left_s=left_s, text=text))


def report_warning(text: str) -> None:
    """Report a warning."""
    if _descriptor is not None:
        from catseye.app.protocol.commands import CommandWarning

        _write(CommandWarning(text=text))


def report_failure(text: str, exit_code: int) -> None:
    """Report why the command ends with a code other than 0."""
    if _descriptor is not None:
        from catseye.app.protocol.commands import CommandFailed

        _write(CommandFailed(text=text, exit_code=exit_code))


def _write(event: "CommandEvent") -> None:
    from catseye.app.protocol.message import encode_object

    # Whoever started this command may be gone; people still read stderr.
    with suppress(OSError):
        if _descriptor is not None:
            os.write(_descriptor, encode_object(event.json_object()))
