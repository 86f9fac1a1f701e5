"""An emulated bench without errors, as a process: what a way of following misses is its own doing alone.

Run as `python -m tests.benchmarks.quiet_bench CELL`; prints what `catseye emulate` prints.
"""

import asyncio
import json
import sys
from dataclasses import replace
from pathlib import Path

from catseye.app.cell.load import load_cell
from catseye.app.service.scara.emulation import emulation_config
from catseye.simulators.config import ErrorBudget, TruthText
from catseye.simulators.emulated_bench import EmulatedBench


async def serve(cell: Path) -> None:
    """Serve until stdin ends."""
    config = emulation_config(load_cell(cell).cell, 1.0, 0, None)
    quiet = replace(
        config,
        budget=ErrorBudget.none(),
        beam_offset_mm=0.0,
        beam_pitch_mrad=0.0,
        truth=TruthText(cell.with_name("truth.json").read_bytes(), "truth.json"),
        scara=replace(config.scara, j4_backlash_mdeg=0.0),
    )
    async with EmulatedBench(quiet) as bench:
        for served in bench.endpoints:
            print(json.dumps({"device": served.device, "endpoint": served.endpoint}), flush=True)  # noqa: T201  # data for the parent
        await asyncio.to_thread(sys.stdin.read)


if __name__ == "__main__":
    asyncio.run(serve(Path(sys.argv[1])))
