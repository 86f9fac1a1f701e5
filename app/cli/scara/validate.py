"""validate, of a SCARA: a model against an independent measurement."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from catseye.app.cli.output import note, warn, write_document
from catseye.app.cli.report_output import hand_out_page, note_statements, require_page, write_tables
from catseye.app.cli.scara.options import HandName
from catseye.app.errors import MeasurementRejectedError, UsageError
from catseye.app.store.runs_folder import runs_folder

if TYPE_CHECKING:
    from catseye.app.results.scara.instrument_positions import ForeignPositions
    from catseye.app.store.reader import RunReader


@dataclass(frozen=True)
class Wanted:
    """What is to be compared, as it was typed.

    Attributes:
        result: model.
        measured: file, or a run.
        reference: model to compare with; None for none, with a run for the conventional one of the same runs that
            lies beside the result.
        output: page to write.
        limit: 2-D rms that may be left, µm.
        hand: of Cartesian commands.
        start_direction: states of approach of the first Cartesian command.
        mapping: of a file that another program wrote.
        path: that was driven for it.
        as_json: write JSON.
    """

    result: Path
    measured: Path
    reference: Path | None = None
    output: Path | None = None
    limit: float | None = None
    hand: HandName = "right"
    start_direction: str = "1,1"
    mapping: Path | None = None
    path: Path | None = None
    as_json: bool = False


def validate_path(wanted: Wanted, runs: Path | None, *, preview: bool = False) -> None:
    """Compare a model with a measured file, or with the path that a run has measured.

    Args:
        runs: folder of all runs.
        preview: only show how the file is read.

    Raises:
        MeasurementRejectedError: more is left than the limit.
        UsageError: the file or the run has measured no path, or its models cannot be those of the result.
    """
    if preview:
        _show_preview(wanted)
    elif wanted.measured.is_file() or wanted.measured.suffix.lower() == ".csv" or wanted.mapping is not None:
        _validate_file(wanted)
    else:
        _validate_run(wanted, runs)


def _show_preview(wanted: Wanted) -> None:
    from catseye.app.cli.preview import show_preview
    from catseye.app.results.scara.instrument_positions import positions_report, preview_positions

    shown = preview_positions(wanted.measured, wanted.mapping)
    facts = {"positions": len(shown.columns), "headings": shown.headings}
    show_preview(shown.mapping, facts, positions_report(wanted.measured, shown), as_json=wanted.as_json)


def _validate_file(wanted: Wanted) -> None:
    from catseye.app.results.scara.validation_document import validation_document
    from catseye.app.results.scara.validation_of_files import file_validation_report, validate_files

    measured = wanted.measured
    require_page(wanted.output, wanted.result, measured, wanted.reference, wanted.mapping, wanted.path)
    found = validate_files(
        wanted.result, measured, wanted.reference, wanted.hand, wanted.start_direction, _foreign(wanted)
    )
    report = file_validation_report(found, measured.name)
    hand_out_page(report, wanted.output)
    if wanted.as_json:
        document = validation_document(found, wanted.limit, report.figures("validation"))
        write_document("path-validation", document.json_object())
    else:
        write_tables(report)
    note_statements(report)
    _require_within(wanted.limit, found.validation.models[-1].comparison.rms_2d_um, f"{measured}", "2-D rms")


def _foreign(wanted: Wanted) -> "ForeignPositions | None":
    from catseye.app.results.mapping import read_mapping
    from catseye.app.results.scara.instrument_positions import ForeignPositions
    from catseye.procedures.scara.path.instrument_file import PositionsMapping

    if wanted.mapping is None:
        if wanted.path is not None:
            raise UsageError(
                "--path says what was driven while a tracker's program wrote its file: give --mapping, too; "
                "catseye validate … --preview suggests one. A measured CSV holds its commands: omit --path"
            )
        return None
    if wanted.path is None:
        raise UsageError(
            f"{wanted.measured} holds positions alone: give --path FILE, the path file, or the CSV of catseye "
            "compensate, that was driven"
        )
    return ForeignPositions(read_mapping(PositionsMapping, wanted.mapping), wanted.path)


def _validate_run(wanted: Wanted, runs: Path | None) -> None:
    from catseye.app.results.scara.path_as_file import path_as_file
    from catseye.app.results.scara.validation_of_run import conventional_beside, has_distances
    from catseye.app.store.catalog import resolve_run
    from catseye.app.store.reader import RunReader

    if wanted.path is not None:
        raise UsageError(f"{wanted.measured} is a run, which knows what was driven: omit --path")
    reader = RunReader(resolve_run(runs_folder(runs), str(wanted.measured)))
    if has_distances(reader):
        _validate_distances(wanted, reader)
        return
    reference = wanted.reference or conventional_beside(wanted.result)
    if wanted.reference is None and reference is not None:
        note(f"compared with {reference}, the conventional model of the same runs")
    with path_as_file(reader) as measured:
        _validate_file(replace(wanted, measured=measured, reference=reference))


def _validate_distances(wanted: Wanted, reader: "RunReader") -> None:
    from catseye.app.results.scara.validation_of_run import (
        distance_document,
        distance_report,
        is_conventional_of,
        validate_run,
    )

    require_page(wanted.output, wanted.result, wanted.reference)
    if wanted.reference is not None and not is_conventional_of(wanted.reference, wanted.result):
        raise UsageError(
            f"{reader.name} has measured distances, which are compared with both models of the result's runs: "
            f"{wanted.reference} is not a conventional model of them; omit --reference"
        )
    found = validate_run(wanted.result, reader)
    for text in found.notes:
        warn(text)
    if found.distances is None:
        raise TypeError("a run of distances is compared by distances")
    report = distance_report(found, reader)
    hand_out_page(report, wanted.output)
    if wanted.as_json:
        write_document("distance-validation", distance_document(found.distances, wanted.limit).json_object())
    else:
        write_tables(report)
    note_statements(report)
    _require_within(wanted.limit, found.distances.models[-1].rms_um, reader.name, "rms of distances")


def _require_within(limit: float | None, left_um: float, measured: str, what: str) -> None:
    if limit is not None and left_um > limit:
        raise MeasurementRejectedError(
            f"{measured}: the model leaves {left_um:.1f} µm ({what}), more than the limit of {limit:g} µm"
        )
