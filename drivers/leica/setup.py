"""What a connection to an emScon server is brought into before anything is measured, and whether it still is."""

from collections.abc import Callable
from typing import Protocol, TypeVar

from catseye.drivers.leica import codec
from catseye.drivers.leica.commands import (
    EXTENDED,
    NOT_IMPLEMENTED,
    OK,
    RIGHT_HANDED,
    STANDARD,
    STATIONARY,
    UNITS,
    Command,
    status_text,
)
from catseye.drivers.leica.settings import LeicaSettings
from catseye.drivers.links.link import Decoder
from catseye.drivers.roles.errors import RefusedError

T = TypeVar("T")

_APPLY_TRANSFORMATION, _APPLY_ORIENTATION, _UNSOLICITED, _REFLECTOR_POSITIONS, _TRY_MODE = 1, 2, 4, 5, 6
"""Places within the nine system settings."""

_FRAME = (_APPLY_TRANSFORMATION, _APPLY_ORIENTATION)

_OFF = (*_FRAME, _UNSOLICITED, _REFLECTOR_POSITIONS, _TRY_MODE)


class Ask(Protocol):
    """Sends a request and returns what its decoder makes of the answer."""

    async def __call__(self, data: bytes, decoder: Callable[[], Decoder[T]]) -> T:
        """Ask; raises what the link raises."""
        ...


async def reply_to(ask: Ask, command: Command, layout: str = "", *values: float) -> codec.Reply:
    """Return the reply to a command; see `codec.encode`."""
    return await ask(codec.encode(command, layout, *values), lambda: codec.ReplyDecoder(command))


async def require(ask: Ask, where: str, command: Command, layout: str = "", *values: float) -> codec.Reply:
    """Return the reply to a command that has to be carried out.

    Raises:
        RefusedError: it is not.
    """
    reply = await reply_to(ask, command, layout, *values)
    if reply.status != OK:
        raise refused(where, command, reply.status)
    return reply


def refused(where: str, command: Command, status: int) -> RefusedError:
    """Return the error of a refused command."""
    return RefusedError(f"{where}: {command.name} was refused: {status_text(status)}", status)


async def set_up(ask: Ask, where: str, settings: LeicaSettings, reflector: int | None) -> int:
    """Bring the server into the state that the driver reckons with, and check that it is there.

    Args:
        reflector: number of the one in use before the link was lost; None where that is not known.

    Returns:
        Number of the reflector in use.

    Raises:
        RefusedError: the server refuses, does otherwise, or does not know the reflector.
    """
    await _system_settings(ask, where)
    await require(ask, where, Command.SET_UNITS, "5i", *UNITS)
    await require(ask, where, Command.SET_COORDINATES, "i", RIGHT_HANDED)
    await require(ask, where, Command.SET_MODE, "i", STATIONARY)
    await _choose_statistic(ask, where, EXTENDED if settings.covariances else STANDARD)
    timeout_ms = round(1e3 * settings.search_timeout_s)
    await require(ask, where, Command.SET_SEARCH, "di", settings.search_radius_mm, timeout_ms)
    if settings.air is not None:
        await require(ask, where, Command.SET_ENVIRONMENT, "3d", *settings.air)
    if settings.reflector is not None:
        await _choose_reflector(ask, where, settings.reflector)
    if reflector is None:
        reflector = int((await require(ask, where, Command.REFLECTOR)).values("i")[0])
    await check(ask, where, reflector)
    return reflector


async def check(ask: Ask, where: str, reflector: int) -> None:
    """Check that coordinates come in the units, in the frame and of the reflector that the driver reckons with.

    Raises:
        RefusedError: somebody has changed them.
    """
    questions = (
        (Command.UNITS, "5i", UNITS, "set of units"),
        (Command.COORDINATES, "i", (RIGHT_HANDED,), "kind of coordinates"),
        (Command.MODE, "i", (STATIONARY,), "mode of measuring"),
        (Command.REFLECTOR, "i", (reflector,), "number of the reflector"),
    )
    for command, layout, expected, what in questions:
        found = (await require(ask, where, command)).values(layout)
        if found != expected:
            raise _changed(where, f"{what}: {found} instead of {expected}")
    applied = (await require(ask, where, Command.SETTINGS)).values("9i")
    if any(applied[place] for place in _FRAME):
        raise _changed(where, "frame: its transformation or its orientation is applied")


def _changed(where: str, what: str) -> RefusedError:
    return RefusedError(
        f"{where}: the tracker has another {what}: another program uses it; end that, and connect again", 0
    )


async def _system_settings(ask: Ask, where: str) -> None:
    """Have nothing sent unasked, and coordinates in the instrument's own frame; the rest is left alone."""
    found = (await require(ask, where, Command.SETTINGS)).values("9i")
    wanted = tuple(0 if place in _OFF else value for place, value in enumerate(found))
    if wanted != found:
        await require(ask, where, Command.SET_SETTINGS, "9i", *wanted)


async def _choose_statistic(ask: Ask, where: str, statistic: int) -> None:
    """Have results state covariances or not; those of an older server, which cannot, go without."""
    reply = await reply_to(ask, Command.SET_STATISTIC, "2i", statistic, statistic)
    if reply.status not in (OK, NOT_IMPLEMENTED):
        raise refused(where, Command.SET_STATISTIC, reply.status)


async def reflectors(ask: Ask, where: str) -> dict[str, tuple[int, float]]:
    """Return the reflectors that the tracker knows: number and surface offset, mm, by name.

    Raises:
        RefusedError: the server does not list them.
    """
    replies = await ask(codec.encode(Command.REFLECTORS), lambda: codec.RepliesDecoder(Command.REFLECTORS))
    found = {}
    for reply in replies:
        if reply.status != OK:
            raise refused(where, Command.REFLECTORS, reply.status)
        _, number, _, offset_mm = reply.values("iiid")
        found[codec.name_of(reply.data[20:84])] = (int(number), offset_mm)
    return found


async def _choose_reflector(ask: Ask, where: str, name: str) -> None:
    known = await reflectors(ask, where)
    if name not in known:
        listed = ", ".join(map(repr, known)) or "none"
        raise RefusedError(
            f"{where}: the tracker knows no reflector {name!r}, but {listed}: correct `reflector` in the cell file",
            0,
        )
    await require(ask, where, Command.SET_REFLECTOR, "i", known[name][0])
