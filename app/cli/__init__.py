"""The `catseye` command. stdout carries data, stderr carries talk.

Each command is imported when it is called, and what it needs when it runs: help and completion stay fast.
"""

import errno
from typing import Annotated, Any

import typer

from catseye.app.cli.lazy import LazyGroup, add_commands


class _Commands(LazyGroup):
    """Gives Ctrl-C, and a name that no file can have, an error of their own; answers --json with JSON always."""

    def invoke(self, ctx: Any) -> Any:
        """Run the chosen command."""
        from catseye.app.cli.failure import failure_as_json

        with failure_as_json(as_json="--json" in ctx.args):
            return self._invoke(ctx)

    def _invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as interrupt:
            from catseye.app.errors import InterruptedRunError

            raise InterruptedRunError("interrupted") from interrupt
        except OSError as error:
            if error.errno == errno.EPIPE:
                # Typer would take it for stdout's, and end with the code of a rejected measurement.
                raise RuntimeError(f"a pipe broke: {error}") from error
            if error.errno != errno.ENAMETOOLONG:
                raise
            from catseye.app.errors import UsageError

            name = f"{error.filename!s:.60}"
            raise UsageError(f"{name}…: is too long for the name of a file: check what was given") from error


cli = typer.Typer(
    name="catseye",
    cls=_Commands,
    help=(
        "Measure the errors of industrial robots with laser instruments, with uncertainties.\n\nFirst steps: "
        "catseye demo, then catseye init cell.toml, catseye emulate cell.toml in one terminal and catseye doctor "
        "cell.toml in another.\n\nThe software stop (Ctrl-C) is not an emergency stop: keep a hand on the real "
        "one."
    ),
    no_args_is_help=True,
    add_completion=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
add_commands(cli)


def _show_version(wanted: bool) -> None:
    if wanted:
        from catseye.app.cli.output import write_line
        from catseye.app.store.software import SOFTWARE

        write_line(SOFTWARE)
        raise typer.Exit


@cli.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version and exit."),
    ] = False,
    login: Annotated[
        bool,
        typer.Option(
            "--login", help="Ask for user and password of controllers that need them; they are not stored."
        ),
    ] = False,
) -> None:
    # Its callback has shown it.
    del version
    if login:
        from catseye.app.cli.login import ask_logins

        ask_logins()
