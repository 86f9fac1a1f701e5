"""An emulated bench that differs from what a cell file says, as a process.

Whoever calls `main` is run as `python -m MODULE emulate CELL --speed S`; it prints what `catseye emulate` prints.
"""

import argparse
import asyncio
import contextlib
import json
from collections.abc import Callable
from pathlib import Path

from catseye.app.cell.load import load_cell
from catseye.app.service.scara.emulation import emulation_config
from catseye.simulators.config import EmulationConfig
from catseye.simulators.emulated_bench import EmulatedBench


def main(altered: Callable[[EmulationConfig], EmulationConfig]) -> None:
    """Read the command line of `catseye emulate` and serve until the process is ended."""
    parser = argparse.ArgumentParser()
    parser.add_argument("command", choices=["emulate"])
    parser.add_argument("cell", type=Path)
    parser.add_argument("--speed", type=float)
    parser.add_argument("--truth", type=Path)
    given = parser.parse_args()
    config = emulation_config(load_cell(given.cell).cell, given.speed, 0, given.truth)
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(_serve(altered(config)))


async def _serve(config: EmulationConfig) -> None:
    async with EmulatedBench(config) as bench:
        for served in bench.endpoints:
            print(json.dumps({"device": served.device, "endpoint": served.endpoint}), flush=True)  # noqa: T201  # data for the parent
        await asyncio.Event().wait()
