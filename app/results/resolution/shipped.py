"""Recordings that come with the program: tests of every joint of an arm, made on its emulated bench and evaluated.

They stand in for tests that nobody made, and every one of them says that it is shipped. `make shipped-recordings`
makes them anew.
"""

from pathlib import Path
from typing import Final

from catseye.app.results.resolution.result import ResolutionResult, read_resolution

SHIPPED: Final = Path(__file__).parent / "shipped_recordings"


def shipped_file(arm: str, joint: str) -> Path:
    """Return where the result of a joint's shipped tests is kept."""
    return SHIPPED / f"{arm}-{joint}.json"


def shipped_results(arm: str) -> list[ResolutionResult]:
    """Return the shipped results of an arm, one a joint; none where nothing is shipped for it.

    Raises:
        UsageError: a file is no result: the installation is damaged.
    """
    return [read_resolution(path) for path in sorted(SHIPPED.glob(f"{arm}-*.json"))]
