"""export: a run's rows or a result's values for other programs."""

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from catseye.app.cli.options import RunOrResult, Runs, Unverified
from catseye.app.cli.output import note, warn
from catseye.app.errors import UsageError
from catseye.app.files.atomic import require_output, write_atomically
from catseye.app.files.csv_text import comment_lines
from catseye.app.files.tabular import table_csv, table_parquet
from catseye.app.protocol.banners import unverified_text
from catseye.app.store.runs_folder import runs_folder
from catseye.procedures.kit.recording import Recorded

if TYPE_CHECKING:
    from catseye.app.results.scara.export import Export

Format = Literal["csv", "json", "parquet", "urdf"]

_ENDINGS: dict[str, Format] = {".csv": "csv", ".json": "json", ".parquet": "parquet", ".urdf": "urdf"}


def export(
    source: RunOrResult,
    output: Annotated[Path, typer.Option("-o", "--output", help="file to write; replaced if it exists")],
    format_: Annotated[
        Format | None,
        typer.Option("--format", help="format to write [by the file name's ending]"),
    ] = None,
    runs: Runs = None,
    unverified: Unverified = False,
) -> None:
    """Export a run or a result to other programs.

    The CSV holds distances (points file), measured positions (measured CSV) or measured targets (poses CSV); JSON and
    Parquet hold all columns. A run with recordings gives, beside the CSV, a file of readings, one of moves and one of
    torques for each series. A calibrated serial arm can be exported as URDF.

    Example: catseye export 1a2b3c -o points.csv
    """
    require_output(output)
    chosen = form_of(output, format_)
    direct = Path(source)
    if direct.is_file() and output.exists() and output.samefile(direct):
        raise UsageError(f"{output} is the result itself; choose another -o FILE")
    if direct.is_file() and _is_of_serial_arm(direct):
        _write_serial_arm(direct, output, chosen)
        return
    if chosen == "urdf":
        raise UsageError(f"{source}: URDF is of calibrated serial arms (catseye calibrate): take csv or json")
    table = _of_result(direct) if direct.is_file() else _of_run(source, runs, unverified=unverified)
    if chosen == "csv" and not direct.is_file():
        _write_series(source, runs, output, unverified=unverified)
    for text in table.origin.unverified:
        note(unverified_text(text))
    write_atomically(output, _written(table, chosen))
    returns = sum(bool(row.get("returned")) for row in table.rows)
    kind = f"{table.content}, {returns} of them returns" if returns else table.content
    note(f"{output}: {len(table.rows)} rows ({kind}) of {table.source}")


def _is_of_serial_arm(file: Path) -> bool:
    from catseye.app.results.serial_arm.result import is_of_serial_arm

    return is_of_serial_arm(file)


def _write_serial_arm(file: Path, output: Path, form: Format) -> None:
    """Write the parameters of a calibrated serial arm."""
    from catseye.app.results.serial_arm.export import parameter_rows, urdf_text
    from catseye.app.results.serial_arm.result import read_serial_arm

    result = read_serial_arm(file)
    rows = parameter_rows(result)
    about = {"result": file.name, "arm": result.arm, "model": result.model}
    match form:
        case "csv":
            written: str | bytes = table_csv(rows)
        case "json":
            written = json.dumps({**about, "parameters": rows}, ensure_ascii=False) + "\n"
        case "parquet":
            written = table_parquet(rows, about)
        case _:
            written = urdf_text(result)
    write_atomically(output, written)
    note(f"{output}: {len(rows)} parameters of {file.name}")


def _of_result(file: Path) -> "Export":
    from catseye.app.results.scara.export import result_export

    return result_export(file)


def _of_run(name: str, runs: Path | None, *, unverified: bool) -> "Export":
    from catseye.app.results.scara.export import run_export
    from catseye.app.results.serial_arm.run_poses import has_targets, pose_export, pose_notes
    from catseye.app.store.catalog import resolve_run
    from catseye.app.store.reader import RunReader, accept
    from catseye.app.store.unverified import taken_as_it_is

    if Path(name).suffix.lower() == ".json":
        raise UsageError(f"{name}: there is no such file")
    reader = RunReader(resolve_run(runs_folder(runs), name), accept(unverified=unverified))
    with taken_as_it_is(reader):
        if not has_targets(reader):
            return run_export(reader)
        for text in pose_notes(reader):
            warn(text)
        return pose_export(reader)


def _write_series(name: str, runs: Path | None, output: Path, *, unverified: bool) -> None:
    """Write the recorded series of a run beside its table, each as files that can be evaluated again."""
    from catseye.app.store.catalog import resolve_run
    from catseye.app.store.reader import RunReader, accept

    reader = RunReader(resolve_run(runs_folder(runs), name), accept(unverified=unverified))
    if not reader.count(Recorded.table):
        return
    from catseye.app.results.resolution.series_files import series_files

    for ending, text in series_files(reader):
        file = output.with_name(f"{output.stem}-{ending}")
        write_atomically(file, text)
        note(str(file))


def form_of(output: Path, form: Format | None) -> Format:
    """Return the format that is meant.

    Args:
        output: file to write; its ending may say the format.
        form: what was asked for; None leaves it to the ending.

    Raises:
        UsageError: the ending says nothing, or something else than what was asked for.
    """
    ending = _ENDINGS.get(output.suffix.lower())
    chosen = form or ending
    if chosen is None:
        raise UsageError(
            f"{output}: say what to write: --format csv, json, parquet or urdf, or a FILE that ends so"
        )
    if ending is not None and chosen != ending:
        raise UsageError(
            f"{output} would hold {chosen}, though its name says {ending}: "
            f"write -o {output.with_suffix(f'.{chosen}')} or --format {ending}"
        )
    return chosen


def _written(table: "Export", form: Format) -> str | bytes:
    match form:
        case "csv":
            # A points file has comment lines anyway; readers of other tables may know none.
            origin = table.origin if table.documents else replace(table.origin, simulated=False)
            return comment_lines(origin.banners) + table.csv
        case "json":
            about = {**table.about, **_beside(table)}
            return json.dumps({**about, table.content: table.rows}, ensure_ascii=False) + "\n"
        case _:
            return table_parquet(table.rows, _beside(table))


def _beside(table: "Export") -> dict[str, object]:
    unverified = {"unverified": table.origin.unverified} if table.origin.unverified else {}
    return {**table.documents, "simulated": table.origin.simulated, **unverified}
