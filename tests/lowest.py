"""Print the lower bounds of pyproject.toml as pins for pip: each dependency at the oldest version that it allows.

Run as `python -m tests.lowest`. What a dependency itself needs is left to pip, which takes the newest that fits.
"""

import re
import sys
import tomllib
from collections.abc import Iterable
from pathlib import Path

_BOUND = re.compile(r"([\w.-]+)>=([\w.]+)(?:,<[\w.]+)?")


def pins(bounds: Iterable[str]) -> list[str]:
    """Return `name==version` for each `name>=version`.

    Raises:
        ValueError: a requirement has no lower bound.
    """
    found = set()
    for bound in bounds:
        parts = _BOUND.fullmatch(bound)
        if parts is None:
            raise ValueError(f"{bound!r} in pyproject.toml has no lower bound: write name>=version")
        found.add(f"{parts[1]}=={parts[2]}")
    return sorted(found)


def main() -> None:
    """Print the pins of this checkout."""
    text = (Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8")
    project = tomllib.loads(text)["project"]
    extras = project["optional-dependencies"].values()
    bounds = [*project["dependencies"], *(bound for extra in extras for bound in extra)]
    sys.stdout.write("\n".join(pins(bounds)) + "\n")


if __name__ == "__main__":
    main()
