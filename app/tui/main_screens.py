"""The main screens: name, key, title; each is imported when it is shown for the first time."""

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class MainScreenEntry:
    """A main screen.

    Attributes:
        key: that shows it.
        title: in the footer.
        tooltip: in help and palette.
        where: module and class.
    """

    key: str
    title: str
    tooltip: str
    where: str


MAIN_SCREENS: Final = {
    "bench": MainScreenEntry("f2", "Bench", "devices, arm, beam and air at present", "bench:BenchScreen"),
    "procedures": MainScreenEntry(
        "f3", "Procedures", "what can be done, and what comes next", "procedures:ProceduresScreen"
    ),
    "run": MainScreenEntry("f4", "Run", "the run under way: steps, questions, live values", "run:RunScreen"),
    "jog": MainScreenEntry("f5", "Jog", "move joints and beam by hand", "jog:JogScreen"),
    "results": MainScreenEntry("f6", "Results", "error maps, validation, residuals", "results:ResultsScreen"),
    "runs": MainScreenEntry("f7", "Runs", "history: resume, verify, report", "runs:RunsScreen"),
    "terminal": MainScreenEntry("f9", "Terminal", "raw traffic of each link", "terminal:TerminalScreen"),
    "setup": MainScreenEntry(
        "f10", "Set-up", "make or change the cell file by questions", "setup:SetupScreen"
    ),
}
