"""An emulated bench whose distances have no errors of their own: a miscount of a single fringe shows.

Run as `python -m tests.system.still_bench emulate CELL --speed S --truth FILE`; prints what `catseye emulate` prints.
"""

import argparse
import asyncio
import json
from dataclasses import replace
from pathlib import Path

from app.cell.load import load_cell
from app.emulation import emulation_config
from simulators.config import ErrorBudget
from simulators.launch import EmulatedBench


async def serve(cell: Path, speed: float, truth: Path) -> None:
    """Serve until this process is ended."""
    config = emulation_config(load_cell(cell).cell, speed, 0, truth)
    still = replace(config, budget=ErrorBudget.none(), beam_offset_mm=0.0, beam_pitch_mrad=0.0)
    async with EmulatedBench(still) as bench:
        for served in bench.endpoints:
            print(json.dumps({"device": served.device, "endpoint": served.endpoint}), flush=True)  # noqa: T201  # data for the parent
        await asyncio.Event().wait()


def main() -> None:
    """Read the command line of `catseye emulate`."""
    parser = argparse.ArgumentParser()
    parser.add_argument("command", choices=["emulate"])
    parser.add_argument("cell", type=Path)
    parser.add_argument("--speed", type=float, action="append")
    parser.add_argument("--truth", type=Path)
    given = parser.parse_args()
    asyncio.run(serve(given.cell, given.speed[-1], given.truth))


if __name__ == "__main__":
    main()
