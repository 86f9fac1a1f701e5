"""What a job of a campaign would do, and how long that took the last time."""

from datetime import datetime

from catseye.app.campaign.checks import require_doable
from catseye.app.campaign.deadline import require_deadline
from catseye.app.campaign.forecast import Holds, forecast, rest_of
from catseye.app.campaign.holding import Holding
from catseye.app.campaign.job import Job, job_id
from catseye.app.cell.load import load_cell
from catseye.app.cli.campaigning import Wanted, scope_of, times_of
from catseye.app.cli.documents import CampaignPlan, ExpectedStage
from catseye.app.cli.lazy import options_of_command
from catseye.app.cli.surveyed import bench_now, surveyed
from catseye.app.protocol.procedures import procedures
from catseye.app.results.model import Column, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import duration_text
from catseye.app.results.origin import origin_now
from catseye.app.service.running import read_answers


def campaign_plan(wanted: Wanted, now: datetime) -> CampaignPlan:
    """Look at cell and runs; nothing moves, and nothing is written.

    Args:
        now: UTC time.

    Raises:
        ConfigError: cell file or answers cannot be used.
        UsageError: the campaign cannot be done on this cell, the job is of another one, or the deadline is none.
    """
    require_deadline(wanted.deadline, "--deadline")
    read_answers(wanted.answers)
    loaded, root = wanted.loaded, wanted.root
    scope = scope_of(loaded.campaign, root, wanted.job)
    survey = surveyed(wanted.cell, root, now, bench_now(wanted.cell), remember=False, scope=scope)
    require_doable(loaded, survey.stages, procedures(), options_of_command)
    found = forecast(loaded.campaign.stage, survey, _holds(wanted, now), times_of(wanted, now))
    rest = rest_of([one for one in found if not one.holds])
    return CampaignPlan(
        job=wanted.job,
        stages=tuple(
            ExpectedStage(stage=one.stage, holds=one.holds, expected_s=one.expected_s, run=one.run or None)
            for one in found
        ),
        expected_s=rest.left_s or 0.0,
        unknown=rest.unknown,
    )


def _holds(wanted: Wanted, now: datetime) -> Holds:
    """Return what says whether a stage of the job is done, and holds."""
    if not wanted.job and wanted.loaded.campaign.reuse == "job":
        # A new job has done nothing yet.
        return lambda _entry, _stage: False
    cell, id_ = load_cell(wanted.cell).cell.name, wanted.job or job_id(wanted.loaded.campaign.name, now)
    job = Job.seen(wanted.root, id_, wanted.loaded, cell, now)
    if job.record.passed:
        return lambda _entry, _stage: True
    holding = Holding(wanted.loaded, job)
    holding.look()
    return holding.holds


def plan_report(plan: CampaignPlan) -> Report:
    """Return a table of the stages, and how long all of it takes as far as is known."""
    columns = (
        Column("stage", "stage"),
        Column("to_do", "to do"),
        Column("expected", "expected"),
        Column("run", "as run"),
    )
    table = Table("stages", "Stages", columns, tuple(map(_row, plan.stages)))
    known = "no earlier run on this cell says how long the rest takes"
    if all(one.holds for one in plan.stages):
        known = "nothing is left to do"
    elif plan.expected_s:
        known = f"the procedures left took {duration_text(plan.expected_s, whole=True)} the last time"
    unknown = f"; not counted: {', '.join(plan.unknown)}" if plan.unknown and plan.expected_s else ""
    said = Statement(Sign.NEUTRAL, f"{known}{unknown}")
    title = f"Plan of job {plan.job}" if plan.job else "Plan of a new job"
    return Report(title, origin_now(), (section("plan", "Plan", [said, table], brief=True),))


def _row(one: ExpectedStage) -> tuple[str, str, str, str]:
    expected = "unknown" if one.expected_s is None else duration_text(one.expected_s, whole=True)
    run = (one.run or "").rpartition("_")[2]
    return (one.stage, "holds" if one.holds else "yes", "" if one.holds else expected, run)
