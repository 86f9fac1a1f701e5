"""design: where to put the reflectors, which commands to use."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from catseye.app.cli.options import AsJson, Dask, InsecureCluster, Workers
from catseye.app.cli.output import note, write_document
from catseye.app.cli.progress import ProgressBar
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.cluster.sharing import sharing
from catseye.app.errors import UsageError
from catseye.app.files.atomic import require_output, write_atomically, write_users_file
from catseye.app.files.csv_text import csv_text

if TYPE_CHECKING:
    from catseye.app.cell.load import LoadedCell
    from catseye.app.cluster.share import Share
    from catseye.app.results.scara.design.design import Design, Wanted
    from catseye.app.results.scara.design.problem import Problem
    from catseye.calibration.scara.points import Commands

DesignCell = Annotated[
    Path, typer.Option("--cell", help="cell file: arm, limits, optics, nodes, uncertainty")
]
Reflectors = Annotated[int, typer.Option(min=1, max=8, help="number of reflectors to place")]
Criterion = Annotated[
    Literal["A", "D", "E", "path"],
    typer.Option(
        help="what to minimise: mean variance (A), volume (D), worst combination (E) or largest "
        "uncertainty on --path (path)"
    ),
]
CriterionPath = Annotated[Path | None, typer.Option(help="path file (CSV or TOML) for the criterion path")]
Floor = Annotated[
    str | None, typer.Option(metavar="X0,X1,Y0,Y1", help="floor on which reflectors may stand, mm")
]
Places = Annotated[int, typer.Option(min=10, max=5000, help="number of candidate places")]
KeepOut = Annotated[
    float | None,
    typer.Option(
        metavar="MM",
        min=0.0,
        help="radius about J1 that stays free of reflectors [reach of the arm and of what turns with J4]",
    ),
]
Apart = Annotated[float, typer.Option(metavar="MM", min=0.0, help="smallest distance between two reflectors")]
Breaks = Annotated[int, typer.Option(min=0, help="how often the beam to a reflector may be interrupted")]
RandomOnly = Annotated[
    bool, typer.Option("--random-only", help="leave systematic contributors out of the criterion")
]
HowMany = Annotated[
    int | None, typer.Option(metavar="N", min=1, help="choose this many of the cell file's commands")
]
Minutes = Annotated[
    float | None, typer.Option(metavar="T", min=0.0, help="choose as many commands as fit into this time")
]
Pareto = Annotated[
    bool, typer.Option("--pareto", help="weigh bench time against uncertainty for 1 to 4 reflectors")
]
Page = Annotated[Path | None, typer.Option("-o", "--output", help="HTML page to write, with figures")]
NewCell = Annotated[Path | None, typer.Option(help="cell file to write, with the reflectors found")]
NewCommands = Annotated[
    Path | None, typer.Option(help="path CSV to write, with the commands chosen, in measuring order")
]
Starts = Annotated[int, typer.Option(min=0, help="seed of the random starts")]


def design(
    cell: DesignCell,
    reflectors: Reflectors = 3,
    criterion: Criterion = "A",
    path: CriterionPath = None,
    floor: Floor = None,
    places: Places = 400,
    keep_out: KeepOut = None,
    apart: Apart = 100.0,
    breaks: Breaks = 4,
    random_only: RandomOnly = False,
    commands: HowMany = None,
    minutes: Minutes = None,
    pareto: Pareto = False,
    output: Page = None,
    write_cell: NewCell = None,
    write_commands: NewCommands = None,
    seed: Starts = 1,
    workers: Workers = 1,
    dask: Dask = None,
    insecure_cluster: InsecureCluster = False,
    as_json: AsJson = False,
) -> None:
    """Find the best places for the reflectors. Also chooses commands and estimates uncertainty and time.

    Example: catseye design --cell cell.toml --reflectors 3 -o design.html
    """
    from catseye.app.cell.bench import scara_bench_of
    from catseye.app.cell.load import load_cell
    from catseye.app.render.page import write_page
    from catseye.app.results.scara.design.design import Wanted
    from catseye.app.results.scara.design.document import design_document
    from catseye.app.results.scara.design.problem import Wish, problem_of
    from catseye.app.results.scara.design.report import design_report

    for file in (output, write_cell, write_commands):
        require_output(file, cell, path)
    _require_consistent(criterion, path, commands, minutes, write_commands)
    loaded = load_cell(cell)
    on_path = None if path is None else _commands_of(path, loaded)
    wish = Wish(criterion, on_path, _rectangle(floor), keep_out, apart, breaks, not random_only)
    wanted = Wanted(reflectors, places, seed, commands, minutes, pareto)
    problem = problem_of(scara_bench_of(loaded.cell), loaded.cell.uncertainty.budget, wish)
    with sharing(workers, dask, insecure=insecure_cluster) as share:
        designed = _designed(problem, wanted, share)
    report = design_report(designed, loaded.cell.name)
    if output is not None:
        write_page(report, output)
        note(f"{output} written")
    if write_cell is not None:
        _write_cell(designed, loaded, write_cell)
    if write_commands is not None:
        _write_commands(designed, write_commands)
    if as_json:
        write_document("design", design_document(designed).json_object())
    else:
        write_tables(report)
    note_statements(report)


def _designed(problem: "Problem", wanted: "Wanted", share: "Share") -> "Design":
    """Return the design; each part of the work has a bar of its own."""
    from catseye.app.results.scara.design.design import design

    bars: dict[str, ProgressBar] = {}

    def done(part: float, of: float, text: str) -> None:
        bars.setdefault(text, ProgressBar(text)).update(part, of, f"{part:g} of {of:g}")

    designed = design(problem, wanted, share, done)
    for bar in bars.values():
        bar.close()
    return designed


def _require_consistent(
    criterion: str, path: Path | None, commands: int | None, minutes: float | None, chosen: Path | None
) -> None:
    if path is not None and criterion != "path":
        raise UsageError("--path belongs to --criterion path; give both or neither")
    if commands is not None and minutes is not None:
        raise UsageError("give either --commands or --minutes: each of them chooses the commands")
    if chosen is not None and commands is None and minutes is None:
        raise UsageError("--write-commands writes a choice of commands: add --commands N or --minutes T")


def _rectangle(text: str | None) -> tuple[float, float, float, float] | None:
    if text is None:
        return None
    try:
        x0, x1, y0, y1 = (float(part) for part in text.split(","))
    except ValueError:
        x0 = math.nan
    if not math.isfinite(x0) or not all(math.isfinite(value) for value in (x1, y0, y1)):
        raise UsageError(f"--floor {text}: give four numbers in mm, as X0,X1,Y0,Y1: --floor 550,900,-600,600")
    return x0, x1, y0, y1


def _commands_of(path: Path, loaded: "LoadedCell") -> "Commands":
    from catseye.app.cell.bench import scara_sections
    from catseye.app.results.scara.path_csv import read_path_csv

    links_mm = scara_sections(loaded.cell, "catseye design").robot.links_mm
    return read_path_csv(path, links_mm).commands


def _write_cell(design: "Design", loaded: "LoadedCell", file: Path) -> None:
    import numpy as np

    from catseye.app.cell.load import load_cell
    from catseye.app.cell.rewriting import with_reflector_tables
    from catseye.app.protocol.procedures import analysed_by

    reflectors = [
        (f"P{k}", float(s.xy_mm[0]), float(s.xy_mm[1]), round(float(np.rad2deg(s.facing_rad)), 1))
        for k, s in enumerate(design.layout.sights, 1)
    ]
    write_users_file(file, with_reflector_tables(loaded.path, reflectors))
    load_cell(file)
    next_run = analysed_by("identify")[0].name
    note(f"{file} written. Next: catseye run {next_run} --cell {file} --dry-run")


def _write_commands(design: "Design", file: Path) -> None:
    from catseye.app.results.scara.path_csv import DIRECTIONS, JOINTS

    if design.choice is None:
        return
    rows = (design.problem.sequence[k] for k in design.choice.kept.nonzero()[0])
    cells = ([f"{o.theta1_deg:g}", f"{o.theta2_deg:g}", o.direction1, o.direction2] for o in rows)
    write_atomically(file, csv_text([*JOINTS, *DIRECTIONS], cells))
    note(f"{file} written")
