"""A kind of results that the screen Results shows by the sections of its report; no widget in here."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from catseye.app.protocol.banners import SIMULATION
from catseye.app.results.model import Report
from catseye.app.results.provenance import Provenance
from catseye.app.results.result_files import ResultFile
from catseye.app.service.command_process import command_line

Words = tuple[str, ...]


# Each kind knows the type of its results.
@dataclass(frozen=True)
class ReportKind:
    """How results of one kind are listed and shown.

    Attributes:
        view: id of the widget that shows them.
        holds: type of the results.
        row: returns kind, size and quality of a result, for the row of its file.
        heading: returns what is said of a result behind the name of its file.
        steps: commands that go on from a result and its file: what each gives, and its words.
        files: returns the files that its report is made from, of a path and its result.
        report: makes the report of such files.
    """

    view: str
    holds: type[Any]
    row: Callable[[Any], tuple[str, str, str]]
    heading: Callable[[Any], Sequence[str]]
    steps: Callable[[Path, Any], Sequence[tuple[str, Words]]]
    files: Callable[[Path, Any], list[Path]]
    report: Callable[[list[Path]], Report]

    def row_of(self, file: ResultFile[Any]) -> list[str]:
        """Return what the row of a file says: name, kind, size, quality, simulated, time."""
        simulated = {True: "SIM", False: "", None: "?"}[_simulated(file.result)]
        return [file.path.name, *self.row(file.result), f" {simulated}", f"{file.changed_utc:%m-%d %H:%M}"]

    def heading_of(self, file: ResultFile[Any]) -> str:
        """Return which result is shown."""
        simulated = {True: SIMULATION, False: "", None: "simulated or not: not known"}
        parts = [file.path.name, *self.heading(file.result), simulated[_simulated(file.result)]]
        return " · ".join(part for part in parts if part)

    def commands(self, file: ResultFile[Any]) -> str:
        """Return the commands that go on from a result, with the names that the user has to give."""
        steps = self.steps(file.path, file.result)
        return "\n\n".join(f"{what}\n  {command_line(words)}" for what, words in steps)


def _simulated(result: Any) -> bool | None:
    provenance: Provenance | None = result.provenance
    return None if provenance is None else provenance.simulated
