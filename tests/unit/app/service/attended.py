"""A run as those see it who only hear of it, and a clock that a test moves on."""

from pathlib import Path
from typing import Any, cast

from catseye.app.engine.control import RunControl
from catseye.app.engine.handle import RunHandle


def handle_with(warnings: list[str]) -> RunHandle:
    """Return a handle whose warnings are collected."""
    control = cast(RunControl, None)
    return RunHandle(Path("runs/r1"), "search", "Search", control, _no_note, warnings.append)


def _no_note(_kind: str, _data: Any) -> None:
    raise AssertionError("nothing is noted")
