"""What runs and results hand to other programs, as rows of one table."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from catseye.app.errors import UsageError
from catseye.app.files.tabular import Row, table_csv
from catseye.app.results.model import Origin
from catseye.app.results.runs.run_source import are_simulated, cell_of_run, origin_of_run
from catseye.app.results.scara.budget_part import TableBudget
from catseye.app.results.scara.measured_distances import measured_distances
from catseye.app.results.scara.path_rows import holds_distances
from catseye.app.results.scara.points import point_columns, points_csv, with_sigma
from catseye.app.results.scara.result import Result, read_result
from catseye.app.results.scara.stated_budget import corrected_by
from catseye.app.results.scara.table_budget import documents_of
from catseye.app.results.scara.values import result_values
from catseye.app.store.reader import RunReader
from catseye.procedures.kit.columns import Columns
from catseye.procedures.scara.records import Distance

_MEASURED = ("theta1_deg", "theta2_deg", "direction1", "direction2", "x_meas_mm", "y_meas_mm", "u_mm")


@dataclass(frozen=True)
class Export:
    """One table.

    Attributes:
        source: name of the run or of the result file.
        about: what stands beside the rows in JSON.
        content: what the rows are: points, path, search, records, values.
        rows: all of them with all their columns.
        csv: text of the CSV file: where this program reads such a CSV, in the form that it reads.
        origin: of the rows, with what a reader has to know before anything else.
        documents: that the table carries along, by kind; the CSV has them already.
    """

    source: str
    about: Mapping[str, object]
    content: str
    rows: Sequence[Row]
    csv: str
    origin: Origin
    documents: Mapping[str, object] = field(default_factory=dict)


def run_export(reader: RunReader) -> Export:
    """Return the rows that a run has measured.

    Raises:
        UsageError: it has measured nothing.
    """
    stored: Iterable[tuple[str, list[dict[str, Any]]]] = (
        (table.name, reader.rows(table.name)) for table in reader.tables()
    )
    content, rows = next(((name, found) for name, found in stored if found), ("", []))
    if not rows:
        raise UsageError(
            f"{reader.path.name} holds nothing to export: it is {reader.status} and has measured nothing; "
            f"catseye show {reader.path.name} shows what happened"
        )
    about = {"run": reader.path.name, "meta": reader.meta}
    if content == Distance.table:
        return _distances(reader, about, content, measured_distances(reader))
    if content == "path" and holds_distances(rows):
        return _distances(reader, about, content, rows)
    csv = _run_csv(content, rows, corrected=_is_corrected(reader))
    return Export(reader.path.name, about, content, rows, csv, origin_of_run(reader))


def _distances(
    reader: RunReader, about: Mapping[str, object], content: str, rows: list[dict[str, Any]]
) -> Export:
    """Return distances with their error budget; sigma_mm is what of it differs from distance to distance."""
    stated = cell_of_run(reader).uncertainty
    sigma_mm = 1e-3 * stated.white_um
    points = with_sigma(point_columns(rows), sigma_mm)
    documents = documents_of(
        points,
        TableBudget(
            format="catseye-budget/1",
            source=reader.path.name,
            corrected_by=corrected_by(reader),
            simulated=are_simulated([reader]),
            unverified=list(reader.unverified) or None,
            contributor=stated.contributor,
            sha256="",
        ),
    )
    return Export(
        reader.path.name,
        about,
        content,
        _with_columns(rows, points, ("sigma_mm", "mount_deg", "returned")),
        points_csv(points, documents),
        origin_of_run(reader),
        documents,
    )


def _with_columns(
    rows: Sequence[Mapping[str, object]], points: Columns, names: Sequence[str]
) -> Sequence[Row]:
    """Return rows with columns as the table has them; one that it does not have is left out."""
    columns = {name: points[name].tolist() for name in names if name in points}
    return [
        {key: value for key, value in row.items() if key not in names}
        | {name: values[i] for name, values in columns.items()}
        for i, row in enumerate(rows)
    ]


def _is_corrected(reader: RunReader) -> bool:
    """Return whether commands were driven that somebody had corrected: they do not lead the nominal arm there."""
    params = reader.meta.get("params")
    return isinstance(params, dict) and bool(params.get("joints"))


def _run_csv(content: str, rows: list[dict[str, Any]], *, corrected: bool) -> str:
    if content == "path":
        located = [row for row in rows if row["x_meas_mm"] is not None and row["y_meas_mm"] is not None]
        stated = all(row["u_mm"] is not None for row in located)
        names = _MEASURED if stated else _MEASURED[:-1]
        if all(row.get("line") is not None for row in located):
            names = ("line", *names)
        wished = {"x_wished_mm": "x_mm", "y_wished_mm": "y_mm"} if corrected else {}
        return table_csv(
            [
                {name: row[name] for name in names} | {name: row[of] for name, of in wished.items()}
                for row in located
            ]
        )
    return table_csv(rows)


def result_export(path: Path) -> Export:
    """Return a result's parameters, one value a row.

    Raises:
        UsageError: the file is missing or no result.
    """
    result = read_result(path)
    rows = result_rows(result)
    about = {
        "result": path.name,
        "model": result.model,
        "gauge": result.gauge,
        "fit": result.fit.model_dump(exclude_none=True),
        "provenance": result.provenance.model_dump(exclude={"unverified"}),
    }
    return Export(path.name, about, "values", rows, table_csv(rows), result.provenance.origin)


def result_rows(result: Result) -> list[Row]:
    """Return every parameter as a row: quantity, node_deg, direction, value, unit, u (k = 1)."""
    return [
        {
            "quantity": value.quantity,
            "node_deg": value.node_deg,
            "direction": value.direction,
            "value": value.value,
            "unit": value.unit,
            "u": value.u,
        }
        for value in result_values(result)
    ]
