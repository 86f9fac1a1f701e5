"""design: where to put the reflectors, which commands to use."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from catseye.app.analysis.design_problem import Wish, problem_of
from catseye.app.analysis.designing import Design, Wanted, design
from catseye.app.cell.bench import bench_of
from catseye.app.cell.load import LoadedCell, load_cell
from catseye.app.cell.reflectors import with_reflector_tables
from catseye.app.cluster.sharing import sharing
from catseye.app.commands.design_words import tell_design
from catseye.app.commands.output import say
from catseye.app.commands.progress import ProgressBar
from catseye.app.errors import UsageError
from catseye.app.files.atomic import write_atomically
from catseye.app.files.csv_text import csv_text
from catseye.app.files.path_csv import DIRECTIONS, JOINTS, read_path_csv
from catseye.app.report.design_page import render_design
from catseye.calibration.core.design.criteria import CriterionName
from catseye.calibration.scara.points import Commands


@dataclass(frozen=True)
class DesignOptions:
    """What to design.

    Attributes:
        reflectors: how many to place.
        criterion: A, D, E or path.
        path: path CSV on which the uncertainty counts.
        floor: X0,X1,Y0,Y1 in mm.
        places: candidate places.
        pareto: work out bench time against uncertainty.
        seed: of the exchange's starts.
        workers: processes that share the work; 0 takes one a core.
        dask: address of a scheduler whose machines share it.
        keep_out_mm: radius about the J1 axis that is kept free; None for the reach and what turns with J4.
        apart_mm: smallest distance between two reflectors.
        breaks: how often the beam to a reflector may be given up.
        random_only: the criterion leaves out what does not average out.
        commands: how many commands to choose; None for all.
        minutes: bench time for which commands are chosen; None for any.
        insecure_cluster: the scheduler may be outside of this machine, and the connection without TLS.
    """

    reflectors: int = 3
    criterion: CriterionName = "A"
    path: Path | None = None
    floor: str | None = None
    places: int = 400
    pareto: bool = False
    seed: int = 1
    workers: int = 1
    dask: str | None = None
    keep_out_mm: float | None = None
    apart_mm: float = 100.0
    breaks: int = 4
    random_only: bool = False
    commands: int | None = None
    minutes: float | None = None
    insecure_cluster: bool = False


def design_command(
    cell: Path,
    options: DesignOptions,
    output: Path | None,
    write_cell: Path | None,
    as_json: bool,
    write_commands: Path | None = None,
) -> None:
    """Design a measurement, tell about it, and write what was asked for.

    Raises:
        UsageError: an option is wrong or cannot be met.
        UnidentifiableError: the commands leave parameters undetermined.
    """
    _require_consistent(options, write_commands)
    loaded = load_cell(cell)
    bench = bench_of(loaded.cell)
    wish = Wish(
        options.criterion,
        None if options.path is None else _path(options.path, loaded),
        _floor(options.floor),
        options.keep_out_mm,
        options.apart_mm,
        options.breaks,
        not options.random_only,
    )
    wanted = Wanted(
        options.reflectors, options.places, options.seed, options.commands, options.minutes, options.pareto
    )
    problem = problem_of(bench, loaded.cell.uncertainty.budget, wish)
    bars: dict[str, ProgressBar] = {}

    def done(part: float, of: float, text: str) -> None:
        bars.setdefault(text, ProgressBar(text)).update(part, of, f"{part:g} of {of:g}")

    with sharing(options.workers, options.dask, insecure=options.insecure_cluster) as share:
        found = design(problem, wanted, share, done)
    for bar in bars.values():
        bar.close()
    tell_design(found, as_json=as_json)
    _write(found, loaded, output, write_cell, write_commands)


def _require_consistent(options: DesignOptions, write_commands: Path | None) -> None:
    if options.path is not None and options.criterion != "path":
        raise UsageError("--path belongs to --criterion path; give both or neither")
    if options.commands is not None and options.minutes is not None:
        raise UsageError("give either --commands or --minutes: each of them chooses the commands")
    if write_commands is not None and options.commands is None and options.minutes is None:
        raise UsageError("--write-commands writes a choice of commands: add --commands N or --minutes T")


def _floor(text: str | None) -> tuple[float, float, float, float] | None:
    if text is None:
        return None
    try:
        x0, x1, y0, y1 = (float(part) for part in text.split(","))
    except ValueError:
        x0 = math.nan
    if not math.isfinite(x0) or not all(math.isfinite(value) for value in (x1, y0, y1)):
        raise UsageError(f"--floor {text}: give four numbers in mm, as X0,X1,Y0,Y1: --floor 550,900,-600,600")
    return x0, x1, y0, y1


def _path(path: Path, loaded: LoadedCell) -> Commands:
    robot = loaded.cell.robot
    return read_path_csv(path, (robot.link1_mm, robot.link2_mm)).commands


def _write(
    found: Design, loaded: LoadedCell, output: Path | None, cell: Path | None, commands: Path | None
) -> None:
    if output is not None:
        write_atomically(output, render_design(found, loaded.cell.name))
        say(f"{output} written")
    if cell is not None:
        reflectors = [
            (f"P{k}", float(s.xy_mm[0]), float(s.xy_mm[1]), round(float(np.rad2deg(s.facing_rad)), 1))
            for k, s in enumerate(found.layout.sights, 1)
        ]
        write_atomically(cell, with_reflector_tables(loaded.path, reflectors))
        load_cell(cell)
        say(f"{cell} written. Next: catseye run open-loop --cell {cell} --dry-run")
    if commands is not None and found.choice is not None:
        rows = (found.problem.sequence[k] for k in np.flatnonzero(found.choice.kept))
        cells = ([f"{o.theta1_deg:g}", f"{o.theta2_deg:g}", o.direction1, o.direction2] for o in rows)
        write_atomically(commands, csv_text([*JOINTS, *DIRECTIONS], cells))
        say(f"{commands} written")
