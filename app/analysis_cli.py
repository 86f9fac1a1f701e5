"""Commands that work on distances and results: identify, diagnose, compare, predict, validate and others."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from catseye.app.cli.options import AsJson, Runs, Unverified

Output = Annotated[Path, typer.Option("-o", "--output", help="file to write")]
ResultFile = Annotated[Path, typer.Argument(metavar="RESULT", help="result JSON of catseye identify")]
Hand = Annotated[Literal["right", "left"], typer.Option(help="of Cartesian positions: right has theta2 >= 0")]
StartDirection = Annotated[
    str, typer.Option(metavar="S1,S2", help="states of approach at the first Cartesian row, 1 or -1 each")
]
Workers = Annotated[
    int, typer.Option(min=0, help="processes that share the work; 0 takes one a core, 1 stays in this one")
]
Dask = Annotated[
    str | None,
    typer.Option(metavar="ADDRESS", help="dask scheduler whose machines share the work [catseye[cluster]]"),
]
InsecureCluster = Annotated[
    bool,
    typer.Option("--insecure-cluster", help="allow a scheduler beyond this machine without TLS"),
]

Criterion = Annotated[
    Literal["A", "D", "E", "path"],
    typer.Option(help="A mean variance, D volume, E worst direction, path worst uncertainty on --path"),
]
Floor = Annotated[
    str | None, typer.Option(metavar="X0,X1,Y0,Y1", help="floor on which reflectors may stand, mm")
]
KeepOut = Annotated[
    float | None,
    typer.Option(
        metavar="MM",
        min=0.0,
        help="radius about J1 kept free of reflectors [the arm's reach and what turns with J4]",
    ),
]
Apart = Annotated[float, typer.Option(metavar="MM", min=0.0, help="smallest distance between two reflectors")]
RandomOnly = Annotated[
    bool, typer.Option("--random-only", help="the criterion leaves out what does not average out")
]
Commands = Annotated[
    int | None, typer.Option(metavar="N", min=1, help="choose so many of the cell file's commands")
]
Minutes = Annotated[
    float | None, typer.Option(metavar="T", min=0.0, help="choose as many commands as this time allows")
]


def add_analysis(cli: typer.Typer) -> None:
    """Add the commands to the command line."""
    for command in (identify, diagnose, compare, predict, validate, compensate, design, report, export):
        cli.command()(command)


def identify(
    output: Annotated[Path, typer.Option("-o", "--output", help="result JSON to write")],
    run: Annotated[list[str] | None, typer.Argument(metavar="[RUN]...", help="measured runs")] = None,
    points: Annotated[Path | None, typer.Option(help="points CSV instead of runs; needs --cell")] = None,
    cell: Annotated[Path | None, typer.Option(help="cell file for --points")] = None,
    model: Annotated[
        Literal["conventional", "error-map"], typer.Option(help="what to identify")
    ] = "error-map",
    uncertainty: Annotated[
        Literal["jacobian", "monte-carlo"], typer.Option(help="how uncertainties are propagated")
    ] = "jacobian",
    draws: Annotated[int, typer.Option(help="Monte Carlo draws, at least 2000")] = 10_000,
    seed: Annotated[int, typer.Option(min=0, help="of the Monte Carlo draws")] = 1,
    loss: Annotated[
        Literal["squares", "huber", "soft-l1"], typer.Option(help="how much far-off distances count")
    ] = "squares",
    reject: Annotated[
        float | None,
        typer.Option(metavar="K", min=2.0, help="leave out distances beyond K robust standard deviations"),
    ] = None,
    extend: Annotated[
        list[str] | None,
        typer.Option(
            metavar="TERMS", help="crosstalk, j4, thermal, periodic1:ORDER, periodic2:ORDER; may be repeated"
        ),
    ] = None,
    workers: Workers = 1,
    dask: Dask = None,
    insecure_cluster: InsecureCluster = False,
    runs: Runs = None,
    unverified: Unverified = False,
    as_json: AsJson = False,
) -> None:
    """Identify the arm from distances.

    Example: catseye identify --points points.csv --cell cell.toml -o result.json
    """
    from catseye.app.cli.identify import IdentifyOptions, identify_command
    from catseye.app.files.atomic import require_output

    require_output(output, points, cell)

    options = IdentifyOptions(
        model,
        uncertainty,
        draws,
        seed,
        loss,
        reject,
        tuple(extend or ()),
        workers,
        dask,
        insecure_cluster,
        unverified,
    )
    identify_command(output, run or [], points, cell, options, runs, as_json)


def diagnose(
    run: Annotated[list[str] | None, typer.Argument(metavar="[RUN]...", help="measured runs")] = None,
    points: Annotated[Path | None, typer.Option(help="points CSV instead of runs; needs --cell")] = None,
    cell: Annotated[Path | None, typer.Option(help="cell file for --points")] = None,
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """Tell what speaks against a fit: outliers, drift, lack of fit, cross-validation, richer models, node spacing.

    Example: catseye diagnose 1a2b3c
    """
    from catseye.app.cli.diagnose import diagnose_command

    diagnose_command(run or [], points, cell, runs, as_json)


def compare(
    first: ResultFile,
    second: Annotated[Path, typer.Argument(metavar="RESULT", help="another one of the same arm")],
    as_json: AsJson = False,
) -> None:
    """Compare two results of one arm: links, error maps and reflectors, in combined standard uncertainties.

    Example: catseye compare january.json june.json
    """
    from catseye.app.cli.compare import compare_command

    compare_command(first, second, as_json)


def predict(
    result: ResultFile,
    path: Annotated[Path, typer.Option(help="path CSV, in joints or Cartesian")],
    output: Output,
    hand: Hand = "right",
    start_direction: StartDirection = "1,1",
    as_json: AsJson = False,
) -> None:
    """Tell where the model says the arm really goes, with uncertainties; beyond the identified range it says nothing.

    Example: catseye predict result.json --path path.csv -o predicted.csv
    """
    from catseye.app.cli.predict import predict_command
    from catseye.app.files.atomic import require_output

    require_output(output)

    predict_command(result, path, output, hand, start_direction, as_json)


def validate(
    result: ResultFile,
    measured: Annotated[
        Path, typer.Option(help="measured CSV: commands and independently measured positions")
    ],
    reference: Annotated[
        Path | None,
        typer.Option(metavar="RESULT", help="model to compare with, as a rule the conventional one"),
    ] = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="HTML page with the figures")] = None,
    limit: Annotated[
        float | None,
        typer.Option("--limit-um", min=0.0, help="2-D rms that may be left; more is exit code 1"),
    ] = None,
    hand: Hand = "right",
    start_direction: StartDirection = "1,1",
    as_json: AsJson = False,
) -> None:
    """Compare a model with an independent measurement.

    Example: catseye validate error-map.json --measured tracker.csv --reference conventional.json -o validation.html
    """
    from catseye.app.cli.validate import validate_command
    from catseye.app.files.atomic import require_output

    require_output(output, result, measured, reference)

    validate_command(result, measured, reference, output, limit, hand, start_direction, as_json)


def compensate(
    result: ResultFile,
    output: Output,
    path: Annotated[
        Path | None, typer.Option(help="path CSV, in joints or Cartesian; a table (kw-ssfk) needs none")
    ] = None,
    format_: Annotated[
        Literal["csv", "json", "melfa", "kw-ssfk"], typer.Option("--format", help="what to write")
    ] = "csv",
    hand: Hand = "right",
    start_direction: StartDirection = "1,1",
    cell: Annotated[
        Path | None, typer.Option(help="cell file whose joint limits and bodies the commands have to keep to")
    ] = None,
    j4: Annotated[float, typer.Option("--j4", metavar="DEG", help="angle of J4 all along the path")] = 0.0,
    as_json: AsJson = False,
) -> None:
    """Turn the model round: commands that bring the arm where it shall go, or a bidirectional table.

    Example: catseye compensate result.json --path path.csv --format melfa --cell cell.toml -o path.prg
    """
    from catseye.app.cli.compensate import compensate_command
    from catseye.app.files.atomic import require_output

    require_output(output)

    compensate_command(result, output, path, format_, hand, start_direction, cell, j4, as_json)


def design(
    cell: Annotated[Path, typer.Option(help="cell file: arm, limits, optics, nodes, uncertainty")],
    reflectors: Annotated[int, typer.Option(min=1, max=8, help="how many reflectors to place")] = 3,
    criterion: Criterion = "A",
    path: Annotated[Path | None, typer.Option(help="path CSV for the criterion path")] = None,
    floor: Floor = None,
    places: Annotated[int, typer.Option(min=10, max=5000, help="candidate places")] = 400,
    keep_out: KeepOut = None,
    apart: Apart = 100.0,
    breaks: Annotated[int, typer.Option(min=0, help="how often the beam to a reflector may be given up")] = 4,
    random_only: RandomOnly = False,
    commands: Commands = None,
    minutes: Minutes = None,
    pareto: Annotated[
        bool, typer.Option("--pareto", help="bench time against uncertainty, 1 to 4 reflectors")
    ] = False,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="HTML page with the pictures")] = None,
    write_cell: Annotated[
        Path | None, typer.Option(help="cell file to write with the reflectors found")
    ] = None,
    write_commands: Annotated[
        Path | None, typer.Option(help="path CSV to write with the commands chosen, in measuring order")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="of the exchange's starts")] = 1,
    workers: Workers = 1,
    dask: Dask = None,
    insecure_cluster: InsecureCluster = False,
    as_json: AsJson = False,
) -> None:
    """Tell where to put the reflectors and which commands to use.

    Example: catseye design --cell cell.toml --reflectors 3 -o design.html
    """
    from catseye.app.cli.design import DesignOptions, design_command
    from catseye.app.files.atomic import require_output

    for file in (output, write_cell, write_commands):
        require_output(file, cell, path)

    options = DesignOptions(
        reflectors,
        criterion,
        path,
        floor,
        places,
        pareto,
        seed,
        workers,
        dask,
        keep_out,
        apart,
        breaks,
        random_only,
        commands,
        minutes,
        insecure_cluster,
    )
    design_command(cell, options, output, write_cell, as_json, write_commands)


def report(
    source: Annotated[str, typer.Argument(metavar="RUN|RESULT", help="run, or result JSON")],
    output: Annotated[Path, typer.Option("-o", "--output", help="HTML file to write")],
    runs: Runs = None,
    unverified: Unverified = False,
) -> None:
    """Write one self-contained HTML page about a run or a result.

    Example: catseye report result.json -o report.html
    """
    from catseye.app.cli.report import report_command
    from catseye.app.files.atomic import require_output

    require_output(output, Path(source))

    report_command(source, output, runs, unverified)


def export(
    source: Annotated[str, typer.Argument(metavar="RUN|RESULT", help="run, or result JSON")],
    output: Annotated[Path, typer.Option("-o", "--output", help="file to write; replaced if it exists")],
    format_: Annotated[
        Literal["csv", "json", "parquet"] | None,
        typer.Option("--format", help="what to write; FILE's ending says it too"),
    ] = None,
    runs: Runs = None,
    unverified: Unverified = False,
) -> None:
    """Write what a run has measured or what a result holds for other programs.

    The CSV of distances is a points file, that of located positions a measured file; JSON and Parquet hold all
    columns.

    Example: catseye export 1a2b3c -o points.csv
    """
    from catseye.app.cli.export import export_command
    from catseye.app.files.atomic import require_output

    require_output(output)

    export_command(source, output, format_, runs, unverified)
