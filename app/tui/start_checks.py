"""What is looked at beside the first screen: a user's keys and the cell file."""

import asyncio
import difflib
from pathlib import Path

from catseye.app.errors import ConfigError
from catseye.app.tui.key_table import key_table
from catseye.app.tui.program import Program


async def check_settings(app: Program, keymap: dict[str, str]) -> None:
    """Show names in `keys.toml` that nothing has, of keys that two things have, and of a cell file of no use.

    Args:
        keymap: a user's keys by name.
    """
    if keymap and (fault := await asyncio.to_thread(unknown_names, frozenset(keymap))):
        app.show_error("Unknown names in keys.toml", fault)
    if keymap and (fault := await asyncio.to_thread(key_clashes, keymap)):
        app.show_error("Keys in keys.toml that are assigned twice", fault)
    cell = app.session.cell
    if cell is not None and (fault := await asyncio.to_thread(cell_fault, cell)):
        app.show_error(
            "The cell file cannot be used",
            f"{fault}\nSet-up (F10, 2) shows its values and lets you correct them.",
        )


def unknown_names(names: frozenset[str]) -> str:
    """Return a line for each name that no key of the program has; it imports all screens."""
    known = {key.name for key in key_table()}
    lines = []
    for name in sorted(names - known):
        near = difflib.get_close_matches(name, known, n=1, cutoff=0.4)
        lines.append(f"{name}: no such name" + (f"; did you mean {near[0]}?" if near else ""))
    return "\n".join([*lines, "docs/terminal-ui.md lists all names."]) if lines else ""


def key_clashes(keymap: dict[str, str]) -> str:
    """Return a line for each key that a user gave to one thing and that something else has in the same place."""
    lines = []
    for own in (key for key in key_table() if key.name in keymap):
        given = set(keymap[own.name].split(",")) - set(own.keys.split(","))
        for other in key_table():
            near = other.where == own.where or "everywhere" in {other.where, own.where}
            both = given & set(keymap.get(other.name, other.keys).split(","))
            if near and other.name != own.name and both:
                lines.append(
                    f"{own.name} = {','.join(sorted(both))}: {other.name} ({other.where}) has it, too"
                )
    return "\n".join(dict.fromkeys(lines))


def cell_fault(path: Path) -> str:
    """Return why a cell file cannot be used; empty when it can, or when it is not there."""
    from catseye.app.cell.load import load_cell

    try:
        if path.is_file():
            load_cell(path)
    except ConfigError as error:
        return str(error)
    return ""
