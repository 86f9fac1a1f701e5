"""emulate: every device of a cell file on its endpoint."""

import asyncio
import os
import signal
import sys
from dataclasses import replace
from pathlib import Path

from catseye.app.cell.load import load_cell
from catseye.app.cli.output import emit_json, say
from catseye.app.emulation import emulation_config
from catseye.app.errors import ConfigError
from catseye.simulators.config import EmulationConfig
from catseye.simulators.launch import EmulatedBench

SUFFIXES = {"none": "", "cr": "\r", "crlf": "\r\n"}
"""What the emulated controller may end its answers with on TCP."""

SCREW_SENSES = ("normal", "reversed")
"""How the mount's screws act: as the cell file says, or the other way round."""


def emulate_command(
    file: Path,
    speed: float,
    seed: int,
    truth: Path | None,
    *,
    axes: int,
    suffix: str,
    unaligned: bool,
    screw_sense: str,
    end_with_stdin: bool,
) -> None:
    """Serve until SIGINT or SIGTERM, or until stdin closes.

    Raises:
        ConfigError: there is no such suffix or sense, or an endpoint cannot be emulated.
    """
    if suffix not in SUFFIXES:
        raise ConfigError(f"--suffix {suffix}: answers end with {', '.join(SUFFIXES)}")
    if screw_sense not in SCREW_SENSES:
        raise ConfigError(f"--screw-sense {screw_sense}: screws turn {' or '.join(SCREW_SENSES)}")
    config = emulation_config(load_cell(file).cell, speed, seed, truth)
    screws = config.screws.reversed() if screw_sense == "reversed" else config.screws
    config = replace(
        config, axis_pattern=axes, answer_suffix=SUFFIXES[suffix], unaligned=unaligned, screws=screws
    )
    asyncio.run(_serve(config, f"{file} at {speed:g} times real speed, seed {seed}", end_with_stdin))


async def _serve(config: EmulationConfig, what: str, end_with_stdin: bool) -> None:
    ended = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        loop.add_signal_handler(number, ended.set)
    if end_with_stdin:
        loop.add_reader(sys.stdin.fileno(), _end_at_the_end, sys.stdin.fileno(), ended)
    async with EmulatedBench(config) as bench:
        for served in bench.endpoints:
            emit_json({"device": served.device, "protocol": served.protocol, "endpoint": served.endpoint})
        say(f"emulating {what}; Ctrl-C ends it")
        await ended.wait()


def _end_at_the_end(descriptor: int, ended: asyncio.Event) -> None:
    if not os.read(descriptor, 4096):
        ended.set()
