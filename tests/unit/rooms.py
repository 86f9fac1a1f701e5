"""The rooms that docs/architecture.md names, and which of them import which, read from the source.

`python -m tests.unit.rooms` prints the drawing of the page.
"""

import ast
import re
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path
from typing import Final

import catseye

ROOT: Final = Path(__file__).parents[2]
SOURCE: Final = Path(catseye.__path__[0])
"""Holds the rooms in a checkout and in an unpacked sdist."""

PAGE: Final = ROOT / "docs" / "architecture.md"
TOPS: Final = ("app", "calibration", "drivers", "procedures", "simulators")

Arrows = Mapping[str, frozenset[str]]
"""Of each room, the rooms that it imports."""

_NAME: Final = re.compile(r"`([a-z_.]+)`")


def permitted() -> dict[str, frozenset[str]]:
    """Return what each room may import, in the order of the page's table: from the top of the house down."""
    table = PAGE.read_text("utf-8").partition("| room |")[2].partition("\n\n")[0]
    rows = [line.split("|") for line in table.splitlines() if line.startswith("| `")]
    return {_NAME.findall(row[1])[0]: frozenset(_NAME.findall(row[3])) for row in rows}


def room_of(module: str, rooms: Mapping[str, object]) -> str:
    """Return the room of a module: the longest name that it begins with.

    Raises:
        LookupError: it stands in no room of the page.
    """
    parts = module.split(".")
    for length in range(len(parts), 0, -1):
        if (name := ".".join(parts[:length])) in rooms:
            return name
    raise LookupError(f"{module} stands in no room of {PAGE.name}")


@cache
def imported() -> dict[str, frozenset[str]]:
    """Return which room imports which, imports within functions and for types included."""
    rooms = permitted()
    found: dict[str, set[str]] = {room: set() for room in rooms}
    for module, path in _modules():
        for name in _imports(path):
            found[room_of(module, rooms)].add(room_of(name, rooms))
    return {room: frozenset(others - {room}) for room, others in found.items()}


def drawing(arrows: Arrows) -> str:
    """Return the arrows as a Mermaid flowchart; one that follows from others is left out.

    Raises:
        graphlib.CycleError: they form a circle.
    """
    below: dict[str, set[str]] = {}
    for room in TopologicalSorter(arrows).static_order():
        below[room] = set(arrows[room]).union(*(below[other] for other in arrows[room]))
    shown = (
        f"    {room} --> {other}"
        for room in arrows
        for other in arrows
        if other in arrows[room] and not any(other in below[between] for between in arrows[room])
    )
    return "\n".join(["flowchart TD", *shown])


def _modules() -> Iterator[tuple[str, Path]]:
    for top in TOPS:
        for path in sorted((SOURCE / top).rglob("*.py")):
            parts = path.relative_to(SOURCE).with_suffix("").parts
            yield ".".join(parts[:-1] if parts[-1] == "__init__" else parts), path


def _imports(path: Path) -> Iterator[str]:
    """Yield what of ours a module imports, without the name of the package in front."""
    own = f"{catseye.__name__}."
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        match node:
            case ast.ImportFrom(module=str(module)) if f"{module}.".startswith(own):
                # A package's name may be followed by that of a module.
                yield from (f"{module}.{alias.name}".removeprefix(own) for alias in node.names)
            case ast.Import():
                yield from (
                    alias.name.removeprefix(own) for alias in node.names if alias.name.startswith(own)
                )


if __name__ == "__main__":
    sys.stdout.write(f"{drawing(imported())}\n")
