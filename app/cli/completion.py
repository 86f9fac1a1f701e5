"""What TAB offers for arguments: names of procedures, runs, parameters and results.

A shell waits for every answer: each function imports what it needs alone, and whatever is wrong offers nothing.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer

from catseye.app.store.runs_folder import runs_folder

Offer = str | tuple[str, str]
"""A completion, or one with what it means."""


def procedures(incomplete: str) -> list[str]:
    """Offer the installed procedures."""
    from catseye.app.protocol.installed import procedure_names

    return [name for name in procedure_names() if name.startswith(incomplete)]


def campaigns(incomplete: str) -> list[str]:
    """Offer the campaigns that come with the program, and TOML files that a path so far leads to."""
    from catseye.app.campaign.load import shipped

    return [
        *(name for name in shipped() if name.startswith(incomplete)),
        *_files(incomplete, ".toml"),
    ]


def profiles(incomplete: str) -> list[str]:
    """Offer the profiles that drivers bring along."""
    from catseye.app.cell.profiles import profiles_by_driver

    return [name for name in profiles_by_driver() if name.startswith(incomplete)]


def documents(incomplete: str) -> list[str]:
    """Offer the documents that commands write for programs."""
    from catseye.app.cli.outputs import OUTPUTS

    return [name for name in OUTPUTS if name.startswith(incomplete)]


def stored_runs(ctx: typer.Context, incomplete: str) -> list[str]:
    """Offer the runs below --runs by name; by id what is the beginning of no name."""
    from catseye.app.errors import StorageError
    from catseye.app.store.run_names import run_folders

    try:
        found = run_folders(runs_folder(ctx.params.get("runs")))
    except StorageError:
        return []
    names = [path.name for path, _ in found if path.name.startswith(incomplete)]
    return names or [parts["id"] for _, parts in found if parts["id"].startswith(incomplete)]


def runs_and_results(ctx: typer.Context, incomplete: str) -> list[str]:
    """Offer runs, and JSON files that a path so far leads to."""
    return [*stored_runs(ctx, incomplete), *_files(incomplete, ".json")]


def runs_and_tables(ctx: typer.Context, incomplete: str) -> list[str]:
    """Offer runs, and CSV files that a path so far leads to."""
    return [*stored_runs(ctx, incomplete), *_files(incomplete, ".csv")]


def aims(ctx: typer.Context, incomplete: str) -> list[str]:
    """Offer what --search takes."""
    words = [word for word in ("auto", "none") if word.startswith(incomplete)]
    return [*words, *stored_runs(ctx, incomplete)]


def parameters(ctx: typer.Context, incomplete: str) -> list[Offer]:
    """Offer the parameters of the procedure; of one that is left, what it may be as well."""
    # Where the option still lacks its value, click leaves the arguments before it unassigned.
    procedure = ctx.params.get("procedure") or next(iter(ctx.args), "")
    schemas = _schemas(procedure)
    name, equals, _ = incomplete.partition("=")
    if equals:
        return list(_values(name, schemas.get(name, {})))
    left = [one for one in schemas if one.startswith(name)]
    offers: list[Offer] = [(f"{one}=", str(schemas[one].get("description", ""))) for one in left]
    return [*offers, *_values(left[0], schemas[left[0]])] if len(left) == 1 else offers


def _schemas(procedure: str) -> dict[str, dict[str, Any]]:
    """Return the JSON schema of each parameter; of an unknown procedure none."""
    from catseye.app.errors import UsageError
    from catseye.app.protocol.procedures import load_procedure

    try:
        schema = load_procedure(procedure).params_type.model_json_schema()
    except UsageError:
        return {}
    properties: dict[str, dict[str, Any]] = schema.get("properties", {})
    return properties


def _values(name: str, facts: dict[str, Any]) -> Iterator[str]:
    """Yield a parameter with each of its choices, or with its default."""
    from catseye.app.protocol.parameters import default_text

    choices = facts.get("enum") or (["false", "true"] if facts.get("type") == "boolean" else [])
    for value in choices or filter(None, [default_text(facts)]):
        yield f"{name}={value}"


def _files(incomplete: str, ending: str) -> list[str]:
    folder = Path(incomplete) if incomplete.endswith("/") else Path(incomplete).parent
    try:
        found = sorted(path for path in folder.iterdir() if path.suffix == ending)
    except OSError:
        return []
    return [str(path) for path in found if str(path).startswith(incomplete)]
