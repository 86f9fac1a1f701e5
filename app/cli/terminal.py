"""terminal: the raw traffic of one device, in hex and text."""

import asyncio
import difflib
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from catseye.app.cli.options import CellOption
from catseye.app.cli.output import note
from catseye.app.errors import SafetyError, UsageError
from catseye.app.protocol.raw_text import LineEnd, encoded
from catseye.drivers.roles.clock import SystemClock

if TYPE_CHECKING:
    from catseye.app.cell.model import Cell


def terminal(
    device: Annotated[
        str, typer.Argument(help="robot, interferometer, environment, tracker, or the name of a [[device]]")
    ],
    cell: CellOption,
    eol: Annotated[
        LineEnd | None,
        typer.Option(help="line end to add to each line sent [crlf; with --hex: none]"),
    ] = None,
    as_hex: Annotated[
        bool, typer.Option("--hex", help="the input is bytes in hex, such as 31 3b 0d")
    ] = False,
    log: Annotated[Path | None, typer.Option(help="append the same lines to this file")] = None,
    wait: Annotated[
        float, typer.Option(min=0.0, help="once the input has ended, end after this time without traffic, s")
    ] = 1.0,
    arm: Annotated[
        str | None, typer.Option(metavar="CELL", help="name of the cell: allows sending to the robot")
    ] = None,
) -> None:
    r"""Show the raw traffic of a device and send to it. Traffic is shown in hex and as text.

    Escapes in the input: \r \n \t \e \xNN. Unsolicited output is shown as it arrives. Ctrl-C ends.

    Example: catseye terminal interferometer --cell cell.toml --eol crlf --log counter.log
    """
    from catseye.app.cell.load import load_cell
    from catseye.app.cli.raw_conversation import Traffic, converse, guarded
    from catseye.app.engine.instruments import device_builder, unrecorded
    from catseye.app.guard.raw import plain_connection

    known = load_cell(cell).cell
    endpoint = endpoint_of(known, device)
    may_send = _may_send(known, device, arm)
    encode = partial(encoded, end=eol or ("none" if as_hex else "crlf"), as_hex=as_hex)
    with Traffic(log) as traffic:
        note(f"{device} at {endpoint}; a line of input is sent, Ctrl-C ends")
        if arm is not None:
            note(
                "what you start by hand goes on when the terminal ends: stop it yourself; this is not an emergency "
                "stop"
            )
        if not may_send:
            note(f"listening only: what is sent may move the robot; --arm {known.name} lets it pass")
        io, stop = None, None
        if may_send and _moves(known, device):
            stop = _stop(known, device)
            link = partial(guarded, endpoint, stop, traffic)
            io = device_builder(known, SystemClock())(unrecorded).io
        else:
            link = partial(plain_connection, endpoint, traffic.show)
        asyncio.run(converse(link, traffic, encode if may_send else _refusal(known), wait, io, stop))


def endpoint_of(cell: "Cell", device: str) -> str:
    """Return where a device of the cell is.

    Raises:
        UsageError: the cell has no such device; the text names the nearest one.
    """
    places: dict[str, str] = {role: section.endpoint for role, section in cell.instruments.items()}
    places |= {further.name: further.endpoint for further in cell.device}
    if device in places:
        return places[device]
    near = difflib.get_close_matches(device, places, n=1, cutoff=0.5)
    meant = f"did you mean {near[0]}? " if near else ""
    raise UsageError(f"the cell has no device {device!r}: {meant}there are {', '.join(places)}")


def _may_send(cell: "Cell", device: str, arm: str | None) -> bool:
    if arm not in {None, cell.name}:
        raise SafetyError(
            f"--arm names {arm!r} and the cell is {cell.name!r}: nothing was sent; check which robot it is"
        )
    return arm is not None or not _moves(cell, device)


def _moves(cell: "Cell", device: str) -> bool:
    from catseye.app.cell.axes import may_move_an_arm

    return may_move_an_arm(device, _driver(cell, device))


def _driver(cell: "Cell", device: str) -> str:
    """Return the driver of a device that may be a robot, empty for those that are none."""
    drivers = {"robot": cell.robot.driver, **{further.name: further.driver for further in cell.device}}
    return drivers.get(device, "")


def _stop(cell: "Cell", device: str) -> bytes | None:
    """Return the bytes that stop the arm behind a device; None where nobody knows any."""
    from catseye.app.engine.instruments import stop_request

    settings = {"robot": cell.robot.settings, **{further.name: further.settings for further in cell.device}}
    return stop_request(_driver(cell, device), device, settings[device])


def _refusal(cell: "Cell") -> Callable[[str], bytes]:
    def refuse(_line: str) -> bytes:
        raise ValueError(f"the robot may move: start the terminal with --arm {cell.name} to send to it")

    return refuse
