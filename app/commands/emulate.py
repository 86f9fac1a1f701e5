"""emulate: every device of a cell file on its endpoint."""

import asyncio
import os
import signal
import sys
from pathlib import Path

from app.cell.load import load_cell
from app.commands.output import emit_json, say
from app.emulation import emulation_config
from simulators.launch import EmulatedBench


def emulate_command(file: Path, speed: float, seed: int, truth: Path | None, end_with_stdin: bool) -> None:
    """Serve until SIGINT or SIGTERM, or until stdin closes."""
    asyncio.run(_serve(file, speed, seed, truth, end_with_stdin))


async def _serve(file: Path, speed: float, seed: int, truth: Path | None, end_with_stdin: bool) -> None:
    config = emulation_config(load_cell(file).cell, speed, seed, truth)
    ended = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        loop.add_signal_handler(number, ended.set)
    if end_with_stdin:
        loop.add_reader(sys.stdin.fileno(), _end_at_the_end, sys.stdin.fileno(), ended)
    async with EmulatedBench(config) as bench:
        for served in bench.endpoints:
            emit_json({"device": served.device, "protocol": served.protocol, "endpoint": served.endpoint})
        say(f"emulating {file} at {speed:g} times real speed, seed {seed}; Ctrl-C ends it")
        await ended.wait()


def _end_at_the_end(descriptor: int, ended: asyncio.Event) -> None:
    if not os.read(descriptor, 4096):
        ended.set()
