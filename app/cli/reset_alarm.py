"""reset-alarm: shows a controller's alarm, and resets the one that was read."""

import asyncio
import sys
from typing import TYPE_CHECKING, Annotated

import typer

from catseye.app.cli.options import AsJson, CellFile
from catseye.app.cli.output import note, write_document, write_line
from catseye.app.errors import LinkFailedError, SafetyError, UsageError
from catseye.app.service.lines import Lines
from catseye.drivers.roles.errors import DeviceError

if TYPE_CHECKING:
    from catseye.app.cell.model import Cell
    from catseye.app.service.alarm import Alarm


def reset_alarm(
    file: CellFile,
    alarm: Annotated[
        int | None, typer.Option(metavar="NUMBER", help="number of the alarm to reset; needed in scripts")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Show the controller's alarm and reset it. Nothing moves.

    At a terminal you type the number of the alarm, which is part of its text; in a script give it by --alarm. An
    alarm with another number is not reset. Example: catseye reset-alarm cell.toml
    """
    from catseye.app.cell.load import load_cell
    from catseye.app.cli.documents import AlarmFound

    try:
        found, was_reset = asyncio.run(_reset(load_cell(file).cell, alarm, as_json=as_json))
    except DeviceError as error:
        raise LinkFailedError(str(error)) from error
    if as_json:
        answer = AlarmFound(alarm=found.number, text=found.text, reset=was_reset)
        write_document("alarm", answer.json_object())
    elif was_reset:
        write_line(f"alarm {found.number} is reset; the drives stay as they are")


async def _reset(cell: "Cell", given: int | None, *, as_json: bool) -> "tuple[Alarm, bool]":
    from catseye.app.service.alarm import seen_controller

    async with seen_controller(cell) as seen:
        alarm = seen.alarm
        if not alarm.number:
            note("the controller is in no alarm", heard=True)
            return alarm, False
        note(f"alarm {alarm.number}: {alarm.text}", heard=True)
        if not alarm.resets:
            raise SafetyError(f"no program resets this: {alarm.text}")
        if given is None and sys.stdin.isatty() and not as_json:
            given = await _typed_number()
        _require_read(alarm.number, given)
        await seen.reset()
    return alarm, True


async def _typed_number() -> int:
    """Return the number that somebody types; 0 where it is none. Ctrl-C ends the question at once.

    Raises:
        SafetyError: nothing was typed.
    """
    note("remove its cause first. Type its number to reset it, or only Enter to leave it: ", heard=True)
    typed: asyncio.Future[str] = asyncio.get_running_loop().create_future()

    def take(line: str = "") -> None:
        if not typed.done():
            typed.set_result(line.strip())

    with Lines(sys.stdin.fileno(), take, take).read():
        line = await typed
    if not line:
        raise SafetyError("the alarm stays")
    return int(line) if line.isdecimal() else 0


def _require_read(number: int, given: int | None) -> None:
    """Check that somebody has read which alarm it is.

    Raises:
        UsageError: nobody says so.
        SafetyError: it is another one than that which was read.
    """
    if given is None:
        raise UsageError(f"nobody has read it here: give --alarm {number} once its cause is removed")
    if given != number:
        raise SafetyError(
            f"the controller is in alarm {number}, not {given}: nothing was reset; read this one first"
        )
