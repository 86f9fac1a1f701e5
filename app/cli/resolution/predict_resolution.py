"""predict-resolution: from look-up tables of joints to the smallest steps of the tool."""

from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from catseye.app.cli.arm_option import described
from catseye.app.cli.options import AsJson, Dask, InsecureCluster, Workers
from catseye.app.cli.output import note, write_document
from catseye.app.cli.progress import ProgressBar
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.cluster.sharing import sharing
from catseye.app.errors import UsageError
from catseye.app.files.atomic import require_output

if TYPE_CHECKING:
    from catseye.calibration.core.types import Floats
    from catseye.calibration.resolution.workspace_slice import AxisName, SliceAxis

Tables = Annotated[Path, typer.Argument(metavar="TABLES", help="CSV of catseye resolution-model")]
Output = Annotated[
    Path,
    typer.Option(
        "-o", "--output", help="CSV to write; a .json also has the errors of all steps, for catseye report"
    ),
]
ArmOption = Annotated[str, typer.Option(help="name of a shipped arm, or path of an arm description")]
Poses = Annotated[Path, typer.Option(help="poses CSV: pose, q1_deg …")]
Tool = Annotated[
    Path | None, typer.Option(help="tool TOML with the tool centre point as a target [the flange]")
]
Target = Annotated[str | None, typer.Option(help="target of the tool, if it has several")]
Reversal = Annotated[
    bool,
    typer.Option(
        "--reversal", help="subtract the reversal error of joints that reverse after the previous pose"
    ),
]
Draws = Annotated[int, typer.Option(min=40, max=100_000, help="number of simulated runs")]
Seed = Annotated[int, typer.Option(min=0, help="seed of the simulated runs")]
Threshold = Annotated[
    float,
    typer.Option(
        metavar="PERCENT", min=0.1, max=100.0, help="largest error of a step that counts as executed"
    ),
]
FromMm = Annotated[float, typer.Option(min=1e-4, max=100.0, help="first step of translations")]
FromDeg = Annotated[float, typer.Option(min=1e-5, max=10.0, help="first step of rotations")]
Measured = Annotated[
    Path | None, typer.Option(help="result JSON with Cartesian tests at the poses, for comparison")
]
Slice = Annotated[
    str | None,
    typer.Option(
        "--map",
        metavar="SLICE",
        help="grid of positions with the orientation of the first pose: x=800:2000:7,z=500:2000:6 (mm:mm:points)",
    ),
]


def predict_resolution(
    tables: Tables,
    arm: ArmOption,
    poses: Poses,
    output: Output,
    tool: Tool = None,
    target: Target = None,
    reversal: Reversal = False,
    draws: Draws = 50,
    seed: Seed = 1,
    threshold: Threshold = 10.0,
    from_mm: FromMm = 1.0,
    from_deg: FromDeg = 0.03,
    map_slice: Slice = None,
    measured: Measured = None,
    workers: Workers = 1,
    dask: Dask = None,
    insecure_cluster: InsecureCluster = False,
    as_json: AsJson = False,
) -> None:
    """Predict the smallest steps of the tool. The data are look-up tables of the joints.

    Example: catseye predict-resolution tables.csv --arm kr210-r2700 --poses poses.csv -o predicted.csv
    """
    from catseye.app.results.resolution.cartesian_comparison import compare_with_measured
    from catseye.app.results.resolution.cartesian_prediction import Prediction, predicted_resolution
    from catseye.app.results.resolution.documents import prediction_document
    from catseye.app.results.resolution.predicted import write_predicted
    from catseye.app.results.resolution.prediction_report import prediction_report
    from catseye.calibration.resolution.cartesian_steps import StepSeries
    from catseye.calibration.resolution.predictor import PredictionMethod

    require_output(output, tables, poses, tool, measured)
    asked = Prediction(
        described(arm),
        tables,
        poses,
        PredictionMethod(threshold, draws, seed, StepSeries(from_mm, from_deg)),
        _tool_frame(tool, target),
        None if map_slice is None else _axes(map_slice),
        reversal,
    )
    with (
        sharing(workers, dask, insecure=insecure_cluster) as share,
        closing(ProgressBar("prediction")) as bar,
    ):
        predicted = predicted_resolution(asked, share, lambda n, of: bar.update(n, of, f"{n} of {of} poses"))
    write_predicted(predicted, output)
    compared = None if measured is None else compare_with_measured(predicted.least_steps, measured)
    report = prediction_report(predicted, compared)
    if as_json:
        write_document("step-prediction", prediction_document(predicted, compared, output))
    else:
        write_tables(report)
    note_statements(report)
    note(f"{output} written")


def _tool_frame(tool: Path | None, target: str | None) -> "Floats | None":
    """Return the tool centre point; a tool with one target needs no name."""
    from catseye.app.cell.serial_arm import tool_frame
    from catseye.app.cell.tool import read_tool

    if tool is None:
        if target is not None:
            raise UsageError("--target names a target of a tool: give --tool FILE, too")
        return None
    description = read_tool(tool)
    names = [one.name for one in description.target]
    if target is None and len(names) != 1:
        listed = ", ".join(names) or "none"
        raise UsageError(f"{tool}: which target is the tool centre point? It has {listed}: add --target NAME")
    try:
        return tool_frame(description, target or names[0])
    except ValueError as error:
        raise UsageError(f"{tool}: {error}") from error


def _axes(text: str) -> "dict[AxisName, SliceAxis]":
    from typing import cast

    from catseye.calibration.resolution.workspace_slice import AxisName, SliceAxis

    axes: dict[AxisName, SliceAxis] = {}
    for part in text.split(","):
        name, _, numbers = part.strip().partition("=")
        ends = numbers.split(":")
        try:
            if name not in {"x", "y", "z"} or name in axes or len(ends) != 3:
                raise ValueError(part)
            axes[cast("AxisName", name)] = SliceAxis(float(ends[0]), float(ends[1]), int(ends[2]))
        except ValueError as error:
            raise UsageError(
                f"--map {text}: {part!r} is not an axis of a slice ({error}): write x, y or z once each with "
                "first, last and number of points, as in --map x=800:2000:7,z=500:2000:6"
            ) from error
    return axes
