"""A cell file with other reflectors; everything else, comments included, stays as it is."""

import re
from pathlib import Path

from catseye.app.errors import ConfigError
from catseye.app.files.documents import read_text

_HEADER = re.compile(r"\s*\[")
_REFLECTOR = re.compile(r"\s*\[\[\s*reflector\s*\]\]")


def with_reflector_tables(path: Path, reflectors: list[tuple[str, float, float, float]]) -> str:
    """Return the text of a cell file with its [[reflector]] tables replaced.

    Args:
        path: the cell file; it has passed every check.
        reflectors: name, x and y in mm, direction of the axis in deg.

    Raises:
        ConfigError: its reflectors do not stand in tables [[reflector]].
    """
    lines = read_text(path).splitlines()
    starts = [i for i, line in enumerate(lines) if _REFLECTOR.match(line)]
    if not starts:
        raise ConfigError(f"{path}: write its reflectors as tables [[reflector]]; only these can be replaced")
    kept = [True] * len(lines)
    for start in starts:
        for i in range(start, _end(lines, start)):
            kept[i] = False
    before = [line for line, keep in zip(lines[: starts[0]], kept, strict=False) if keep]
    after = [line for line, keep in zip(lines[starts[0] :], kept[starts[0] :], strict=True) if keep]
    tables = [line for reflector in reflectors for line in _table(*reflector)]
    # The first header keeps what is said beside it.
    return "\n".join([*before, lines[starts[0]], *tables[1:], *after, ""])


def _table(name: str, x_mm: float, y_mm: float, facing_deg: float) -> tuple[str, ...]:
    return (
        "[[reflector]]",
        f'name = "{name}"',
        f"x_mm = {x_mm}",
        f"y_mm = {y_mm}",
        f"facing_deg = {facing_deg}",
        "",
    )


def _end(lines: list[str], start: int) -> int:
    """Return the line after a table; comments right above the next header belong to that."""
    end = next((i for i in range(start + 1, len(lines)) if _HEADER.match(lines[i])), len(lines))
    if end < len(lines):
        while end > start + 1 and lines[end - 1].lstrip().startswith("#"):
            end -= 1
    return end
