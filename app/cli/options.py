"""Arguments and options that several commands share, each declared once."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from catseye.app.cli import completion

CellFile = Annotated[Path, typer.Argument(metavar="FILE", help="cell file")]
CellOption = Annotated[Path, typer.Option("--cell", help="cell file")]
Telemetry = Annotated[
    bool,
    typer.Option(
        "--telemetry", help="with --json: also live values, and what happens between the other events"
    ),
]

Metrics = Annotated[
    Path | None,
    typer.Option(
        "--metrics", metavar="FILE", help="keep the state of the run in this file, as OpenMetrics text"
    ),
]

AsJson = Annotated[bool, typer.Option("--json", help="machine-readable output on stdout")]
Runs = Annotated[
    Path | None, typer.Option("--runs", help="folder of all runs [$CATSEYE_RUNS, otherwise ./catseye-runs]")
]
StoredRun = Annotated[
    str,
    typer.Argument(
        metavar="RUN", help="path, name, start of the name, or id", autocompletion=completion.stored_runs
    ),
]
AcceptImplausible = Annotated[
    str | None,
    typer.Option(metavar="TEXT", help="reason to keep an implausible result; it is stored in the result"),
]
Unverified = Annotated[
    bool,
    typer.Option(
        "--unverified", help="accept a run or table that was changed after its end; the output says so"
    ),
]
Speed = Annotated[
    float, typer.Option(min=0.001, max=1e6, help="bench seconds per real second; emulators only")
]
WaiveWalk = Annotated[
    str | None,
    typer.Option(
        "--waive-walk",
        metavar="TEXT",
        help="reason why a real arm may move without a walk-through; stored in the run",
    ),
]
Seed = Annotated[int, typer.Option(min=0, help="random seed of the emulated bench")]
Truth = Annotated[
    Path | None, typer.Option(help="result JSON with true links, maps and reflectors for the emulated arm")
]
Answers = Annotated[Path | None, typer.Option(help="answers file (TOML): prompt id = answer")]
Arm = Annotated[
    str | None, typer.Option(metavar="CELL", help="name of the cell: allows real hardware to move")
]
DryRun = Annotated[bool, typer.Option("--dry-run", help="plan and rehearse without any device")]
KeepDrives = Annotated[bool, typer.Option("--keep-drives", help="leave the drives on at the end")]

MeasuredRuns = Annotated[
    list[str] | None,
    typer.Argument(metavar="[RUN]...", help="measured runs", autocompletion=completion.stored_runs),
]
PointsFile = Annotated[
    Path | None, typer.Option(help="points file (CSV or Parquet) instead of runs; needs --cell")
]
Budget = Annotated[
    Literal["table", "cell", "none"] | None,
    typer.Option(
        help="error budget to use [the points file's own, otherwise the cell's]; none: sigma_mm counts as white noise"
    ),
]
PointsCell = Annotated[Path | None, typer.Option(help="cell file for --points")]
RunOrResult = Annotated[
    str,
    typer.Argument(
        metavar="RUN|RESULT", help="run, or result JSON", autocompletion=completion.runs_and_results
    ),
]
RunsOrResults = Annotated[
    list[str],
    typer.Argument(
        metavar="RUN|RESULT...",
        help="run or result JSON; for motion resolution also several results",
        autocompletion=completion.runs_and_results,
    ),
]
Output = Annotated[Path, typer.Option("-o", "--output", help="file to write")]
ResultFile = Annotated[Path, typer.Argument(metavar="RESULT", help="result JSON of catseye identify")]
Workers = Annotated[
    int, typer.Option(min=0, help="number of processes; 0: one per core; 1: this process only")
]
Dask = Annotated[
    str | None,
    typer.Option(metavar="ADDRESS", help="address of a dask scheduler (needs catseye[cluster])"),
]
InsecureCluster = Annotated[
    bool,
    typer.Option("--insecure-cluster", help="allow a scheduler on another machine without TLS"),
]
