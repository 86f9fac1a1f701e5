"""An emulated bench without measuring errors, as a process: what two runs on it differ by is the program's doing.

Run as `python -m tests.system.quiet_bench emulate CELL --speed X`; prints what `catseye emulate` prints.
"""

import argparse
import asyncio
import contextlib
import json
from dataclasses import replace
from pathlib import Path

from app.cell.load import load_cell
from app.emulation import emulation_config
from simulators.config import ErrorBudget
from simulators.launch import EmulatedBench


async def serve(cell: Path, speed: float) -> None:
    """Serve until the process is ended."""
    config = emulation_config(load_cell(cell).cell, speed, 0, None)
    quiet = replace(
        config,
        budget=ErrorBudget.none(),
        beam_offset_mm=0.0,
        beam_pitch_mrad=0.0,
        dynamics=replace(config.dynamics, j4_backlash_mdeg=0.0),
    )
    async with EmulatedBench(quiet) as bench:
        for served in bench.endpoints:
            print(json.dumps({"device": served.device, "endpoint": served.endpoint}), flush=True)  # noqa: T201  # data for the parent
        await asyncio.Event().wait()


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("command", choices=["emulate"])
    parser.add_argument("cell", type=Path)
    parser.add_argument("--speed", type=float)
    chosen = parser.parse_args()
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(serve(chosen.cell, chosen.speed))
