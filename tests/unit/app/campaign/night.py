"""A job over a cell of three stages whose commands do what a test says."""

import asyncio
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from catseye.app.campaign.conduct import Conductor, Ports
from catseye.app.campaign.ending import Ending
from catseye.app.campaign.forecast import LastTime
from catseye.app.campaign.job import Job
from catseye.app.campaign.load import LoadedCampaign
from catseye.app.campaign.model import Campaign
from catseye.app.campaign.trying import Outlets, Trying
from catseye.app.campaign.words import Driving, Wording
from catseye.app.errors import CatseyeError
from catseye.app.protocol.campaign_events import CampaignEnded, CampaignEvent
from catseye.app.protocol.commands import CommandEvent, CommandFailed
from catseye.app.protocol.events import encode_event
from catseye.app.protocol.run_events import RunEvent
from catseye.app.results.readiness.cell_runs import CellRun, CellRuns
from catseye.app.results.readiness.stages import CellStage, State
from catseye.app.results.readiness.survey import Survey
from catseye.app.service.command_process import Done, Signal
from catseye.procedures.kit.procedure import Procedure
from tests.unit.app.engine.fakes import ManualClock

CELL = "lab-1"
SEARCH, IDENTIFY, REPORT = {"name": "search"}, {"name": "identify"}, {"name": "report"}


class NightClock(ManualClock):
    """The second between two looks passes at once; whatever is longer waits for the test."""

    async def sleep(self, duration_s: float) -> None:
        if duration_s > 1.0:
            await super().sleep(duration_s)
            return
        self.advance(duration_s)
        await asyncio.sleep(0)


@dataclass
class Effect:
    """What becomes of a command.

    Attributes:
        code: exit code.
        text: why it failed.
        out: data that it writes.
        found: stands for the stage where it is done.
        state: of the stage afterwards.
        waits: the command goes on until it is sent a signal, which is its exit code with 128.
        then: called when it ends.
        said: events of its run.
    """

    code: int = 0
    text: str = ""
    out: str = ""
    found: str = ""
    state: State = "done"
    waits: bool = False
    then: Callable[[], None] = lambda: None
    said: tuple[RunEvent, ...] = ()


@dataclass
class Night:
    """A cell, and what was called on it.

    Attributes:
        stages: of the cell, by name.
        effects: of the commands of each stage, the next one first; nothing said means that it goes well.
        calls: words of the commands that were run.
        events: of the job.
        document: what a run keeps.
        runs: of the cell.
        looks_fail: why the next looks at the cell fail; None for one that does not.
        last_times: how long its procedures took.
        procedures: that are installed.
    """

    folder: Path
    clock: ManualClock = field(default_factory=NightClock)
    stages: dict[str, CellStage] = field(default_factory=dict)
    effects: dict[str, list[Effect]] = field(default_factory=dict)
    calls: list[tuple[str, ...]] = field(default_factory=list)
    events: list[CampaignEvent] = field(default_factory=list)
    document: dict[str, Any] = field(default_factory=dict)
    runs: list[CellRun] = field(default_factory=list)
    looks_fail: list[CatseyeError | None] = field(default_factory=list)
    last_times: dict[str, LastTime] = field(default_factory=dict)
    procedures: list[Procedure] = field(default_factory=list)
    ending: Ending = field(init=False)
    signals: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.ending = Ending(self.clock)
        self._tried: dict[str, int] = {}
        words = ("run", "search", "--cell", "cell.toml")
        self.stages = {
            "search": CellStage("search", True, "next", "finds", "", words=words),
            "identify": _data("identify", ("identify", "RUN", "-o", "result-RUN.json")),
            "report": _data("report", ("report", "RESULT", "-o", "page.html")),
        }

    def campaign(self, *stages: Mapping[str, Any], **rest: Any) -> LoadedCampaign:
        values = {"format": "catseye-campaign/1", "name": "night", "stage": list(stages), **rest}
        return LoadedCampaign(Campaign.model_validate(values), self.folder / "night.toml", "ab" * 32)

    async def conduct(
        self, loaded: LoadedCampaign, deadline: Any = None, job: str = "n1", wait_lock_s: float = 0.0
    ) -> CampaignEnded:
        opened = Job.opened(self.folder, job, loaded, CELL, self.clock.now_utc())
        wording = Wording(
            loaded,
            job,
            opened.folder,
            Driving(speed=400.0),
            lambda name: frozenset({"--json", "--model"} if name != "report" else {"--page"}),
            {"folder": str(opened.folder), "cell": "cell.toml"},
        )
        outlets = Outlets(
            self._do, self.events.append, lambda _event: None, lambda _event: None, lambda _run: self.document
        )
        trying = Trying(loaded, opened, wording, self.ending, outlets, self.clock)
        ports = Ports(self._look, self.events.append, self.clock, self.last_times)
        conductor = Conductor(loaded.campaign, opened, trying, self.ending, ports, wait_lock_s)
        return await conductor.conduct(deadline)

    def lose(self, name: str, why: str) -> None:
        """Let a stage be done no longer, and what was made with it neither."""
        self.stages[name] = replace(self.stages[name], state="next", lost=why)
        names = list(self.stages)
        for later in names[names.index(name) + 1 :]:
            self.stages[later] = replace(self.stages[later], state="later")

    def _look(self) -> Survey:
        if self.looks_fail and (error := self.looks_fail.pop(0)) is not None:
            raise error
        return Survey(CELL, self.procedures, {}, CellRuns(list(self.runs)), list(self.stages.values()))

    async def _do(
        self,
        words: tuple[str, ...],
        *,
        heard: Callable[[CommandEvent], None] | None = None,
        told: Callable[[str], None] | None = None,
        started: Callable[[Signal], None] = lambda _signal: None,
        end_by: int = 0,
        end_s: float = 0.0,
    ) -> Done:
        del heard, end_by, end_s
        self.calls.append(words)
        name = self._stage_of(words)
        effects = self.effects.get(name, [])
        number = self._tried.get(name, 0)
        self._tried[name] = number + 1
        effect = effects[number] if number < len(effects) else Effect()
        for event in effect.said:
            if told is not None:
                told(encode_event(event).decode())
        code = effect.code
        if effect.waits:
            code = await self._until_signalled(started)
        if code == 0:
            self._finish(name, effect)
        effect.then()
        failed = (CommandFailed(text=effect.text, exit_code=code),) if code else ()
        return Done(words, code, effect.out, "", failed)

    async def _until_signalled(self, started: Callable[[Signal], None]) -> int:
        ended = asyncio.get_running_loop().create_future()

        def send(number: int) -> None:
            self.signals.append(number)
            if not ended.done():
                ended.set_result(128 + number)

        started(send)
        return int(await ended)

    def _stage_of(self, words: Sequence[str]) -> str:
        return words[1] if words[0] == "run" else words[0]

    def _finish(self, name: str, effect: Effect) -> None:
        stage = self.stages.get(name)
        if stage is None:
            return
        run = ("20260102T030405Z_search_abcdef",)
        self.stages[name] = replace(stage, state=effect.state, found=effect.found, lost="", runs=run)
        if name == "search":
            self.stages["identify"] = replace(
                self.stages["identify"], words=("identify", "abcdef", "-o", "result-abcdef.json"), runs=run
            )
        if name == "identify":
            self.stages["report"] = replace(
                self.stages["report"], words=("report", "result-abcdef.json", "-o", "page.html"), runs=run
            )


def _data(name: str, words: tuple[str, ...]) -> CellStage:
    return CellStage(name, False, "later", "works", "", words=words)


def verdicts(ended: CampaignEnded) -> dict[str, tuple[str, str]]:
    """Return verdict and code of each stage."""
    return {one.stage: (one.verdict, one.code) for one in ended.stages}
