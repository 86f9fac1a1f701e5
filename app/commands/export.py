"""export: a run's points for other programs."""

import importlib
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from app.analysis.identifying import cell_of_run, run_rows
from app.commands.output import say
from app.errors import ConfigError, UsageError
from app.files.atomic import write_atomically
from app.files.points_csv import PointRow, points_csv
from app.runs_folder import runs_folder
from app.store.catalog import resolve_run
from app.store.reader import RunReader


def export_command(run: str, output: Path, form: str, runs: Path | None) -> None:
    """Write a run's points."""
    reader = RunReader(resolve_run(runs_folder(runs), run))
    points = reader.points()
    if not points:
        raise UsageError(f"{reader.path.name} holds no points; export needs a run of open-loop")
    match form:
        case "csv":
            write_atomically(output, points_csv(_with_whole_sigma(reader)))
        case "json":
            text = json.dumps(
                {"run": reader.path.name, "meta": reader.meta, "points": points}, ensure_ascii=False
            )
            write_atomically(output, text + "\n")
        case _:
            write_atomically(output, _parquet(points))
    say(f"{output}: {len(points)} points of {reader.path.name}")


def _with_whole_sigma(reader: RunReader) -> list[PointRow]:
    """Return a run's rows; a CSV carries no correlations, so each sigma covers the radial error motions too."""
    sigma_mm = 1e-3 * cell_of_run(reader).uncertainty.distance_um
    return [replace(row, sigma_mm=sigma_mm) for row in run_rows([reader])]


def _parquet(points: Sequence[Mapping[str, object]]) -> bytes:
    try:
        pyarrow = importlib.import_module("pyarrow")
        parquet = importlib.import_module("pyarrow.parquet")
    except ImportError as error:
        raise ConfigError("Parquet needs an extra package: pip install 'catseye[parquet]'") from error
    buffer = io.BytesIO()
    parquet.write_table(pyarrow.Table.from_pylist(list(points)), buffer)
    return buffer.getvalue()
