"""diagnose: what speaks for and against a fit."""

from typing import Final

from catseye.app.cli.options import AsJson, Budget, MeasuredRuns, PointsCell, PointsFile, Runs
from catseye.app.cli.output import note, warn, write_document, write_line
from catseye.app.cli.progress import ProgressBar
from catseye.app.cli.report_output import note_statement
from catseye.app.render.text import statement_lines, tables_text

LONG_TABLE: Final = 50_000
"""Tables of more distances take half a minute or more."""

_MEMORY_KB: Final = 6
"""That a distance takes: 1.2 GB were measured for 200 000."""


def diagnose(
    run: MeasuredRuns = None,
    points: PointsFile = None,
    cell: PointsCell = None,
    runs: Runs = None,
    as_json: AsJson = False,
    budget: Budget = None,
) -> None:
    """Check a fit. Outliers, drift, lack of fit, cross-validation, richer models, node spacing.

    Example: catseye diagnose 1a2b3c
    """
    from catseye.app.results.scara.budget_text import budget_statements
    from catseye.app.results.scara.diagnosis import diagnose_distances
    from catseye.app.results.scara.diagnosis_document import diagnosis_document
    from catseye.app.results.scara.diagnosis_report import diagnosis_report
    from catseye.app.results.scara.distances import load_distances

    source = load_distances(run or [], points, cell, runs, budget=budget)
    for text in source.warnings:
        warn(text)
    for statement in budget_statements(source.stated.part):
        note_statement(statement)
    count = len(source.points["displacement_mm"])
    if count > LONG_TABLE:
        note(
            f"diagnose takes all {count} distances at once: about {_MEMORY_KB * count / 1000:.0f} MB of memory, and "
            "as long as the line below says; every tenth row as a table of its own does where that is too much"
        )
    bar = ProgressBar("diagnose")
    try:
        diagnosis = diagnose_distances(source, lambda share, text: bar.update(share, 1.0, text))
        bar.update(1.0, 1.0, "done")
    finally:
        bar.close()
    if as_json:
        write_document("diagnosis", diagnosis_document(diagnosis, source.names).json_object())
        return
    report = diagnosis_report(diagnosis, source.stated.origin)
    write_line(tables_text(report))
    for text in diagnosis.identified.rejected:
        note(f"left out: {text}")
    write_line("")
    for line in statement_lines(report):
        write_line(line)
