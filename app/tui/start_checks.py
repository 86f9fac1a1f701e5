"""What is looked at beside the first screen: a user's keys and the cell file."""

import asyncio
import difflib
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from app.tui.app import CatseyeApp


async def tell_what_is_wrong(app: "CatseyeApp", names: frozenset[str]) -> None:
    """Tell of names in `keys.toml` that nothing has, and of a cell file that cannot be used.

    Args:
        app: the program.
        names: in a user's `keys.toml`.
    """
    if names and (fault := await asyncio.to_thread(unknown_names, names)):
        app.tell_error("Names in keys.toml that nothing has", fault)
    cell = app.session.cell
    if cell is not None and (fault := await asyncio.to_thread(cell_fault, cell)):
        app.tell_error(
            "The cell file cannot be used", f"{fault}\nSet-up (F10, c) shows its values and mends them."
        )


def unknown_names(names: frozenset[str]) -> str:
    """Return a line for each name that no key of the program has; it imports all screens."""
    from app.tui.key_table import key_table

    known = {key.name for key in key_table()}
    lines = []
    for name in sorted(names - known):
        near = difflib.get_close_matches(name, known, n=1, cutoff=0.4)
        lines.append(f"{name}: no such name" + (f"; did you mean {near[0]}?" if near else ""))
    return "\n".join([*lines, "docs/terminal-ui.md lists all names."]) if lines else ""


def cell_fault(path: Path) -> str:
    """Return why a cell file cannot be used; empty when it can, or when it is not there."""
    from app.cell.load import load_cell
    from app.errors import ConfigError

    try:
        if path.is_file():
            load_cell(path)
    except ConfigError as error:
        return str(error)
    return ""
