"""Options that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

CellFile = Annotated[Path, typer.Argument(metavar="FILE", help="cell file")]
AsJson = Annotated[bool, typer.Option("--json", help="machine-readable output on stdout")]
Runs = Annotated[
    Path | None, typer.Option("--runs", help="folder of all runs [$CATSEYE_RUNS, else ./catseye-runs]")
]
Unverified = Annotated[
    bool,
    typer.Option(
        "--unverified", help="take a sealed run that was changed after its end; what comes out says so"
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
