"""Looking at a cell and its runs: what can be run, what it needs, which stages the day has."""

from abc import abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING, Final

from catseye.app.tui.screens.rehearsing import RehearsingScreen
from catseye.app.tui.session import Session

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.commands import CommandEvent
    from catseye.app.results.readiness.survey_document import SurveyDocument

_LOOKING: Final = "reading cell and runs …"


class SurveyingScreen(RehearsingScreen):
    """Has `catseye procedures` look, and keeps what it says."""

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._survey: SurveyDocument | None = None
        self._looking = False
        self._looked = _LOOKING
        self._named: set[str] = set()

    @property
    def _cell_name(self) -> str:
        return "" if self._survey is None else self._survey.cell

    async def survey(self) -> None:
        """Look at the cell and its runs; the engine says whether there is an alarm."""
        cell = self.session.cell
        where: tuple[str | Path, ...] = ()
        if cell is not None:
            where = ("--cell", cell, "--runs", self.session.root, "--offline", *self._campaign())
        self._looking, self._looked = True, _LOOKING
        self.say(_LOOKING)
        if self._survey is None:
            self.run_worker(self._list(), group="list", exclusive=True, exit_on_error=False)
        done = await self.session.work.do("procedures", *where, "--json", heard=self._hear)
        self._looking = False
        self.say("")
        if done.code:
            # What was known before does not hold any more.
            self._survey = None
            self.show_fault(done.fault)
            return
        from catseye.app.results.readiness.survey_document import SurveyDocument

        self._survey = SurveyDocument.of_lines(done.out)
        self._name_broken(done.warnings)
        self.show_survey()

    def _name_broken(self, warnings: tuple[str, ...]) -> None:
        """Say once what cannot be loaded and is left out."""
        for text in warnings:
            if text not in self._named:
                self._named.add(text)
                self.notify(text, title="left out", severity="warning", timeout=20.0, markup=False)

    def _campaign(self) -> tuple[str | Path, ...]:
        """Return the words for the campaign whose stages are the day's."""
        campaign, job = self.session.campaign, self.session.job
        if campaign is None:
            return ()
        return ("--campaign", campaign, *(("--job", job) if job else ()))

    @abstractmethod
    def show_survey(self) -> None:
        """Show the day and all procedures."""

    @abstractmethod
    def show_listed(self) -> None:
        """Show what can be run before the next step is known."""

    @abstractmethod
    def show_looked(self) -> None:
        """Show how far cell and runs have been looked at."""

    @abstractmethod
    def show_fault(self, fault: str) -> None:
        """Show why nothing is known of the cell."""

    def _hear(self, event: "CommandEvent") -> None:
        """Show how far the plans have been tried: some take seconds."""
        if event.kind == "progress":
            self._looked = f"{_LOOKING} {event.text}"
            self.say(self._looked)
            self.show_looked()

    async def _list(self) -> None:
        """Show what can be run while it is looked at what the cell is ready for: every plan is tried for that."""
        done = await self.session.work.do("procedures", "--json")
        if done.code or self._survey is not None or not self._looking:
            return
        from catseye.app.results.readiness.survey_document import SurveyDocument

        self._survey = SurveyDocument.of_lines(done.out)
        self.show_listed()
