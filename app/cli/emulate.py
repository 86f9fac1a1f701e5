"""emulate: every device of a cell file on its endpoint."""

import asyncio
import signal
import sys
from contextlib import nullcontext
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Final

import typer

from catseye.app.cli.options import CellFile, Seed, Speed, Truth
from catseye.app.cli.output import note, warn, write_document
from catseye.app.errors import ConfigError

if TYPE_CHECKING:
    from catseye.simulators.config import EmulationConfig

_SUFFIXES: Final = {"none": "", "cr": "\r", "crlf": "\r\n"}
"""What the emulated controller may end its answers with on TCP."""

_SCREW_SENSES: Final = ("normal", "reversed")
"""How the mount's screws act: as the cell file says, or the other way round."""


def emulate(
    file: CellFile,
    speed: Speed = 1.0,
    seed: Seed = 2,
    truth: Truth = None,
    axes: Annotated[
        int,
        typer.Option(
            help="number of axes in the controller's answers: 4, or 6 or 8 for clients that need them"
        ),
    ] = 4,
    suffix: Annotated[
        str, typer.Option(help="line end of the controller's answers on TCP: none, cr, crlf")
    ] = "none",
    unaligned: Annotated[
        bool, typer.Option("--unaligned", help="start with a beam that is tilted and off its axis")
    ] = False,
    screw_sense: Annotated[
        str,
        typer.Option(
            help="screws act in the direction of the cell file (normal) or in the opposite one (reversed)"
        ),
    ] = "normal",
    growth_ppm: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            max=1000.0,
            help="links grow by this after hours of motion at full speed, less at less duty and speed",
        ),
    ] = None,
    end_with_stdin: Annotated[
        bool, typer.Option(help="end when stdin closes, for programs that start the emulators")
    ] = False,
) -> None:
    """Emulate the devices of a cell file until Ctrl-C.

    One JSON line per endpoint is printed when it is ready; port 0 picks a free port.

    Example: catseye emulate cell.toml --speed 50
    """
    from catseye.app.cell.load import load_cell
    from catseye.app.service.emulated_arm import emulation_config

    if suffix not in _SUFFIXES:
        raise ConfigError(f"--suffix {suffix}: answers end with {', '.join(_SUFFIXES)}")
    if screw_sense not in _SCREW_SENSES:
        raise ConfigError(f"--screw-sense {screw_sense}: screws turn {' or '.join(_SCREW_SENSES)}")
    config = emulation_config(load_cell(file).cell, speed, seed, truth)
    screws = config.screws.reversed() if screw_sense == "reversed" else config.screws
    config = replace(
        config, axis_pattern=axes, answer_suffix=_SUFFIXES[suffix], unaligned=unaligned, screws=screws
    )
    if growth_ppm is not None:
        config = config.growing(growth_ppm)
    asyncio.run(_serve(config, f"{file} at {speed:g} times real speed, seed {seed}", end_with_stdin))


async def _serve(config: "EmulationConfig", what: str, end_with_stdin: bool) -> None:
    from catseye.app.cli.documents import Endpoint
    from catseye.app.service.lines import Lines
    from catseye.simulators.emulated_bench import served_bench

    ended = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        loop.add_signal_handler(number, ended.set)
    typed = Lines(sys.stdin.fileno(), lambda _line: None, ended.set)
    async with served_bench(config) as bench:
        for served in bench.endpoints:
            write_document("endpoint", Endpoint.model_validate(served).json_object())
        if bench.open_to_the_network:
            warn(
                f"{', '.join(bench.open_to_the_network)}: every computer on the network can lead these emulators; "
                "listen on 127.0.0.1 unless that is meant"
            )
        note(f"emulating {what}; Ctrl-C ends it")
        bench.keeper.on_behind = _Behind()
        with typed.read() if end_with_stdin else nullcontext():
            await ended.wait()


class _Behind:
    """Says when the bench falls behind its speed, and again when that has doubled."""

    def __init__(self) -> None:
        self._said_s = 0.0

    def __call__(self, behind_s: float) -> None:
        if behind_s >= 2.0 * self._said_s:
            self._said_s = behind_s
            note(
                f"this computer is too slow for the bench: bench time is {behind_s:.3g} s behind by now, and nothing "
                "is left out; lower --speed"
            )
