"""A result in rows and sentences, as the screen shows it; no widget in here."""

from collections.abc import Sequence
from pathlib import Path

from catseye.app.protocol.banners import SIMULATION
from catseye.app.render.cells import cell_text
from catseye.app.render.text import table_text
from catseye.app.results.model import Block, Sign, Statement
from catseye.app.results.numbers import fixed, number
from catseye.app.results.origin import origin_now
from catseye.app.results.residual_sign import measured_minus_predicted
from catseye.app.results.result_files import ResultFile
from catseye.app.results.scara.budget_text import budget_statements
from catseye.app.results.scara.comparison import ResultComparison
from catseye.app.results.scara.comparison_report import comparison_report
from catseye.app.results.scara.diagnosis_document import DiagnosisDocument
from catseye.app.results.scara.drift_text import drift_statements
from catseye.app.results.scara.fit_text import (
    distances_text,
    fit_statements,
    identified_text,
    left_out_statements,
    nodes_only_statements,
)
from catseye.app.results.scara.names import MODEL_TITLES
from catseye.app.results.scara.result import Result
from catseye.app.results.scara.result_report import scatter_table
from catseye.app.results.scara.separated_text import separated_statements
from catseye.app.results.scara.uncertainty import uncertainty_statements
from catseye.app.results.scara.validation_document import ValidationDocument
from catseye.app.results.scara.values import parameter_table
from catseye.app.service.command_process import command_line


def file_row(file: ResultFile[Result]) -> list[str]:
    """Return what the row of a file says: name, model, distances, rms, simulated, time."""
    when = f"{file.changed_utc:%m-%d %H:%M}"
    result = file.result
    if result is None:
        return [file.path.name, "! no result", "", "", "", when]
    simulated = {True: "SIM", False: "", None: "?"}[result.provenance.simulated]
    count = result.fit.n_points
    rms = f"{result.fit.rms_um:>8.1f}"
    return [file.path.name, result.model, f"{count:>10}", rms, f" {simulated}", when]


def heading(file: ResultFile[Result]) -> str:
    """Return which result is shown."""
    result = file.result
    if result is None:
        return f"{file.path.name}: cannot be read"
    simulated = {True: SIMULATION, False: "", None: "simulated or not: not known"}[
        result.provenance.simulated
    ]
    parts = [
        file.path.name,
        MODEL_TITLES[result.model],
        distances_text(result.fit.n_points, result.fit.n_returns),
        f"rms {result.fit.rms_um:.1f} µm",
        simulated,
    ]
    return " · ".join(part for part in parts if part)


def value_rows(result: Result) -> list[list[str]]:
    """Return every parameter: quantity, value, U (k = 2), unit."""
    table = parameter_table(result)
    rows = []
    for row in table.rows:
        name, unit, _, *figures = map(cell_text, row, table.columns)
        rows.append([name, *figures, unit])
    return rows


def layout_text(result: Result) -> str:
    """Return links, places of reflectors and dead paths with their uncertainties."""
    return f"{table_text(parameter_table(result, ('arm', 'reflector', 'dead path')))}\n\n{result.gauge}"


def fit_sentences(result: Result, diagnosis: DiagnosisDocument | None) -> list[Statement]:
    """Return what was identified, how it fits, and what a diagnosis found."""
    statements = [Statement(Sign.NEUTRAL, identified_text(result)), *fit_statements(result)]
    if result.budget is not None:
        statements += budget_statements(result.budget)
    if result.uncertainty is not None:
        statements += uncertainty_statements(result.uncertainty)
    if diagnosis is None:
        text = "d: diagnosis, what speaks for and against the fit (takes seconds to minutes)"
        statements.append(Statement(Sign.NEUTRAL, text))
    else:
        statements += [finding.statement for finding in diagnosis.findings]
    # After many losses of the beam these are more lines than a small screen has.
    return [
        *statements,
        *drift_statements(result),
        *separated_statements(result),
        *nodes_only_statements(result),
        *left_out_statements(result),
    ]


def residual_text(result: Result, diagnosis: DiagnosisDocument | None) -> str:
    """Return the outliers in a numbered list; before a diagnosis the scatter of each reflector."""
    if result.residuals is None:
        return "the result file holds no residuals"
    left_out = [f"left out: {text}" for text in result.fit.rejected]
    if diagnosis is None:
        return "\n".join([*_scatter(result), "d: diagnosis, marks the outliers", *left_out])
    outliers = diagnosis.outliers.distances
    limit = f"limit {diagnosis.outliers.limit:.1f}"
    if not outliers:
        none = f"✓ no outlier: no studentised residual beyond the {limit}"
        return "\n".join([none, *_scatter(result), *left_out])
    lines = [f"{len(outliers)} outliers: residual (measured − predicted), studentised residual ({limit})"]
    lines += [
        f"{place:>2}  {_turned(one.residual_um, 8)} µm {_turned(one.external, 6)}  {one.what}"
        for place, one in enumerate(outliers, 1)
    ]
    return "\n".join([*lines, *left_out])


def _turned(residual: float | None, width: int) -> str:
    value = None if residual is None else measured_minus_predicted(residual)
    return number(value, fixed(1, signed=True), "-").rjust(width)


def _scatter(result: Result) -> list[str]:
    table = scatter_table(result)
    return [] if table is None else table_text(table).splitlines()


def path_text(found: ValidationDocument) -> str:
    """Return a validation in a few lines."""
    lines = [f"{found.compared} of {found.rows} rows compared"]
    for model in found.models:
        leaves = f"leaves {model.rms_um:>6.1f} µm rms (2-D), largest {model.max_um:.1f} µm"
        lines.append(f"{model.title:<20} {leaves}, expected {model.expected_um:.1f} µm")
    if found.ratio is not None:
        lines.append(f"ratio {found.ratio:.3f}")
    return "\n".join([*lines, *found.verdict, *(f"left out: {text}" for text in found.left_out)])


def comparison_blocks(found: ResultComparison) -> list[Block]:
    """Return the verdict of two results, links and reflectors, and the remarks."""
    report = comparison_report(found, ("", ""), origin_now())
    verdict, *others = report.statements()
    return [verdict, report.table("differences"), *others]


def lines_to_type(file: Path, cell: Path | None) -> str:
    """Return the commands that go on from a result, with the paths that the user has to give."""
    limits = ("--cell", str(cell)) if cell is not None else ()
    each: Sequence[tuple[str, tuple[str, ...]]] = (
        (
            "where the arm really goes on a path",
            ("predict", str(file), "--path", "PATH.csv", "-o", "predicted.csv"),
        ),
        (
            "commands that bring it where it should go",
            ("compensate", str(file), "--path", "PATH.csv", *limits, "-o", "compensated.csv"),
        ),
        (
            "the same as a MELFA-BASIC program",
            ("compensate", str(file), "--path", "PATH.csv", *limits, "--format", "melfa", "-o", "path.prg"),
        ),
        (
            "a bidirectional table",
            ("compensate", str(file), "--format", "kw-ssfk", "-o", "table.ssfk"),
        ),
        ("against an independent measurement", ("validate", str(file), "--measured", "MEASURED.csv")),
    )
    return "\n\n".join(f"{what}\n  {command_line(words)}" for what, words in each)
