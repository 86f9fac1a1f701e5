"""demo: the whole job, narrated as it goes and summed up at the end."""

import asyncio
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from catseye.app.cli.failure import write_failure_texts
from catseye.app.cli.options import AsJson, Seed, Speed, Truth
from catseye.app.cli.output import note, write_json, write_line
from catseye.app.render.text import statement_lines, tables_text

if TYPE_CHECKING:
    from catseye.app.engine.announcer import Publish


def demo(
    out: Annotated[Path, typer.Option(help="folder for everything that the demo writes")] = Path(
        "catseye-demo"
    ),
    speed: Speed = 400.0,
    seed: Seed = 2,
    truth: Truth = None,
    as_json: AsJson = False,
) -> None:
    """Do the whole job on emulated hardware over real sockets: search, measure, identify, validate, report.

    Example: catseye demo --out /tmp/demo --seed 7
    """
    from catseye.app.cli.scara.demo_job import (
        DemoInterruptedError,
        evaluate,
        measure,
        prepare_folder,
        run_for,
    )
    from catseye.app.cli.scara.demo_report import job_document, write_demo_report
    from catseye.app.results.scara.job_summary import job_summary

    prepare_folder(out, seed, truth)
    note(f"emulators at {speed:g} times real speed, seed {seed}; everything is written to {out}")
    try:
        runs = asyncio.run(measure(out, speed, seed, truth, _narrator))
    except DemoInterruptedError as ended:
        write_failure_texts([str(ended)], ended.outcome.exit_code)
        sys.exit(int(ended.outcome.exit_code))
    note("identifying both models and comparing them with truth and validation path")
    result = evaluate(out, runs)
    note("drawing the report")
    report = write_demo_report(result)
    if as_json:
        write_json(job_document(result, report).json_object())
    else:
        summary = job_summary(result.truth, result.results["error-map"].fit, result.validation)
        write_line(tables_text(summary))
        write_line("")
        for line in statement_lines(summary):
            write_line(line)
        write_line(f"report           {report}")
        write_line(f"run              {run_for('identify', result.runs)}")


def _narrator(name: str) -> "Publish":
    from catseye.app.cli.narrator import Narrator

    return Narrator(name, as_json=False).publish
