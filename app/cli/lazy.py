"""A group of commands that imports a command only when it is called."""

from collections.abc import Callable
from functools import cache
from importlib import import_module
from typing import Any

import typer
from typer.core import TyperGroup

from catseye.app.cli.commands import COMMANDS


class LazyGroup(TyperGroup):
    """Holds a stub for each command; the command itself replaces it once it is called or its options are completed.

    Help, completion of names and "did you mean" need no more than the stubs.
    """

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        """Return name, command and remaining arguments; this imports the command's module."""
        name, stub, rest = super().resolve_command(ctx, args)
        return name, stub if name is None else load_command(name), rest


def add_commands(cli: typer.Typer) -> None:
    """Register a stub for each command, with the summary that the help shows for it."""
    for name, command in COMMANDS.items():
        cli.command(name, help=command.summary)(_stub)


def declaration_of(name: str) -> Callable[..., None] | typer.Typer:
    """Return what the command's module declares: a function, or a Typer with commands of its own."""
    python_name = name.replace("-", "_")
    declared: Callable[..., None] | typer.Typer = getattr(
        import_module(f"{COMMANDS[name].package}.{python_name}"), python_name
    )
    return declared


def load_command(name: str) -> Any:
    """Return the command of this name, ready to be called."""
    declared = declaration_of(name)
    if not isinstance(declared, typer.Typer):
        function, declared = declared, typer.Typer(add_completion=False, rich_markup_mode=None)
        declared.command(name)(function)
    command = typer.main.get_command(declared)
    command.name = name
    return command


@cache
def options_of_command(name: str) -> frozenset[str]:
    """Return the options of a command, with their dashes."""
    return frozenset(option for each in load_command(name).params for option in each.opts)


def _stub() -> None:
    raise NotImplementedError("a stub is never called")
