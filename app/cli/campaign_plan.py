"""What a job of a campaign would do, and how long that took the last time."""

from dataclasses import replace
from datetime import datetime

from catseye.app.campaign.checks import require_doable
from catseye.app.campaign.forecast import forecast, left_bench_s, took_bench_s
from catseye.app.cell.load import load_cell
from catseye.app.cli.campaigning import Wanted, scope_of
from catseye.app.cli.documents import CampaignPlan, ExpectedStage
from catseye.app.cli.lazy import options_of_command
from catseye.app.cli.surveyed import bench_now, surveyed
from catseye.app.protocol.procedures import procedures
from catseye.app.results.model import Column, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import duration_text
from catseye.app.results.origin import origin_now
from catseye.app.results.readiness.cell_runs import runs_of_cell


def campaign_plan(wanted: Wanted, now: datetime) -> CampaignPlan:
    """Look at cell and runs; nothing moves, and nothing is written.

    Args:
        now: UTC time.

    Raises:
        ConfigError: the cell file cannot be used.
        UsageError: the campaign cannot be done on this cell.
    """
    campaign, root = wanted.loaded.campaign, wanted.root
    scope = scope_of(campaign, root, wanted.job)
    survey = surveyed(wanted.cell, root, now, bench_now(wanted.cell), remember=False, scope=scope)
    require_doable(wanted.loaded, survey.stages, procedures(), options_of_command)
    runs = runs_of_cell(root, load_cell(wanted.cell).cell.name, now)
    found = forecast(campaign.stage, survey.stages, runs, lambda run: took_bench_s(root, run))
    if not wanted.job and campaign.reuse == "job":
        # A new job has done nothing yet.
        found = [replace(one, holds=False) for one in found]
    speed = wanted.speed or 1.0
    return CampaignPlan(
        job=wanted.job,
        stages=tuple(
            ExpectedStage(
                stage=one.stage,
                holds=one.holds,
                expected_s=None if one.bench_s is None else one.bench_s / speed,
                run=one.run or None,
            )
            for one in found
        ),
        expected_s=left_bench_s(found) / speed,
        unknown=tuple(one.stage for one in found if not one.holds and one.bench_s is None),
    )


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
    if plan.expected_s:
        known = f"the procedures left took {duration_text(plan.expected_s, whole=True)} the last time"
    unknown = f"; not counted: {', '.join(plan.unknown)}" if plan.unknown and plan.expected_s else ""
    said = Statement(Sign.NEUTRAL, f"{known}{unknown}")
    title = f"Plan of job {plan.job}" if plan.job else "Plan of a new job"
    return Report(title, origin_now(), (section("plan", "Plan", [said, table], brief=True),))


def _row(one: ExpectedStage) -> tuple[str, str, str, str]:
    expected = "" if one.expected_s is None else duration_text(one.expected_s, whole=True)
    run = (one.run or "").rpartition("_")[2]
    return (one.stage, "holds" if one.holds else "yes", "" if one.holds else expected, run)
