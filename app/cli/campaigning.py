"""A job put together from what the command line was given."""

import json
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache, partial
from pathlib import Path

from catseye.app.campaign.checks import require_doable
from catseye.app.campaign.conduct import Conductor, Ports
from catseye.app.campaign.deadline import deadline_of
from catseye.app.campaign.documents import stored_document
from catseye.app.campaign.ending import Ending
from catseye.app.campaign.job import CampaignBusyError, Job, alone, job_id
from catseye.app.campaign.load import LoadedCampaign
from catseye.app.campaign.model import value_text
from catseye.app.campaign.trying import Outlets, Trying
from catseye.app.campaign.words import Driving, Wording
from catseye.app.cell.load import load_cell
from catseye.app.cli.lazy import load_command
from catseye.app.cli.narrator import Narrator
from catseye.app.cli.output import note, warn, write_document
from catseye.app.cli.progress import ProgressBar
from catseye.app.cli.surveyed import bench_now, surveyed
from catseye.app.engine.signals import loop_signals
from catseye.app.files.atomic import write_atomically
from catseye.app.protocol.campaign_events import CampaignEnded, CampaignEvent, StageEnded, StageStarted
from catseye.app.protocol.commands import CommandEvent, CommandProgress, CommandWarning
from catseye.app.protocol.events import AnyEvent
from catseye.app.protocol.procedures import procedures
from catseye.app.protocol.run_events import TELEMETRY
from catseye.app.results.readiness.survey import Scope, Survey
from catseye.app.service.command_process import do_command
from catseye.app.service.running import read_answers
from catseye.drivers.roles.clock import Clock, SystemClock
from catseye.drivers.roles.text import harmless_lines


@dataclass(frozen=True)
class Wanted:
    """What the command line was given.

    Attributes:
        loaded: the campaign.
        cell: cell file.
        root: folder of the runs.
        job: id; empty for a new one.
        deadline: as given; empty for that of the file.
        wait_lock_s: how long another job of the cell is waited for, real s.
        answers: file of prompt id to answer.
        arm: the cell's name as typed to let real hardware move.
        speed: bench seconds in one real second.
        waive_walk: why a real arm may be driven where it was not walked.
        as_json: events go to stdout.
        metrics: file that says how the run under way fares; None for none.
    """

    loaded: LoadedCampaign
    cell: Path
    root: Path
    job: str
    deadline: str
    wait_lock_s: float
    answers: Path | None
    arm: str | None
    speed: float | None
    waive_walk: str | None
    as_json: bool
    metrics: Path | None = None


async def conduct_campaign(wanted: Wanted, now: datetime) -> CampaignEnded:
    """Lead a job through its stages; return its verdict.

    Args:
        now: UTC time.

    Raises:
        CampaignBusyError: another job of the cell is under way, and does not end in time.
        ConfigError: cell file or answers cannot be used.
        StorageError: the job cannot be stored.
        UsageError: the campaign cannot be done on this cell, or the job is of another one.
    """
    clock, campaign = SystemClock(), wanted.loaded.campaign
    text = wanted.deadline or campaign.deadline
    deadline = deadline_of(text, now) if text else None
    cell = load_cell(wanted.cell).cell.name
    require_doable(wanted.loaded, surveyed(wanted.cell, wanted.root, now).stages, procedures())
    ending = Ending(clock)
    with loop_signals(ending.deliver), ExitStack() as stack:
        await _wait_until_alone(stack, wanted, cell, ending, clock)
        id_ = wanted.job or job_id(campaign.name, now)
        job = Job.opened(wanted.root, id_, wanted.loaded, cell, now)
        if (before := job.record.verdict) is not None and before.verdict == "passed":
            note(f"job {id_} has passed before: nothing is left to do")
            _Teller(wanted.as_json).say(before)
            return before
        return await _conductor(wanted, job, ending, clock).conduct(deadline)


async def _wait_until_alone(
    stack: ExitStack, wanted: Wanted, cell: str, ending: Ending, clock: Clock
) -> None:
    """Be the only job of a cell until the stack is left."""
    end_s = clock.monotonic_s() + wanted.wait_lock_s
    told = False
    while True:
        try:
            stack.enter_context(alone(wanted.root, cell))
        except CampaignBusyError:
            if clock.monotonic_s() >= end_s or ending.cause is not None:
                raise
        else:
            return
        if not told:
            note(f"waiting for another job of cell {cell} to end, {wanted.wait_lock_s:g} s at most")
            told = True
        await ending.wait(1.0)


def _conductor(wanted: Wanted, job: Job, ending: Ending, clock: Clock) -> Conductor:
    campaign, teller = wanted.loaded.campaign, _Teller(wanted.as_json)
    wording = Wording(
        wanted.loaded,
        job.record.job,
        job.folder,
        Driving(wanted.arm, wanted.speed, wanted.waive_walk, _answers(wanted, job), wanted.metrics),
        _takes_json,
        {
            "cell": str(wanted.cell),
            "folder": str(job.folder),
            "job": job.record.job,
            "runs": str(wanted.root),
        },
    )
    outlets = Outlets(
        do_command, teller.say, teller.told, teller.heard, partial(stored_document, wanted.root)
    )
    trying = Trying(campaign, job, wording, ending, outlets, clock)
    return Conductor(
        campaign, job, trying, ending, Ports(_look(wanted, job), teller.say, clock), wanted.wait_lock_s
    )


def _look(wanted: Wanted, job: Job) -> Callable[[], Survey]:
    campaign = wanted.loaded.campaign
    ours = campaign.reuse == "job"
    scope = Scope(
        job.record.job if ours else "",
        job.folder,
        frozenset(each.name for each in campaign.stage) if ours else None,
    )

    def look() -> Survey:
        return surveyed(
            wanted.cell, wanted.root, datetime.now(UTC), bench_now(wanted.cell), remember=False, scope=scope
        )

    return look


def _answers(wanted: Wanted, job: Job) -> Path | None:
    """Write the answers of the campaign and of the command line into the folder of the job; these come first."""
    answers = {**wanted.loaded.campaign.answers, **read_answers(wanted.answers)}
    if not answers:
        return None
    path = job.folder / "answers.toml"
    lines = (f"{json.dumps(name)} = {json.dumps(value_text(value))}\n" for name, value in answers.items())
    write_atomically(path, "".join(lines))
    return path


@cache
def _takes_json(command: str) -> bool:
    """Return whether a command has the option --json."""
    return any("--json" in each.opts for each in load_command(command).params)


class _Teller:
    """Shows a job: to people on stderr, to programs on stdout."""

    def __init__(self, as_json: bool) -> None:
        self._as_json = as_json
        self._narrator: Narrator | None = None
        self._bar: ProgressBar | None = None

    def say(self, event: CampaignEvent) -> None:
        """Show an event of the job."""
        if self._as_json and isinstance(event, CampaignEnded):
            write_document("campaign-verdict", event.json_object())
        elif self._as_json:
            write_document("campaign-events", event.json_object())
        match event:
            case StageStarted():
                attempt = f", try {event.attempt}" if event.attempt > 1 else ""
                note(f"stage {event.number} of {event.count}{attempt}: {event.command}")
                self._bar = ProgressBar(event.stage)
                self._narrator = Narrator(event.stage, as_json=False)
            case StageEnded():
                if self._bar is not None:
                    self._bar.close()
                note(f"{event.result.stage}: {event.result.verdict}, {event.result.text}")
            case _:
                pass

    def told(self, event: AnyEvent) -> None:
        """Show an event of a run."""
        if self._as_json and not isinstance(event, TELEMETRY):
            write_document("events", event.json_object())
        if self._narrator is not None:
            self._narrator.publish(event)

    def heard(self, event: CommandEvent) -> None:
        """Show what a command on stored data reports."""
        match event:
            case CommandProgress() if self._bar is not None:
                self._bar.update(event.share, 1.0, event.text)
            case CommandWarning():
                warn(harmless_lines(event.text))
            case _:
                pass
