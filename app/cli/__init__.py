"""The `catseye` command. stdout carries data, stderr carries talk.

Each command imports what it needs when it runs: help and completion stay fast.
"""

import errno
import os
import signal
import sys
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from typer.core import TyperGroup

from catseye.app.analysis_cli import add_analysis
from catseye.app.cli.options import (
    Answers,
    Arm,
    AsJson,
    CellFile,
    DryRun,
    KeepDrives,
    Runs,
    Seed,
    Speed,
    Truth,
    Unverified,
    WaiveWalk,
)


class _Commands(TyperGroup):
    """Gives Ctrl-C, and a name that no file can have, an error of their own."""

    def invoke(self, ctx: Any) -> Any:
        """Run the chosen command."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as interrupt:
            from catseye.app.errors import InterruptedRunError

            raise InterruptedRunError("interrupted") from interrupt
        except OSError as error:
            if error.errno != errno.ENAMETOOLONG:
                raise
            from catseye.app.errors import UsageError

            name = f"{error.filename!s:.60}"
            raise UsageError(f"{name}…: is too long for the name of a file: check what was given") from error


cli = typer.Typer(
    name="catseye",
    cls=_Commands,
    help=(
        "Robot error maps by open-loop tracking laser interferometry.\n\n"
        "First steps: catseye demo, then catseye init cell.toml, catseye emulate cell.toml in one terminal and "
        "catseye doctor cell.toml in another.\n\n"
        "The software stop (Ctrl-C) is not an emergency stop: keep a hand on the real one."
    ),
    no_args_is_help=True,
    add_completion=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
config = typer.Typer(help="Check and show cell files.", no_args_is_help=True, rich_markup_mode=None)
cli.add_typer(config, name="config")


def _tell_version(wanted: bool) -> None:
    if wanted:
        from catseye.app.cli.output import emit
        from catseye.app.version import SOFTWARE

        emit(SOFTWARE)
        raise typer.Exit


@cli.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_tell_version, is_eager=True, help="Show the version and exit."),
    ] = False,
) -> None:
    # What the program is for is said above; `version` has been told by its callback.
    del version


@cli.command()
def demo(
    out: Annotated[Path, typer.Option(help="folder for everything that the demo writes")] = Path(
        "catseye-demo"
    ),
    speed: Speed = 400.0,
    seed: Seed = 2,
    truth: Truth = None,
    as_json: AsJson = False,
) -> None:
    """Do the whole job on emulated hardware over real sockets: search, measure, identify, validate, report.

    Example: catseye demo --out /tmp/demo --seed 7
    """
    from catseye.app.cli.demo import demo_command

    demo_command(out, speed, seed, truth, as_json)


@cli.command()
def init(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="cell file to write; never overwritten")],
) -> None:
    """Write a commented cell file for an RH-3FRH5515 with the paper's reflectors and commands.

    Example: catseye init cell.toml
    """
    from catseye.app.cli.config import init_command

    init_command(file)


@config.command("validate")
def config_validate(file: CellFile, as_json: AsJson = False) -> None:
    """Check a cell file; every fault is listed with file, line, key and the nearest valid key."""
    from catseye.app.cli.config import validate_command

    validate_command(file, as_json)


@config.command("show")
def config_show(file: CellFile, as_json: AsJson = False) -> None:
    """Show a cell file resolved: each value and whether it comes from the file or is a default."""
    from catseye.app.cli.config import show_command

    show_command(file, as_json)


@config.command("schema")
def config_schema(
    file: Annotated[
        Path | None, typer.Argument(metavar="[FILE]", help="a cell file; one schema fits all")
    ] = None,
) -> None:
    """Print the JSON schema of the cell file on stdout, for editors."""
    from catseye.app.cli.config import schema_command

    schema_command(file)


@cli.command()
def emulate(
    file: CellFile,
    speed: Speed = 1.0,
    seed: Seed = 2,
    truth: Truth = None,
    axes: Annotated[
        int, typer.Option(help="axes in the controller's answers: 4, or 6 or 8 for clients that need them")
    ] = 4,
    suffix: Annotated[
        str, typer.Option(help="end of the controller's answers on TCP: none, cr, crlf")
    ] = "none",
    unaligned: Annotated[
        bool, typer.Option("--unaligned", help="the beam lies as it was mounted: beside the J4 axis, tilted")
    ] = False,
    screw_sense: Annotated[
        str, typer.Option(help="screws act as the cell file says (normal), or the other way (reversed)")
    ] = "normal",
    end_with_stdin: Annotated[
        bool, typer.Option(help="end when stdin closes, for programs that start it")
    ] = False,
) -> None:
    """Emulate every device of a cell file on its endpoints until Ctrl-C.

    One JSON line per endpoint is printed when it is ready; port 0 picks a free port.

    Example: catseye emulate cell.toml --speed 50
    """
    from catseye.app.cli.emulate import emulate_command

    emulate_command(
        file,
        speed,
        seed,
        truth,
        axes=axes,
        suffix=suffix,
        unaligned=unaligned,
        screw_sense=screw_sense,
        end_with_stdin=end_with_stdin,
    )


@cli.command()
def doctor(
    file: CellFile,
    device: Annotated[str | None, typer.Option(help="only this device, by its name in the cell file")] = None,
    as_json: AsJson = False,
) -> None:
    """Connect to each device of a cell file: who answers, its status, what is wrong and what to do."""
    from catseye.app.service.examination import doctor_command

    doctor_command(file, device, as_json)


@cli.command()
def terminal(
    device: Annotated[
        str, typer.Argument(help="robot, interferometer, environment, tracker or the name of a [[device]]")
    ],
    cell: Annotated[Path, typer.Option(help="cell file")],
    eol: Annotated[
        Literal["cr", "lf", "crlf", "none"] | None,
        typer.Option(help="put behind each line that is sent [crlf; with --hex: none]"),
    ] = None,
    as_hex: Annotated[bool, typer.Option("--hex", help="input is hex bytes, such as 31 3b 0d")] = False,
    log: Annotated[Path | None, typer.Option(help="file that gets the same lines, appended")] = None,
    wait: Annotated[
        float, typer.Option(min=0.0, help="end when the input has ended and nothing came for so long, s")
    ] = 1.0,
    arm: Annotated[
        str | None, typer.Option(metavar="CELL", help="cell name, typed to let input pass to the robot")
    ] = None,
) -> None:
    r"""Show the raw traffic of a device in hex and text, and send what is typed.

    Escapes in the input: \r \n \t \e \xNN. What comes unasked is shown as it comes. Ctrl-C ends.

    Example: catseye terminal interferometer --cell cell.toml --eol crlf --log counter.log
    """
    from catseye.app.cli.terminal import terminal_command

    terminal_command(device, cell, eol, as_hex, log, wait, arm)


@cli.command()
def procedures(
    cell: Annotated[
        Path | None, typer.Option(help="cell file: say what each needs there, and what comes next")
    ] = None,
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """List what can be run, with parameters, units and ranges; of a cell, what is needed and what comes next.

    Example: catseye procedures --cell cell.toml
    """
    from catseye.app.cli.procedures import procedures_command

    procedures_command(cell, runs, as_json)


@cli.command()
def run(
    procedure: Annotated[str, typer.Argument(help="see: catseye procedures")],
    cell: Annotated[Path, typer.Option(help="cell file")],
    param: Annotated[list[str] | None, typer.Option(metavar="K=V", help="parameter; may be repeated")] = None,
    search: Annotated[
        str, typer.Option(help="aim: auto (newest search of this cell), none, or a run")
    ] = "auto",
    answers: Answers = None,
    arm: Arm = None,
    speed: Speed = 1.0,
    keep_drives: KeepDrives = False,
    dry_run: DryRun = False,
    walk: Annotated[
        bool,
        typer.Option(
            "--walk", help="walk its motions through: slowly, nothing measured, while the space bar is held"
        ),
    ] = False,
    waive_walk: WaiveWalk = None,
    detach: Annotated[
        bool, typer.Option("--detach", help="let it run on by itself; catseye attach joins it")
    ] = False,
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """Run a procedure headless. Ctrl-C: once holds, twice stops, three times aborts. This is no emergency stop.

    With --walk the arm moves while the space bar is held and stops when it is let go. That is no enabling device.

    Example: catseye run open-loop --cell cell.toml --dry-run
    """
    from catseye.app.cli.drive import DriveOptions
    from catseye.app.cli.run import Asked, detached_command, run_command
    from catseye.app.errors import UsageError

    if detach and walk:
        raise UsageError("a walk needs somebody at its keys: leave --detach out")
    asked = Asked(procedure, cell, param or [], search)
    options = DriveOptions(answers, arm, speed, keep_drives, waive_walk, as_json)
    if detach and not dry_run:
        detached_command(asked, options, runs)
    run_command(asked, options, runs, dry_run=dry_run, walk=walk)


@cli.command()
def engine(
    cell: Annotated[Path, typer.Option(help="cell file")],
    wait_for_client: Annotated[
        float | None,
        typer.Option(min=0.0, metavar="S", help="idle without any client for so long, s, it ends [never]"),
    ] = None,
    once: Annotated[
        bool, typer.Option("--once", hidden=True, help="do what a line of stdin asks for")
    ] = False,
    runs: Runs = None,
) -> None:
    """Run an engine of its own process: idle until a client starts a procedure, it outlives clients and terminal.

    Its socket is told on stdout when it is ready; docs/engine.md describes the messages.

    Example: catseye engine --cell cell.toml
    """
    from catseye.app.cli.detached_engine import engine_command

    engine_command(cell, runs, wait_for_client, once)


@cli.command()
def attach(
    run: Annotated[
        str | None,
        typer.Argument(metavar="[RUN]", help="path, name, beginning of a name, or id [the only one]"),
    ] = None,
    control: Annotated[
        bool, typer.Option("--control", help="steer the run and answer its questions")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="take control from whoever has it")] = False,
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """Join a run that is under way: watch it, or steer it. Ends with the run's exit code.

    Ctrl-C leaves; with control it holds the run, twice stops it. A terminal that dies with control leaves the run
    held, or as [engine] on_client_lost says. This is no emergency stop.

    Example: catseye attach 1a2b3c --control
    """
    from catseye.app.cli.attach import attach_command

    attach_command(run, runs, control=control, force=force, as_json=as_json)


@cli.command()
def tui(
    cell: Annotated[
        Path | None, typer.Option(help="cell file [the only one in this folder, else set-up]")
    ] = None,
    speed: Speed = 1.0,
    runs: Runs = None,
) -> None:
    """Show the terminal user interface. It joins the engine that is running, or starts one.

    Example: catseye tui --cell cell.toml
    """
    from catseye.app.tui.start import tui_command

    tui_command(cell, runs, speed)


@cli.command()
def resume(
    run: Annotated[str, typer.Argument(metavar="RUN", help="path, name, beginning of a name, or id")],
    cell: Annotated[
        Path | None, typer.Option(metavar="FILE", help="cell file with other endpoints or time-outs")
    ] = None,
    answers: Answers = None,
    arm: Arm = None,
    speed: Annotated[
        float | None,
        typer.Option(min=0.001, max=1e6, help="bench seconds in one real second; emulators only [as before]"),
    ] = None,
    keep_drives: KeepDrives = False,
    dry_run: DryRun = False,
    waive_walk: WaiveWalk = None,
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """Go on with a run that stopped, failed, was aborted or died; steps that are done are not repeated.

    Everything is taken from the run itself; the operator is asked what may have changed meanwhile.

    Example: catseye resume 1a2b3c
    """
    from catseye.app.cli.drive import DriveOptions
    from catseye.app.cli.resume import resume_command

    options = DriveOptions(answers, arm, speed, keep_drives, waive_walk, as_json)
    resume_command(run, cell, options, runs, dry_run=dry_run)


@cli.command("runs")
def list_runs_(runs: Runs = None, as_json: AsJson = False) -> None:
    """List the stored runs, oldest first."""
    from catseye.app.cli.runs import runs_command

    runs_command(runs, as_json)


@cli.command()
def show(
    run: Annotated[str, typer.Argument(metavar="RUN", help="path, name, beginning of a name, or id")],
    runs: Runs = None,
    unverified: Unverified = False,
    as_json: AsJson = False,
) -> None:
    """Tell a run's story: what, with which devices, what happened, how it ended."""
    from catseye.app.cli.runs import show_command

    show_command(run, runs, as_json, unverified)


@cli.command()
def verify(
    run: Annotated[str, typer.Argument(metavar="RUN", help="path, name, beginning of a name, or id")],
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """Check a stored run against its manifest and its own rules."""
    from catseye.app.cli.runs import verify_command

    verify_command(run, runs, as_json)


add_analysis(cli)


def main() -> None:
    """Run the command line; every error becomes a sentence on stderr and an exit code."""
    # The matrices are small: threads of the linear algebra would wait for one another and for busy cores.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    try:
        cli()
    except (Exception, KeyboardInterrupt) as error:  # noqa: BLE001  # the outermost frame tells and ends the process
        # The process is ending anyway; another Ctrl-C must not cut the sentence short.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        from catseye.app.cli.failure import tell

        sys.exit(tell(error))
