"""Arguments and options that several commands share, each declared once."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from catseye.app.cli import completion

CellFile = Annotated[Path, typer.Argument(metavar="FILE", help="cell file")]
CellOption = Annotated[Path, typer.Option("--cell", help="cell file")]
Telemetry = Annotated[
    bool,
    typer.Option("--telemetry", help="with --json: live values and what happens between the events, too"),
]

AsJson = Annotated[bool, typer.Option("--json", help="machine-readable output on stdout")]
Runs = Annotated[
    Path | None, typer.Option("--runs", help="folder of all runs [$CATSEYE_RUNS, else ./catseye-runs]")
]
StoredRun = Annotated[
    str,
    typer.Argument(
        metavar="RUN", help="path, name, beginning of a name, or id", autocompletion=completion.stored_runs
    ),
]
AcceptImplausible = Annotated[
    str | None, typer.Option(metavar="TEXT", help="keep an implausible result; the reason stands in it")
]
Unverified = Annotated[
    bool,
    typer.Option(
        "--unverified", help="take a sealed run or table that was changed afterwards; what comes out says so"
    ),
]
Speed = Annotated[
    float, typer.Option(min=0.001, max=1e6, help="bench seconds in one real second; emulators only")
]
WaiveWalk = Annotated[
    str | None,
    typer.Option(
        "--waive-walk", metavar="TEXT", help="why a real arm may drive what was not walked; the run keeps it"
    ),
]
Seed = Annotated[int, typer.Option(min=0, help="of everything random in the emulated bench")]
Truth = Annotated[
    Path | None, typer.Option(help="result JSON with the emulated arm's true links, maps, reflectors")
]
Answers = Annotated[Path | None, typer.Option(help="TOML file: prompt id = answer")]
Arm = Annotated[str | None, typer.Option(metavar="CELL", help="cell name, typed to let real hardware move")]
DryRun = Annotated[bool, typer.Option("--dry-run", help="plan and rehearse, touch no device")]
KeepDrives = Annotated[
    bool, typer.Option("--keep-drives", help="leave the drives on at the end [they are switched off]")
]

MeasuredRuns = Annotated[
    list[str] | None,
    typer.Argument(metavar="[RUN]...", help="measured runs", autocompletion=completion.stored_runs),
]
PointsFile = Annotated[
    Path | None, typer.Option(help="points file instead of runs, CSV or Parquet; needs --cell")
]
Budget = Annotated[
    Literal["table", "cell", "none"] | None,
    typer.Option(
        help="whose error budget counts [the points file's own, else the cell's]; none takes sigma_mm as white"
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
        help="run, or result JSON; several of motion resolution",
        autocompletion=completion.runs_and_results,
    ),
]
Output = Annotated[Path, typer.Option("-o", "--output", help="file to write")]
ResultFile = Annotated[Path, typer.Argument(metavar="RESULT", help="result JSON of catseye identify")]
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
