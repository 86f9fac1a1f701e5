"""Leading a job through its stages."""

import asyncio
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, field, replace
from typing import Final

from catseye.app.campaign.deadline import Deadline
from catseye.app.campaign.ending import Cause, Ending
from catseye.app.campaign.forecast import LastTime, Rest, forecast, rest_of
from catseye.app.campaign.job import Job
from catseye.app.campaign.judging import deciding, exit_code_of_job, judged_stage, not_done, of_error
from catseye.app.campaign.model import Campaign, StageEntry
from catseye.app.campaign.trying import Trying
from catseye.app.campaign.words import lacks_earlier
from catseye.app.engine.waiting import cancel
from catseye.app.errors import CatseyeError, ConfigError, StorageError
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.campaign_events import (
    CampaignEnded,
    CampaignEvent,
    CampaignStarted,
    StageEnded,
    StageVerdict,
)
from catseye.app.results.readiness.stages import CellStage
from catseye.app.results.readiness.survey import Survey
from catseye.drivers.roles.clock import Clock

_SETTLES_S: Final = 90.0
"""How long a run that a killed job has left behind takes at most to end by itself, real s."""

_PASSES: Final = 2
"""How often the list is gone through: what no longer holds after later stages is done once more."""


@dataclass(frozen=True)
class Ports:
    """What a job is led with.

    Attributes:
        look: returns what the cell is ready for, as far as the job counts; blocks.
        say: called with each event.
        clock: real time.
        last_times: how long procedures took the last time, by their names.
    """

    look: Callable[[], Survey]
    say: Callable[[CampaignEvent], None]
    clock: Clock
    last_times: Mapping[str, LastTime] = field(default_factory=dict[str, LastTime])


class Conductor:
    """Leads one job through its stages.

    Args:
        trying: does a stage once.
        wait_lock_s: how long a run of the job that is still under way is waited for, real s.
    """

    def __init__(
        self,
        campaign: Campaign,
        job: Job,
        trying: Trying,
        ending: Ending,
        ports: Ports,
        wait_lock_s: float = 0.0,
    ) -> None:
        self._campaign = campaign
        self._job = job
        self._trying = trying
        self._ending = ending
        self._ports = ports
        self._wait_lock_s = wait_lock_s
        self._survey: Survey | None = None

    async def conduct(self, deadline: Deadline | None) -> CampaignEnded:
        """Do what is left of the job; return its verdict."""
        record, names = self._job.record, tuple(each.name for each in self._campaign.stage)
        self._say(
            CampaignStarted(
                job=record.job,
                campaign=record.campaign,
                cell=record.cell,
                stages=names,
                goes_on=self._job.goes_on,
                deadline=None if deadline is None else deadline.text,
            )
        )
        verdicts: dict[str, StageVerdict] = {}
        try:
            async with self._until(deadline):
                await self._go_through(verdicts)
        except CatseyeError as error:
            self._break_off(verdicts, error)
        except Exception as error:
            # It goes on as what it is, a fault of the program; whoever waits for a verdict has one all the same.
            self._break_off(verdicts, error)
            self._end(verdicts, deadline)
            raise
        return self._end(verdicts, deadline)

    def _end(self, verdicts: dict[str, StageVerdict], deadline: Deadline | None) -> CampaignEnded:
        """Keep and say the verdict of the job; return it."""
        stages = tuple(verdicts[each.name] for each in self._campaign.stage)
        verdict = self._kept(self._verdict_of(stages, deadline))
        self._ports.say(verdict)
        return verdict

    def _kept(self, verdict: CampaignEnded) -> CampaignEnded:
        """Keep a verdict in the folder of the job; return it, or that it could not be kept."""
        try:
            self._job.ended(verdict)
        except StorageError as error:
            lost = {"verdict": "not-done", "code": "storage", "text": str(error)}
            return verdict.model_copy(update={**lost, "exit_code": int(ExitCode.STORAGE)})
        return verdict

    @asynccontextmanager
    async def _until(self, deadline: Deadline | None) -> AsyncIterator[None]:
        """End the job at its deadline."""
        async with AsyncExitStack() as stack:
            if deadline is not None:
                watch = asyncio.create_task(self._ending.at(deadline))
                stack.push_async_callback(cancel, watch)
            yield

    def _break_off(self, verdicts: dict[str, StageVerdict], error: Exception) -> None:
        """Give every stage that has no verdict the reason why the job cannot go on."""
        for entry in self._campaign.stage:
            if entry.name not in verdicts:
                verdicts[entry.name] = not_done(entry, of_error(error))
                self._say(StageEnded(job=self._job.record.job, result=verdicts[entry.name]))

    async def _go_through(self, verdicts: dict[str, StageVerdict]) -> None:
        """Settle every stage."""
        for number in range(_PASSES):
            before = dict(verdicts)
            verdicts.clear()
            await self._look()
            again = [each for each in self._campaign.stage if number == 0 or self._lost(each, before)]
            # What comes after something that is done anew was made with what no longer holds.
            first = self._campaign.stage.index(again[0]) if again else len(self._campaign.stage)
            verdicts.update({each.name: before[each.name] for each in self._campaign.stage[:first]})
            for entry in self._campaign.stage[first:]:
                verdicts[entry.name] = await self._settled(entry, verdicts)
                self._say(StageEnded(job=self._job.record.job, result=verdicts[entry.name]))

    def _lost(self, entry: StageEntry, verdicts: dict[str, StageVerdict]) -> bool:
        """Return whether a stage has passed and holds no longer."""
        stage = self._stage(entry)
        passed = verdicts[entry.name].verdict == "passed" and self._ending.cause is None
        return passed and stage is not None and stage.procedure and bool(stage.lost)

    async def _settled(self, entry: StageEntry, before: dict[str, StageVerdict]) -> StageVerdict:
        """Return the verdict of a stage, which is done where it is not yet, or does not hold."""
        stage = self._stage(entry)
        if self._trying.holding.holds(entry, stage):
            return await self._judged(entry, stage)
        if why := self._why_not(entry, stage, before):
            return not_done(entry, why)
        verdict = await self._tried(entry)
        for _ in range(entry.retries):
            if verdict.verdict == "passed" or self._ending.cause is not None:
                break
            if (cause := await self._ending.wait(entry.retry_after_s)) is not None:
                return self._with_tries(not_done(entry, cause), stage)
            verdict = await self._tried(entry)
        return verdict

    def _why_not(
        self, entry: StageEntry, stage: CellStage | None, before: dict[str, StageVerdict]
    ) -> Cause | None:
        """Return why a stage is not even tried; None where it is."""
        if self._ending.cause is not None:
            return self._ending.cause
        names = [each.name for each in self._campaign.stage]
        for earlier in self._campaign.stage[: names.index(entry.name)]:
            if before[earlier.name].verdict != "passed" and not self._campaign.goes_on_after(earlier):
                return Cause("waits-for", f"stage {earlier.name} did not pass")
        if since := self._would_not_count_before(entry):
            return Cause("waits-for", f"its run counts only after one of {since}, and there is none")
        if stage is not None and lacks_earlier(stage):
            left_out = stage.state == "left out"
            return Cause(
                "waits-for", stage.text if left_out else "no earlier stage has left what it works on"
            )
        return None

    def _would_not_count_before(self, entry: StageEntry) -> str:
        """Return the stage after which alone a run of this one counts, where it is not done; empty otherwise."""
        declared = {each.name: each.stage for each in self._seen.procedures}.get(entry.name)
        since = "" if entry.command or declared is None else declared.since
        missing = any(each.name == since and not each.runs for each in self._seen.stages)
        return since if missing else ""

    async def _tried(self, entry: StageEntry) -> StageVerdict:
        """Try a stage once, which for work on stored data is once for each run that waits; return its verdict."""
        if await self._is_under_way(entry):
            busy = Cause("busy", "a run of it is still under way: wait for its end")
            return not_done(entry, self._ending.cause or busy)
        todo = _each_run(self._stage(entry))
        while todo:
            if self._ending.cause is not None:
                return self._with_tries(not_done(entry, self._ending.cause), self._stage(entry))
            stage = todo.pop(0)
            try:
                last = self._seen.runs.last(entry.name)
                failure = await self._trying.once(entry, stage, self._results(), last, self._rest(entry))
            except StorageError as error:
                # What the job knows of itself could not be written: the stage may be done, and is looked at again.
                return not_done(entry, Cause("storage", str(error)))
            await self._look()
            if failure is not None:
                return self._with_tries(failure, self._stage(entry))
            if not todo and (after := self._stage(entry)) is not None and _waits_for_another(stage, after):
                todo.append(after)
        return await self._judged(entry, self._stage(entry))

    async def _judged(self, entry: StageEntry, stage: CellStage | None) -> StageVerdict:
        document = await asyncio.to_thread(self._trying.document, entry, stage)
        return self._with_tries(judged_stage(entry, stage, document), stage)

    def _with_tries(self, verdict: StageVerdict, stage: CellStage | None) -> StageVerdict:
        tries = self._job.tries(verdict.stage)
        if not tries:
            return verdict
        last = self._seen.runs.last(verdict.stage)
        runs = verdict.runs or (() if stage is None else stage.runs) or (() if last is None else (last.name,))
        return verdict.model_copy(
            update={
                "runs": runs,
                "tries": len(tries),
                "started": tries[0].started,
                "ended": tries[-1].ended,
                "exit_code": tries[-1].exit_code if verdict.exit_code is None else verdict.exit_code,
            }
        )

    async def _is_under_way(self, entry: StageEntry) -> bool:
        """Return whether a run of the stage goes on, as one does whose job was killed; wait for its end."""
        waited_s = 0.0
        while (run := self._seen.runs.last(entry.name)) is not None and run.status == "running":
            if waited_s >= max(self._wait_lock_s, _SETTLES_S) or self._ending.cause is not None:
                return True
            await self._ending.wait(1.0)
            waited_s += 1.0
            await self._look()
        return False

    def _rest(self, entry: StageEntry) -> Rest:
        """Return what is expected of a stage that is tried now, and of what comes after it."""
        holds, stages = self._trying.holding.holds, self._campaign.stage
        place = stages.index(entry)
        return rest_of(forecast(stages, self._seen, holds, self._ports.last_times)[place:])

    def _results(self) -> tuple[str, ...]:
        """Return the results that the way has led to; models that stand beside them where there are no others."""
        stages = self._seen.stages
        results = [path for stage in stages for path in stage.results]
        files = [path for stage in stages for path in stage.files if path.suffix == ".json"]
        return tuple(dict.fromkeys(map(str, results or files)))

    @property
    def _seen(self) -> Survey:
        if self._survey is None:
            raise RuntimeError("the cell was not looked at yet")
        return self._survey

    def _stage(self, entry: StageEntry) -> CellStage | None:
        if entry.command:
            return None
        for stage in self._seen.stages:
            if stage.name == entry.name:
                return stage
        raise ConfigError(
            f"stage {entry.name} is no longer on the way of the cell, whose file was changed meanwhile: "
            "change it back, or take the stage out of the campaign"
        )

    async def _look(self) -> None:
        await asyncio.to_thread(self._trying.holding.look)
        self._survey = await asyncio.to_thread(self._ports.look)

    def _verdict_of(self, stages: tuple[StageVerdict, ...], deadline: Deadline | None) -> CampaignEnded:
        decided, record = deciding(stages), self._job.record
        text = "every stage has passed" if decided is None else f"{decided.stage}: {decided.text}"
        return CampaignEnded(
            t=self._now(),
            job=record.job,
            campaign=record.campaign,
            campaign_sha256=record.campaign_sha256,
            cell=record.cell,
            verdict="passed" if decided is None else decided.verdict,
            code="passed" if decided is None else decided.code,
            text=text,
            exit_code=int(exit_code_of_job(decided)),
            started=record.started,
            ended=self._now(),
            deadline=None if deadline is None else deadline.text,
            folder=str(self._job.folder),
            stages=stages,
        )

    def _say(self, event: CampaignStarted | StageEnded) -> None:
        self._ports.say(event.model_copy(update={"t": self._now()}))

    def _now(self) -> str:
        return self._ports.clock.now_utc().isoformat(timespec="milliseconds")


def _each_run(stage: CellStage | None) -> list[CellStage | None]:
    """Return a stage once for each of the runs that it is done for, where all of it is done again."""
    if stage is None or stage.procedure or stage.state not in {"done", "failed"} or len(stage.runs) < 2:
        return [stage]
    first, *others = (run.rpartition("_")[2] for run in stage.runs)
    return [
        stage,
        *(replace(stage, words=tuple(word.replace(first, each) for word in stage.words)) for each in others),
    ]


def _waits_for_another(done: CellStage | None, stage: CellStage) -> bool:
    """Return whether a stage that was done for one of its runs has another one to be done for."""
    if done is None or stage.procedure or stage.state in {"done", "failed"}:
        return False
    return stage.words != done.words
