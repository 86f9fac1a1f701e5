"""The resolution paper's whole campaign on the emulated bench, over real sockets: six joints at K1 … K5, both ways.

Run as `python -m tests.resolution_campaign`, or `make campaign-resolution-full`. Each joint is a run of its own,
below the folder of the campaign. Called again, a run that was interrupted goes on with the series that was under way,
and those that are complete are left as they are. All complete runs are evaluated at the end.
"""

import argparse
import asyncio
import re
import sys
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Final

from catseye.app.cell.load import LoadedCell
from catseye.app.cli.demonstration import DemoInterruptedError, Demonstration, emulated_bench, interruptible
from catseye.app.cli.narrator import Narrator
from catseye.app.cli.report_output import write_tables
from catseye.app.cli.resolution.demo_cell import CELL, emulator_cell
from catseye.app.engine.announcer import Publish
from catseye.app.engine.questions import REFLECTORS
from catseye.app.engine.signals import SignalInstaller
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.procedures import load_procedure
from catseye.app.render.page import write_page
from catseye.app.results.resolution.recorded_runs import result_of_runs
from catseye.app.results.resolution.result import write_resolution
from catseye.app.results.resolution.result_report import resolution_files_report
from catseye.app.service.resumption import plan_resume
from catseye.app.service.running import PlannedRun, carry_out, plan_run
from catseye.app.store.catalog import paths_of
from catseye.app.store.reader import RunReader
from catseye.calibration.resolution.decaying import THRESHOLD_PERCENT
from catseye.procedures.resolution.resolution import Resolution, ResolutionParams
from tests.shipped_recordings import JOINTS, POSITIONS, SEED, chosen

_NAME: Final = Resolution.name
_LIMITS: Final = re.compile(r"\[robot\.limits_deg\]\n(?:\w+ = .*\n)+\n")
"""The demonstration's own are narrower than the positions of the paper need."""


def arguments(given: Sequence[str]) -> argparse.Namespace:
    """Return what is asked for; all of it when nothing is said."""
    parser = argparse.ArgumentParser(prog="python -m tests.resolution_campaign")
    parser.add_argument("--out", type=Path, default=Path("build/campaign-resolution"))
    parser.add_argument("--speed", type=float, default=30.0, help="bench seconds in one real second")
    parser.add_argument("--joints", nargs="+", choices=JOINTS, default=list(JOINTS))
    parser.add_argument("--positions", nargs="+", choices=POSITIONS, default=list(POSITIONS))
    return parser.parse_args(given)


def wide(cell: str) -> str:
    """Return the text of a cell whose limits are the arm's own."""
    return _LIMITS.sub("", cell)


def runs_of(folder: Path, joint: str) -> Path:
    """Return the folder of a joint's runs."""
    return folder / "runs" / joint


def complete_runs(folder: Path) -> list[Path]:
    """Return the runs of all joints that are complete."""
    runs = [path for joint in JOINTS for path in paths_of(runs_of(folder, joint), _NAME)]
    return [path for path in runs if RunReader(path).status == "complete"]


async def measure(given: Demonstration, asked: argparse.Namespace, signals: SignalInstaller) -> None:
    """Begin the run of each joint, or go on with it.

    Raises:
        DemoInterruptedError: a run did not complete: called again, the campaign goes on with it.
    """
    # The emulated bench begins anew with each call: the optics do not stand any more.
    answers = given.folder / "answers.toml"
    answers.write_text(f'"{REFLECTORS.id}" = "moved"\n', encoding="utf-8")
    async with emulated_bench(given, wide(CELL), wide(emulator_cell(given.speed))) as loaded:
        for joint in asked.joints:
            root = runs_of(given.folder, joint)
            root.mkdir(parents=True, exist_ok=True)
            planned = planned_run(loaded, root, joint, asked.positions)
            if planned is None:
                continue
            outcome = await carry_out(
                planned,
                root,
                given.publish(_NAME),
                speed=given.speed,
                answers=answers,
                install_signals=signals,
            )
            if outcome.exit_code != ExitCode.DONE:
                raise DemoInterruptedError(outcome)


def planned_run(loaded: LoadedCell, root: Path, joint: str, positions: Sequence[str]) -> PlannedRun | None:
    """Return the run of a joint, or the rest of it; None where it is complete."""
    runs = paths_of(root, _NAME)
    if not runs:
        params = ResolutionParams.model_validate(chosen(joint, positions))
        return plan_run(loaded, load_procedure(_NAME), params, root, "auto")
    if RunReader(runs[-1]).status == "complete":
        sys.stdout.write(f"{joint} is complete\n")
        return None
    return plan_resume(root, runs[-1].name, loaded)


def evaluate(folder: Path) -> None:
    """Evaluate all complete runs; write result and report, and print the tables."""
    result = result_of_runs([RunReader(run) for run in complete_runs(folder)], THRESHOLD_PERCENT)
    path, page = folder / "result.json", folder / "report.html"
    write_resolution(result, path)
    report = resolution_files_report([path])
    write_page(report, page)
    write_tables(report)
    sys.stdout.write(f"{len(result.tests)} series: {path}, {page}\n")


def narrated(name: str) -> Publish:
    """Return what shows the events of a run."""
    return Narrator(name, as_json=False).publish


def main(given: Sequence[str]) -> None:
    """Measure what is left to measure, then evaluate."""
    asked = arguments(given)
    asked.out.mkdir(parents=True, exist_ok=True)
    bench, begun_s = Demonstration(asked.out, asked.speed, SEED, None, narrated), time.monotonic()
    asyncio.run(interruptible(partial(measure, bench, asked)))
    sys.stdout.write(f"measured in {(time.monotonic() - begun_s) / 60.0:.1f} min\n")
    evaluate(asked.out)


if __name__ == "__main__":
    main(sys.argv[1:])
