"""A job put together from what the command line was given."""

from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

from catseye.app.campaign.checks import require_doable
from catseye.app.campaign.conduct import Conductor, Ports
from catseye.app.campaign.deadline import Deadline, deadline_of
from catseye.app.campaign.documents import stored_document
from catseye.app.campaign.ending import Cause, Ending
from catseye.app.campaign.forecast import LastTime, last_times, took_bench_s
from catseye.app.campaign.job import CampaignBusyError, Job, alone, job_id, jobs_folder
from catseye.app.campaign.load import LoadedCampaign
from catseye.app.campaign.model import Campaign, toml_text
from catseye.app.campaign.trying import Outlets, Trying
from catseye.app.campaign.words import Driving, Wording
from catseye.app.cell.load import load_cell
from catseye.app.cli.campaign_teller import CampaignTeller
from catseye.app.cli.lazy import options_of_command
from catseye.app.cli.output import note
from catseye.app.cli.surveyed import bench_now, surveyed
from catseye.app.engine.signals import loop_signals
from catseye.app.errors import CatseyeError, InterruptedRunError, TerminatedRunError
from catseye.app.files.atomic import write_atomically
from catseye.app.protocol.campaign_events import CampaignEnded
from catseye.app.protocol.procedures import procedures
from catseye.app.results.readiness.cell_runs import runs_of_cell
from catseye.app.results.readiness.survey import Scope, Survey
from catseye.app.service.command_process import do_command
from catseye.app.service.running import answer_text, read_answers
from catseye.drivers.roles.clock import Clock, SystemClock


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
    ending = Ending(clock)
    text = wanted.deadline or campaign.deadline
    deadline = deadline_of(text, now) if text else None
    cell = load_cell(wanted.cell).cell.name
    stages = surveyed(
        wanted.cell, wanted.root, now, remember=False, scope=scope_of(campaign, wanted.root)
    ).stages
    require_doable(wanted.loaded, stages, procedures(), options_of_command)
    stated = {name: answer_text(value) for name, value in campaign.answers.items()}
    answers = {**stated, **read_answers(wanted.answers)}
    with loop_signals(ending.deliver), ExitStack() as stack:
        await _wait_until_alone(stack, wanted, cell, ending, deadline)
        id_ = wanted.job or job_id(campaign.name, now)
        job = Job.opened(wanted.root, id_, wanted.loaded, cell, now)
        if (before := job.record.verdict) is not None:
            note(f"job {id_} has passed before: nothing is left to do")
            CampaignTeller(wanted.as_json).say(before)
            return before
        return await _conductor(wanted, job, answers, ending, clock).conduct(deadline)


async def _wait_until_alone(
    stack: ExitStack, wanted: Wanted, cell: str, ending: Ending, deadline: Deadline | None
) -> None:
    """Be the only job of a cell until the stack is left."""
    left_s, told = wanted.wait_lock_s, False
    while True:
        try:
            stack.enter_context(alone(wanted.root, cell))
        except CampaignBusyError:
            if ending.cause is not None:
                raise _ended_waiting(ending.cause) from None
            if left_s <= 0.0:
                raise
            if deadline is not None and ending.left_s(deadline) <= 0.0:
                raise CampaignBusyError(
                    f"the deadline {deadline.text} has come while another job of cell {cell} was under way"
                ) from None
        else:
            return
        if not told:
            note(f"waiting for another job of cell {cell} to end, {wanted.wait_lock_s:g} s at most")
            told = True
        await ending.wait(1.0)
        left_s -= 1.0


def _ended_waiting(cause: Cause) -> CatseyeError:
    """Return that a job was ended before it began."""
    kind = TerminatedRunError if cause.code == "terminated" else InterruptedRunError
    return kind(f"{cause.text} before it began: another job of the cell is under way")


def _conductor(
    wanted: Wanted, job: Job, answers: Mapping[str, str], ending: Ending, clock: Clock
) -> Conductor:
    campaign, teller = wanted.loaded.campaign, CampaignTeller(wanted.as_json)
    wording = Wording(
        wanted.loaded,
        job.record.job,
        job.folder,
        Driving(
            wanted.arm, wanted.speed, wanted.waive_walk, written_answers(answers, job.folder), wanted.metrics
        ),
        options_of_command,
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
    trying = Trying(wanted.loaded, job, wording, ending, outlets, clock)
    ports = Ports(_look(wanted, job), teller.say, clock, times_of(wanted, clock.now_utc()))
    return Conductor(campaign, job, trying, ending, ports, wanted.wait_lock_s)


def _look(wanted: Wanted, job: Job) -> Callable[[], Survey]:
    scope = scope_of(wanted.loaded.campaign, wanted.root, job.record.job)

    def look() -> Survey:
        return surveyed(
            wanted.cell, wanted.root, datetime.now(UTC), bench_now(wanted.cell), remember=False, scope=scope
        )

    return look


def times_of(wanted: Wanted, now: datetime) -> dict[str, LastTime]:
    """Return how long the procedures of a campaign took on its cell the last time, in whatever job."""
    names = (each.name for each in wanted.loaded.campaign.stage if not each.command)
    runs = runs_of_cell(wanted.root, load_cell(wanted.cell).cell.name, now)
    return last_times(names, runs, partial(took_bench_s, wanted.root), wanted.speed or 1.0)


def scope_of(campaign: Campaign, root: Path, job: str = "") -> Scope:
    """Return what of the cell counts for a job, or, without its id, for one that has not begun."""
    folder = jobs_folder(root) / job if job else None
    if campaign.reuse == "cell":
        return Scope(folder=folder)
    return Scope(job, folder, frozenset(each.name for each in campaign.stage))


def written_answers(answers: Mapping[str, str], folder: Path) -> Path | None:
    """Write answers into a folder; return the file, None where there are none.

    Raises:
        StorageError: it cannot be written.
    """
    if not answers:
        return None
    path = folder / "answers.toml"
    write_atomically(
        path, "".join(f"{toml_text(id_)} = {toml_text(text)}\n" for id_, text in answers.items())
    )
    return path
