"""What is sensible after a run has ended."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from catseye.app.protocol.procedures import declared_by

Kind = Literal["analyse", "report", "resume", "clear", "next"]


@dataclass(frozen=True)
class Advice:
    """One thing that can be done.

    Attributes:
        kind: which.
        text: what it is good for.
        command: words of `catseye` without the file that is written; empty where it is no command.
        writes: that file, if its name is free; None where nothing is written.
    """

    kind: Kind
    text: str
    command: tuple[str, ...] = ()
    writes: Path | None = None

    @property
    def name(self) -> str:
        """What it is called."""
        return self.command[0] if self.kind == "analyse" else self.kind


CLEAR = Advice("clear", "when the cause is found and removed")
"""Comes first after an abort, also where no run was: nothing begins before."""


def after_run(procedure: str, status: str, run: str, root: Path) -> list[Advice]:
    """Return what is sensible, the most sensible first.

    Results and reports go beside the folder of runs: a run's own folder is sealed.

    Args:
        status: complete, stopped, aborted or failed.
    """
    folder, run_id = root.absolute().parent, run.rpartition("_")[2]
    words = ("report", run, "--runs", str(root))
    report = Advice("report", "one page about this run", words, folder / f"report-{run_id}.html")
    if status != "complete":
        return [Advice("resume", f"go on where it ended: catseye resume {run_id}", ("resume", run)), report]
    declared = declared_by(procedure)
    analyses = [each for each in declared.analyses if each.writes_result] if declared else []
    if not analyses:
        return [Advice("next", "Procedures (F3) shows what comes next"), report]
    result = folder / f"result-{run_id}.json"
    return [
        *(
            Advice("analyse", each.gives, (each.command, run, "--runs", str(root)), result)
            for each in analyses
        ),
        report,
    ]
