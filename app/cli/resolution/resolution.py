"""resolution: from recordings to step errors, least increment steps and reversal errors."""

import math
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, TypeVar

import typer

from catseye.app.cli.options import AsJson, MeasuredRuns, Runs, Unverified
from catseye.app.cli.output import note, write_document
from catseye.app.cli.progress import ProgressBar
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.errors import MeasurementRejectedError, UsageError
from catseye.app.files.atomic import require_output

if TYPE_CHECKING:
    from catseye.app.results.resolution.input_files import RecordingFile
    from catseye.app.results.resolution.result import ResolutionResult
    from catseye.calibration.resolution.optics import AngleAccuracy, AngularOptics

GivenT = TypeVar("GivenT")


Output = Annotated[
    Path | None, typer.Option("-o", "--output", help="result JSON to write (not with --preview)")
]
RecordingOption = Annotated[
    Path | None, typer.Option(help="recording (CSV or Parquet), or .rtl or .rta for --test backlash")
]
Moves = Annotated[Path | None, typer.Option(help="file of the moves: t_s,command_deg or t_s,command_mm")]
TestOption = Annotated[
    Literal["decaying", "iso", "backlash", "cartesian"] | None, typer.Option(help="kind of test")
]
Joint = Annotated[str | None, typer.Option(help="joint that was tested; X, Y or Z for a Cartesian test")]
Position = Annotated[float | None, typer.Option(help="position of the joint (mm for a prismatic one)")]
Pose = Annotated[str | None, typer.Option(help="name of the pose, for a Cartesian test")]
ArmOption = Annotated[str | None, typer.Option(help="name of a shipped arm, or path of an arm description")]
Spacing = Annotated[
    float | None,
    typer.Option(min=1.0, help="spacing S of the angular optics, if the recording holds displacements"),
]
Zero = Annotated[
    float | None,
    typer.Option(
        min=-30.0,
        max=30.0,
        help="angle of the optics from parallel where the displacement is 0 [0]",
    ),
]
UZero = Annotated[
    float | None, typer.Option(min=0.0, max=10.0, help="standard uncertainty of --zero-deg [1]")
]
AccuracyUrad = Annotated[
    float | None,
    typer.Option(min=0.0, help="constant part of the instrument's accuracy for angles (k = 2)"),
]
AccuracyPercent = Annotated[
    float | None,
    typer.Option(
        min=0.0,
        max=100.0,
        help="part of the instrument's accuracy for angles that is proportional to the angle (k = 2)",
    ),
]
JointTorque = Annotated[
    Path | None,
    typer.Option(help="motor torque: t_s,torque_nm, or a KUKA trace (.dat with .r64, or CSV)"),
]
TorqueChannel = Annotated[str | None, typer.Option(help="channel to use of a trace with several torques")]
DeviationUnit = Annotated[
    Literal["mrad", "urad", "arcsec", "mdeg"] | None,
    typer.Option(help="unit of the deviations in a .rta file"),
]
Align = Annotated[
    Literal["auto", "none"],
    typer.Option(help="auto: find offset and drift between the clocks of recording and moves"),
]
Threshold = Annotated[
    float,
    typer.Option(
        metavar="PERCENT", min=0.1, max=100.0, help="largest error of a step that counts as executed"
    ),
]
Mapping = Annotated[
    Path | None, typer.Option(help="mapping (TOML): which column of the recording holds what")
]
Rate = Annotated[
    float | None,
    typer.Option(
        min=1.0, help="sampling rate, to check the times with; with --preview, for a recording without times"
    ),
]
Preview = Annotated[
    bool, typer.Option("--preview", help="show how the recording is read, and write its mapping to stdout")
]


def resolution(
    output: Output = None,
    run: MeasuredRuns = None,
    recording: RecordingOption = None,
    moves: Moves = None,
    test: TestOption = None,
    joint: Joint = None,
    position_deg: Position = None,
    pose: Pose = None,
    arm: ArmOption = None,
    spacing_mm: Spacing = None,
    zero_deg: Zero = None,
    u_zero_deg: UZero = None,
    accuracy_urad: AccuracyUrad = None,
    accuracy_percent: AccuracyPercent = None,
    joint_torque: JointTorque = None,
    torque_channel: TorqueChannel = None,
    deviation_unit: DeviationUnit = None,
    align: Align = "none",
    threshold: Threshold = 10.0,
    mapping: Mapping = None,
    rate_hz: Rate = None,
    preview: Preview = False,
    runs: Runs = None,
    unverified: Unverified = False,
    as_json: AsJson = False,
) -> None:
    """Determine least increment steps and reversal errors. The data are runs, or recordings of other programs.

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
        result = _result_of_runs(run, threshold, runs, unverified=unverified)
    else:
        from catseye.app.results.resolution.evaluation import Asked
        from catseye.app.results.resolution.imported import Import, imported_result

        accuracy = _accuracy(accuracy_urad, accuracy_percent)
        optics = _optics(spacing_mm, zero_deg, u_zero_deg)
        source = _recording_file(
            _given(recording, "RUN or --recording"), mapping, optics, rate_hz, accuracy, zero_deg is not None
        )
        asked = Asked(_given(test, "--test"), _given(joint, "--joint"), position_deg, pose, threshold)
        files = Import(source, asked, moves, joint_torque, torque_channel, align == "auto", deviation_unit)
        result = imported_result(files, _given(arm, "--arm"))
    _hand_over(result, result_file, as_json=as_json)


def _recording_file(
    source: Path,
    mapping: Path | None,
    optics: "AngularOptics | None",
    rate_hz: float | None,
    accuracy: "AngleAccuracy | None",
    zero_is_stated: bool,
) -> "RecordingFile":
    from catseye.app.results.mapping import read_mapping
    from catseye.app.results.resolution.input_files import RecordingFile
    from catseye.app.results.resolution.recording_mapping import RecordingMapping

    columns = None if mapping is None else read_mapping(RecordingMapping, mapping)
    return RecordingFile(source, columns, optics, rate_hz, accuracy, zero_is_stated)


def _optics(
    spacing_mm: float | None, zero_deg: float | None, u_zero_deg: float | None
) -> "AngularOptics | None":
    from catseye.calibration.resolution.optics import U_ZERO_DEG, AngularOptics

    if spacing_mm is None:
        if zero_deg is not None or u_zero_deg is not None:
            raise UsageError("--zero-deg and --u-zero-deg are of angular optics: state --spacing-mm, too")
        return None
    u_zero_rad = math.radians(U_ZERO_DEG if u_zero_deg is None else u_zero_deg)
    return AngularOptics(spacing_mm, zero_rad=math.radians(zero_deg or 0.0), u_zero_rad=u_zero_rad)


def _accuracy(constant_urad: float | None, percent: float | None) -> "AngleAccuracy | None":
    from catseye.calibration.resolution.optics import AngleAccuracy

    if constant_urad is None and percent is None:
        return None
    return AngleAccuracy(constant_urad or 0.0, (percent or 0.0) / 100.0)


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
    with taken_as_it_is(*readers), closing(ProgressBar("evaluation")) as bar:
        return result_of_runs(readers, threshold, lambda n, of: bar.update(n, of, f"{n} of {of} tests"))


def _show_preview(source: Path, mapping: Path | None, rate_hz: float | None, *, as_json: bool) -> None:
    from catseye.app.cli.preview import show_preview
    from catseye.app.results.mapping import read_mapping
    from catseye.app.results.resolution.preview import preview, preview_report
    from catseye.app.results.resolution.recording_mapping import RecordingMapping

    shown = preview(source, None if mapping is None else read_mapping(RecordingMapping, mapping), rate_hz)
    facts = {"samples": len(shown.columns), "rate_hz": shown.rate_hz}
    show_preview(shown.mapping, facts, preview_report(source, shown), as_json=as_json)


def _hand_over(result: "ResolutionResult", output: Path, *, as_json: bool) -> None:
    """Write a result and show it.

    Raises:
        MeasurementRejectedError: some tests cannot be evaluated; those that can are written.
    """
    from catseye.app.results.resolution.documents import resolution_document
    from catseye.app.results.resolution.report_files import ReportFiles
    from catseye.app.results.resolution.result import write_resolution
    from catseye.app.results.resolution.result_report import resolution_report
    from catseye.app.results.runs.trace import sources_of

    write_resolution(result, output)
    report = resolution_report(f"Result {output.name}", ReportFiles((result,)), sources_of([output]))
    if as_json:
        write_document("resolution", resolution_document(result, output))
    else:
        write_tables(report)
    note_statements(report)
    note(f"{output} written")
    if result.refused:
        raise MeasurementRejectedError(
            f"{len(result.refused)} of {len(result.refused) + len(result.tests)} tests cannot be evaluated, as said "
            f"above; {output} holds the others: measure these again in another run, and evaluate both together"
        )
