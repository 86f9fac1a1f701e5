"""The demonstration of a SCARA that tracks reflectors."""

import asyncio

from catseye.app.cli.demonstration import Demonstration
from catseye.app.cli.output import note, write_document, write_line
from catseye.app.cli.scara.demo_job import evaluate, measure, prepare_folder, run_for
from catseye.app.cli.scara.demo_report import job_document, write_demo_report
from catseye.app.render.text import statement_lines, tables_text
from catseye.app.results.scara.job_summary import job_summary


def demonstrate_scara(given: Demonstration, *, as_json: bool) -> None:
    """Search, measure, identify, validate and report; sum it up.

    Raises:
        DemoInterruptedError: a run did not complete.
    """
    prepare_folder(given.folder, given.seed, given.truth)
    runs = asyncio.run(measure(given))
    note("identifying both models and comparing them with truth and validation path")
    result = evaluate(given.folder, runs)
    note("drawing the report")
    report = write_demo_report(result)
    if as_json:
        write_document("demo", job_document(result, report).json_object())
        return
    summary = job_summary(result.truth, result.results["error-map"].fit, result.validation)
    write_line(tables_text(summary))
    write_line("")
    for line in statement_lines(summary):
        write_line(line)
    write_line(f"report           {report}")
    write_line(f"run              {run_for('identify', result.runs)}")
