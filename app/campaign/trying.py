"""One try of a stage: its command in a process of its own."""

import asyncio
import signal
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Final, Protocol

from catseye.app.campaign.documents import DocumentOfRun, document_file, document_of
from catseye.app.campaign.driven_run import DrivenRun
from catseye.app.campaign.ending import Cause, Ending
from catseye.app.campaign.forecast import Rest
from catseye.app.campaign.holding import Holding
from catseye.app.campaign.job import Attempt, Job
from catseye.app.campaign.judging import not_done, of_exit
from catseye.app.campaign.load import LoadedCampaign
from catseye.app.campaign.model import StageEntry
from catseye.app.campaign.words import RUN, Wording, lacks_earlier
from catseye.app.engine.waiting import cancel
from catseye.app.exitcode import ExitCode
from catseye.app.files.atomic import write_atomically
from catseye.app.protocol.campaign_events import CampaignEvent, StageStarted, StageVerdict
from catseye.app.protocol.commands import CommandEvent
from catseye.app.protocol.events import AnyEvent, event_of
from catseye.app.protocol.message import MessageError, decode_object
from catseye.app.results.readiness.cell_runs import CellRun
from catseye.app.results.readiness.stages import CellStage
from catseye.app.service.command_process import Done, Signal, command_line
from catseye.drivers.roles.clock import Clock

_END_S: Final = 60.0
"""How long a run has to end, real s, where the job itself breaks off."""


class DoCommand(Protocol):
    """Runs a command in a process; see `catseye.app.service.command_process.do_command`."""

    async def __call__(
        self,
        words: tuple[str, ...],
        *,
        heard: Callable[[CommandEvent], None] | None = ...,
        told: Callable[[str], None] | None = ...,
        started: Callable[[Signal], None] = ...,
        end_by: int = ...,
        end_s: float = ...,
    ) -> Done:
        """Run a command to its end."""
        ...


@dataclass(frozen=True)
class Outlets:
    """Where a job's stages are shown, and their runs read.

    Attributes:
        do: runs a command.
        say: called with each event of the job.
        told: called with each event of a run.
        heard: called with what a command on stored data reports.
        document_of_run: returns what a run keeps, as `catseye show --json` writes it; blocks.
    """

    do: DoCommand
    say: Callable[[CampaignEvent], None]
    told: Callable[[AnyEvent], None]
    heard: Callable[[CommandEvent], None]
    document_of_run: DocumentOfRun


class Trying:
    """Tries stages of one job.

    Attributes:
        holding: which of them hold.
    """

    def __init__(
        self,
        loaded: LoadedCampaign,
        job: Job,
        wording: Wording,
        ending: Ending,
        outlets: Outlets,
        clock: Clock,
    ) -> None:
        self.holding = Holding(loaded, job)
        self._campaign = loaded.campaign
        self._job = job
        self._wording = wording
        self._ending = ending
        self._outlets = outlets
        self._clock = clock
        self._overdue = False
        self._left_to_people: Cause | None = None

    async def once(
        self,
        entry: StageEntry,
        stage: CellStage | None,
        results: tuple[str, ...],
        last: CellRun | None,
        rest: Rest,
    ) -> StageVerdict | None:
        """Try a stage; return why it failed, None where its command went well.

        Args:
            stage: as the day's list has it; None of one with a command of its own.
            results: that the way has led to.
            last: run of the stage; None before the first.
            rest: what is expected of it and of what comes after it.
        """
        words = self._words(entry, stage, results, last)
        if words is None:
            return not_done(entry, Cause("waits-for", "an earlier stage has not left what its command names"))
        if self._left_to_people is not None and words[0] == RUN:
            # A run that goes on asks somebody before anything moves; a new one would not.
            return not_done(entry, self._left_to_people)
        attempt = Attempt(
            place=self._job.next_place,
            command=command_line(words),
            work=self.holding.work(entry),
            started=self._now(),
        )
        self._job.began(entry.name, attempt)
        self._announce(entry, attempt, rest)
        if stage is not None and stage.procedure:
            done, text = await self._driven(entry, words)
        else:
            done = await self._done(entry, words, heard=self._outlets.heard)
            text = done.fault
        # What the limits judge is there before the try counts, and never that of an earlier one.
        document = document_file(self._job.folder, entry)
        document.unlink(missing_ok=True)
        if done.out:
            write_atomically(document, done.out)
        self._job.tried(
            entry.name,
            attempt.model_copy(update={"ended": self._now(), "exit_code": done.code, "text": text}),
        )
        return None if done.code == ExitCode.DONE else self._failure(entry, done.code, text)

    def document(self, entry: StageEntry, stage: CellStage | None) -> object:
        """Return what the limits of a stage judge: what its run keeps, the result it wrote, or what it said.

        Returns:
            None where there is nothing that can be read.
        """
        return document_of(entry, stage, self._outlets.document_of_run, self._job.folder)

    def _words(
        self,
        entry: StageEntry,
        stage: CellStage | None,
        results: tuple[str, ...],
        last: CellRun | None,
    ) -> tuple[str, ...] | None:
        if stage is None:
            return self._wording.of_own(entry, results)
        if stage.procedure:
            return self._wording.of_procedure(entry, stage, anew=not self._may_go_on(entry, last))
        return None if lacks_earlier(stage) else self._wording.of_data(entry, stage)

    def _may_go_on(self, entry: StageEntry, last: CellRun | None) -> bool:
        """Return whether an interrupted run is the job's own, of the campaign as it is now, and of use.

        A run whose measurement was rejected would be rejected by the same data again.
        """
        if last is None or last.job != self._job.record.job:
            return False
        tries = self._job.tries(entry.name)
        return not tries or (self.holding.is_same_work(entry) and tries[-1].exit_code != ExitCode.REJECTED)

    def _announce(self, entry: StageEntry, attempt: Attempt, rest: Rest) -> None:
        names = [each.name for each in self._campaign.stage]
        self._outlets.say(
            StageStarted(
                t=attempt.started,
                job=self._job.record.job,
                stage=entry.name,
                number=names.index(entry.name) + 1,
                count=len(names),
                attempt=len(self._job.tries(entry.name)),
                command=attempt.command,
                expected_s=rest.expected_s,
                left_s=rest.left_s,
                unknown=rest.unknown,
            )
        )

    async def _driven(self, entry: StageEntry, words: tuple[str, ...]) -> tuple[Done, str]:
        """Run a procedure; return how its process ended, and why the run did not complete."""
        run = DrivenRun()

        def told(line: str) -> None:
            # What is no event is an answer of a command that could not begin: it reports its failure, too.
            with suppress(MessageError):
                event = event_of(decode_object(line.encode()))
                run.take(event)
                self._outlets.told(event)

        done = await self._done(entry, words, told=told, end_by=signal.SIGTERM, end_s=_END_S)
        text = run.text or done.fault
        if done.code == ExitCode.DONE:
            self._left_to_people = None
        elif run.left_to_people:
            why = f"in stage {entry.name} the arm was stopped, and only a person lets it move again: {text}"
            self._left_to_people = Cause("safety" if done.code == ExitCode.SAFETY else "timeout", why)
        return done, text

    async def _done(self, entry: StageEntry, words: tuple[str, ...], **how: Any) -> Done:
        """Run the command of a stage for as long as it may take."""
        self._overdue = False
        watch = asyncio.create_task(self._limited(entry))
        try:
            return await self._outlets.do(words, started=self._ending.started, **how)
        finally:
            self._ending.over()
            await cancel(watch)

    async def _limited(self, entry: StageEntry) -> None:
        """End the try when its time is over."""
        if entry.time_limit_s is not None:
            await self._clock.sleep(entry.time_limit_s)
            self._overdue = True
            await self._ending.terminate()

    def _failure(self, entry: StageEntry, code: int, text: str) -> StageVerdict:
        if self._ending.cause is not None:
            return not_done(entry, self._ending.cause, code)
        if self._overdue:
            return not_done(
                entry, Cause("time-limit", f"it was not over after {entry.time_limit_s:g} s"), code
            )
        verdict = of_exit(entry, code, text)
        if verdict.code == "interrupted":
            self._ending.operator_ended()
        return verdict

    def _now(self) -> str:
        return self._clock.now_utc().isoformat(timespec="milliseconds")
