"""The dossier of a cell as `catseye dossier --json` writes it."""

from pathlib import Path

from catseye.app.results.document import Document
from catseye.app.results.dossier.certificate import arm_text, figure_text, verdict
from catseye.app.results.dossier.day import Day
from catseye.app.results.model import Sign
from catseye.app.results.readiness.stages import State


class StagePart(Document):
    """A stage of the way.

    Attributes:
        name: of the procedure or command.
        state: done, next, later or left out.
        sign: how what it found is meant.
        figure: what it found, with expanded uncertainties (k = 2), or why it found nothing.
        runs: names of the runs that it was, or works on.
        files: that it gave.
        stale: newest complete run of a procedure that does not count any more; empty for none.
    """

    name: str
    state: State
    sign: Sign
    figure: str
    runs: tuple[str, ...]
    files: tuple[Path, ...]
    stale: str


class InstrumentPart(Document):
    """A device that answered."""

    name: str
    model: str
    serial: str
    firmware: str
    simulated: bool


class DossierDocument(Document):
    """The day of a cell.

    Attributes:
        page: the file that was written.
        cell: its name.
        arm: name of its arm.
        simulated: a device was an emulator.
        unverified: what speaks against runs that were changed after their end.
        sign: how the whole is meant.
        verdict: how far the day has come.
        stages: of its way, in order.
        instruments: that answered.
        software: that made the page.
        digests: SHA-256 of the files of the stages by name, and of each run's files by `run/file`.
    """

    page: Path
    cell: str
    arm: str
    simulated: bool
    unverified: tuple[str, ...]
    sign: Sign
    verdict: str
    stages: tuple[StagePart, ...]
    instruments: tuple[InstrumentPart, ...]
    software: str
    digests: dict[str, str]


def dossier_document(day: Day, page: Path) -> DossierDocument:
    """Return a day as plain values."""
    said, measurement = verdict(day), day.measurement
    of_runs = {f"{run.name}/{name}": digest for run in measurement.runs for name, digest in run.files.items()}
    return DossierDocument(
        page=page,
        cell=day.cell.name,
        arm=arm_text(day),
        simulated=day.origin.simulated,
        unverified=day.origin.unverified,
        sign=said.sign,
        verdict=said.text,
        stages=tuple(
            StagePart(
                name=one.stage.name,
                state=one.stage.state,
                sign=one.worth.sign,
                figure=figure_text(one),
                runs=one.runs,
                files=one.stage.files,
                stale=one.stale,
            )
            for one in day.stages
        ),
        instruments=tuple(map(InstrumentPart.model_validate, measurement.devices)),
        software=day.origin.software,
        digests={**day.sources.digests, **of_runs},
    )
