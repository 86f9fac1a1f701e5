"""resolution: from recordings to step errors, least increment steps and reversal errors."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, TypeVar

import typer

from catseye.app.cli.options import AsJson, MeasuredRuns, Runs, Unverified
from catseye.app.cli.output import note, write_json, write_line
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.errors import UsageError
from catseye.app.files.atomic import require_output

if TYPE_CHECKING:
    from catseye.app.results.resolution.result import ResolutionResult

GivenT = TypeVar("GivenT")


def resolution(
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="result JSON to write; not with --preview")
    ] = None,
    run: MeasuredRuns = None,
    recording: Annotated[
        Path | None, typer.Option(help="recording, CSV or Parquet; .rtl or .rta for --test backlash")
    ] = None,
    moves: Annotated[Path | None, typer.Option(help="moves: t_s,command_deg or t_s,command_mm")] = None,
    test: Annotated[
        Literal["decaying", "iso", "backlash", "cartesian"] | None, typer.Option(help="what was done")
    ] = None,
    joint: Annotated[str | None, typer.Option(help="joint of the arm; X, Y or Z of a Cartesian test")] = None,
    position_deg: Annotated[
        float | None, typer.Option(help="where the joint was tested (mm of one that slides)")
    ] = None,
    pose: Annotated[str | None, typer.Option(help="name of the pose of a Cartesian test")] = None,
    arm: Annotated[str | None, typer.Option(help="name of a shipped arm, or path of a description")] = None,
    spacing_mm: Annotated[
        float | None, typer.Option(min=1.0, help="S of angular optics, of a recording of displacements")
    ] = None,
    joint_torque: Annotated[
        Path | None, typer.Option(help="motor torque: t_s,torque_nm, or a KUKA trace, .dat with .r64 or CSV")
    ] = None,
    torque_channel: Annotated[str | None, typer.Option(help="of a trace with several torques")] = None,
    deviation_unit: Annotated[
        Literal["mrad", "urad", "arcsec", "mdeg"] | None, typer.Option(help="of the deviations of a .rta")
    ] = None,
    align: Annotated[
        Literal["auto", "none"],
        typer.Option(help="find offset and drift between the clocks of the two files"),
    ] = "none",
    threshold: Annotated[
        float, typer.Option(metavar="PERCENT", min=0.1, max=100.0, help="largest error of a step that counts")
    ] = 10.0,
    mapping: Annotated[
        Path | None, typer.Option(help="TOML file that says which columns of the recording are what")
    ] = None,
    rate_hz: Annotated[
        float | None,
        typer.Option(
            min=1.0, help="rate of the recording, held against its times; of one without, for --preview"
        ),
    ] = None,
    preview: Annotated[
        bool, typer.Option("--preview", help="show how the recording is read, write its mapping to stdout")
    ] = False,
    runs: Runs = None,
    unverified: Unverified = False,
    as_json: AsJson = False,
) -> None:
    """Find step errors, least increment steps and reversal errors in runs or recordings.

    Example: catseye resolution --recording laser.csv --moves moves.csv --test decaying --joint A1 --position-deg 0
    --arm kr210-r2700 --spacing-mm 30 -o a1.json
    """
    if preview:
        _show_preview(_given(recording, "--recording"), mapping, rate_hz, as_json=as_json)
        return
    result_file = _given(output, "-o")
    require_output(result_file, recording, moves, joint_torque, mapping)
    if run:
        if recording is not None:
            raise UsageError("state either runs or --recording")
        _hand_over(_result_of_runs(run, threshold, runs, unverified=unverified), result_file, as_json=as_json)
        return
    source = _given(recording, "RUN or --recording")
    from catseye.app.results.resolution.csv_mapping import read_mapping
    from catseye.app.results.resolution.evaluation import Asked
    from catseye.app.results.resolution.imported import Import, imported_result
    from catseye.app.results.resolution.input_files import RecordingFile
    from catseye.calibration.resolution.optics import AngularOptics

    result = imported_result(
        Import(
            RecordingFile(
                source,
                None if mapping is None else read_mapping(mapping),
                None if spacing_mm is None else AngularOptics(spacing_mm),
                rate_hz,
            ),
            Asked(_given(test, "--test"), _given(joint, "--joint"), position_deg, pose, threshold),
            moves,
            joint_torque,
            torque_channel,
            align == "auto",
            deviation_unit,
        ),
        _given(arm, "--arm"),
    )
    _hand_over(result, result_file, as_json=as_json)


def _given(value: GivenT | None, option: str) -> GivenT:
    if value is None:
        raise UsageError(f"{option} is missing; catseye resolution -h explains the options")
    return value


def _result_of_runs(
    names: list[str], threshold: float, runs: Path | None, *, unverified: bool
) -> "ResolutionResult":
    from catseye.app.results.resolution.recorded_runs import result_of_runs
    from catseye.app.store.catalog import resolve_run
    from catseye.app.store.reader import RunReader, accept
    from catseye.app.store.runs_folder import runs_folder
    from catseye.app.store.unverified import taken_as_it_is

    folder = runs_folder(runs)
    readers = [RunReader(resolve_run(folder, name), accept(unverified=unverified)) for name in names]
    with taken_as_it_is(*readers):
        return result_of_runs(readers, threshold)


def _show_preview(source: Path, mapping: Path | None, rate_hz: float | None, *, as_json: bool) -> None:
    from catseye.app.render.text import report_text
    from catseye.app.results.resolution.csv_mapping import mapping_text, read_mapping
    from catseye.app.results.resolution.preview import preview, preview_report

    shown = preview(source, None if mapping is None else read_mapping(mapping), rate_hz)
    if as_json:
        found = shown.mapping.model_dump(exclude_none=True)
        write_json({"mapping": found, "samples": len(shown.columns), "rate_hz": shown.rate_hz})
    else:
        write_line(mapping_text(shown.mapping).rstrip())
    note(report_text(preview_report(source, shown)))


def _hand_over(result: "ResolutionResult", output: Path, *, as_json: bool) -> None:
    """Write a result and show it."""
    from catseye.app.results.resolution.report_files import ReportFiles
    from catseye.app.results.resolution.result import resolution_summary, write_resolution
    from catseye.app.results.resolution.result_report import resolution_report
    from catseye.app.results.runs.trace import sources_of

    write_resolution(result, output)
    report = resolution_report(f"Result {output.name}", ReportFiles((result,)), sources_of([output]))
    if as_json:
        write_json({"result": str(output), **resolution_summary(result)})
    else:
        write_tables(report)
    note_statements(report)
    note(f"{output} written")
