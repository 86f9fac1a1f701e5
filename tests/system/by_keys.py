"""The whole measurement as a technician does it: by keys alone, reading the screen."""

import json
import re
import time
from pathlib import Path
from typing import Any, Protocol

from tests.patience import HANG_S

_TITLE = re.compile(r"─ The day ─+╮╭─ (.+?) ─")
"""Of the stage that is chosen, beside the day's list."""


class Console(Protocol):
    """A terminal with the user interface in it."""

    @property
    def text(self) -> str:
        """What stands on the screen now."""
        ...

    def press(self, *keys: str) -> None:
        """Press keys by their names, or characters."""
        ...

    def shows(self, *texts: str, limit_s: float = HANG_S) -> str:
        """Wait until all texts stand on the screen; return it."""
        ...


def measure_by_keys(screen: Console, run_limit_s: float) -> None:
    """Search the reflectors, measure, identify and look at the maps.

    Args:
        screen: shows the interface on an emulated bench, just started.
        run_limit_s: for each run.
    """
    screen.shows("SIMULATION", "IDLE")
    run_procedure(screen, "Reflector search", run_limit_s)
    run_procedure(screen, "Automated open-loop", run_limit_s)
    screen.press("f7")
    screen.shows("2 of 2 runs", "✓ complete")
    # The newest run stands first.
    screen.press("home", "i")
    screen.shows("Identify", "open-loop")
    screen.press("ctrl+s")
    screen.shows("identified;")
    screen.press("f6")
    screen.shows("result-", "error-map")
    screen.press("enter")
    screen.press("2")
    screen.shows("Δθ1 / mdeg", "Δθ2 / mdeg", "approached upwards")


def run_procedure(screen: Console, title: str, limit_s: float) -> None:
    """Choose a procedure, look at what begins, let the arm move and wait for the end."""
    screen.press("f3")
    screen.shows("beam-level", "limits hold")
    choose(screen, title)
    screen.press("ctrl+s")
    screen.shows("F8", "default")
    # Enter is no answer to whether the arm may move.
    screen.press("enter")
    screen.shows("F8", "default")
    screen.press("f8")
    screen.shows("EXECUTE")
    screen.shows(" complete", limit_s=limit_s)


def choose(screen: Console, title: str) -> None:
    """Go down the day's list, and on from its top, to one of its procedures.

    No key is pressed before what the last one did stands on the screen, however long that takes.
    """
    shown = _next_title(screen, "")
    for _ in range(20):
        if shown.startswith(title):
            return
        screen.press("down")
        shown = _next_title(screen, shown)
    raise AssertionError(f"{title} is not in the list:\n{screen.text}")


def _next_title(screen: Console, before: str) -> str:
    """Wait until another procedure is shown than before; return its title."""
    end_s = time.monotonic() + HANG_S
    while (found := _TITLE.search(screen.text)) is None or found[1] == before:
        assert time.monotonic() < end_s, f"no other procedure than {before!r} is shown:\n{screen.text}"
        time.sleep(0.05)
    return found[1]


def result_of(folder: Path) -> dict[str, Any]:
    """Return the result file that was written."""
    (path,) = folder.glob("result-*.json")
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found
