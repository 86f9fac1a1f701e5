"""What keeps a job from beginning."""

import asyncio
import json
import os
import signal
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import pytest

from catseye.app.campaign.job import Attempt, CampaignBusyError, Job, alone
from catseye.app.campaign.load import load_campaign
from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli import campaigning
from catseye.app.cli.campaign import campaign
from catseye.app.cli.campaign_plan import campaign_plan, plan_report
from catseye.app.cli.campaigning import Wanted, conduct_campaign, written_answers
from catseye.app.cli.documents import CampaignPlan, ExpectedStage
from catseye.app.errors import ConfigError, TerminatedRunError, UsageError
from catseye.app.service.running import read_answers
from catseye.drivers.roles.clock import SystemClock
from tests.machine_lines import faults_of


def wanted(folder: Path, *stages: str, deadline: str = "", wait_lock_s: float = 0.0) -> Wanted:
    cell, file = folder / "cell.toml", folder / "night.toml"
    cell.write_text(TEMPLATE, encoding="utf-8")
    head = 'format = "catseye-campaign/1"\nname = "night"\n'
    file.write_text(head + "".join(f'[[stage]]\nname = "{name}"\n' for name in stages), encoding="utf-8")
    given = (load_campaign(file), cell, folder / "runs", "n1", deadline, wait_lock_s)
    return Wanted(*given, answers=None, arm=None, speed=None, waive_walk=None, as_json=False)


async def refused_while_another_goes_on(asked: Wanted) -> None:
    with alone(asked.root, load_cell(asked.cell).cell.name):
        await conduct_campaign(asked, datetime.now(UTC))


async def test_another_job_is_waited_for_until_the_deadline(tmp_path: Path) -> None:
    asked = wanted(tmp_path, "reflector-search", deadline="0.001s", wait_lock_s=3600.0)
    with pytest.raises(CampaignBusyError, match=r"the deadline .* has come while another job"):
        await refused_while_another_goes_on(asked)


async def test_a_job_that_waits_can_be_terminated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminating(SystemClock):
        async def sleep(self, duration_s: float) -> None:
            del duration_s
            os.kill(os.getpid(), signal.SIGTERM)
            await asyncio.sleep(0)

    monkeypatch.setattr(campaigning, "SystemClock", Terminating)
    with pytest.raises(TerminatedRunError):
        await refused_while_another_goes_on(wanted(tmp_path, "reflector-search", wait_lock_s=3600.0))


async def test_wrong_answers_leave_the_verdict_of_before(tmp_path: Path) -> None:
    asked = wanted(tmp_path, "reflector-search")
    cell = load_cell(asked.cell).cell.name
    folder = Job.opened(asked.root, asked.job, asked.loaded, cell, datetime.now(UTC)).folder
    verdict = folder / "verdict.json"
    verdict.write_text("{}", encoding="utf-8")
    with pytest.raises(ConfigError, match="the answers cannot be read"):
        await conduct_campaign(replace(asked, answers=tmp_path / "missing.toml"), datetime.now(UTC))
    assert verdict.read_text(encoding="utf-8") == "{}"


async def test_a_stage_that_its_job_never_reaches_is_refused(tmp_path: Path) -> None:
    # The path is not measured by this job, so there would be nothing to validate with.
    with pytest.raises(UsageError, match="stage validate: it is not on the way"):
        await conduct_campaign(
            wanted(tmp_path, "reflector-search", "open-loop", "validate"), datetime.now(UTC)
        )


def test_answers_reach_the_runs_unchanged(tmp_path: Path) -> None:
    answers = {"place/P1": "yes", "say 😀": 'a "b" \\ \x7f\nc'}
    assert read_answers(written_answers(answers, tmp_path)) == answers


async def test_true_is_the_answer_yes(tmp_path: Path) -> None:
    asked = wanted(tmp_path, "reflector-search", deadline="0s")
    campaign = asked.loaded.campaign.model_copy(update={"answers": {"clear": True, "turns": 1.5}})
    await conduct_campaign(replace(asked, loaded=replace(asked.loaded, campaign=campaign)), datetime.now(UTC))
    written = asked.root / "jobs" / asked.job / "answers.toml"
    assert read_answers(written) == {"clear": "yes", "turns": "1.5"}


def test_a_plan_of_a_job_writes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = wanted(tmp_path, "reflector-search", "open-loop")
    before = sorted(tmp_path.rglob("*"))
    campaign(asked.loaded.path, cell=asked.cell, runs=asked.root, job="n1", as_json=True, dry_run=True)
    assert sorted(tmp_path.rglob("*")) == before
    (line,) = capsys.readouterr().out.splitlines()
    assert faults_of(line) == []
    plan = json.loads(line)
    assert [(one["stage"], one["holds"], one["expected_s"]) for one in plan["stages"]] == [
        ("reflector-search", False, None),
        ("open-loop", False, None),
    ]
    assert (plan["expected_s"], plan["unknown"]) == (0.0, ["reflector-search", "open-loop"])


def test_a_plan_refuses_what_its_job_would(tmp_path: Path) -> None:
    asked = wanted(tmp_path, "reflector-search", deadline="soon")
    with pytest.raises(UsageError, match="'soon' is no time"):
        campaign_plan(asked, datetime.now(UTC))
    with pytest.raises(ConfigError, match="the answers cannot be read"):
        campaign_plan(replace(asked, deadline="", answers=tmp_path / "missing.toml"), datetime.now(UTC))


def tried(asked: Wanted, *, work: str) -> None:
    """Let a job have done the comparison that is its only stage."""
    cell, now = load_cell(asked.cell).cell.name, datetime.now(UTC)
    job = Job.opened(asked.root, asked.job, asked.loaded, cell, now)
    attempt = Attempt(place=1, command="", work=work, started="", ended="", exit_code=0)
    job.began("alarm", attempt)


def compared(folder: Path, limit_um: int) -> Wanted:
    asked, file = wanted(folder, "open-loop"), folder / "night.toml"
    stage = (
        f'[[stage]]\nname = "alarm"\ncommand = ["compare", "a.json", "b.json", "--limit-u", "{limit_um}"]\n'
    )
    file.write_text(f'format = "catseye-campaign/1"\nname = "night"\n{stage}', encoding="utf-8")
    return replace(asked, loaded=load_campaign(file))


def test_a_plan_holds_only_what_the_job_would_keep(tmp_path: Path) -> None:
    asked = compared(tmp_path, 3)
    tried(asked, work=asked.loaded.fingerprint(asked.loaded.campaign.stage[0]))
    assert [one.holds for one in campaign_plan(asked, datetime.now(UTC)).stages] == [True]
    edited = compared(tmp_path, 4)
    assert [one.holds for one in campaign_plan(edited, datetime.now(UTC)).stages] == [False]


def test_a_plan_of_nothing_left_says_so() -> None:
    plan = CampaignPlan(
        job="n1",
        stages=(ExpectedStage(stage="alarm", holds=True, expected_s=None, run=None),),
        expected_s=0.0,
        unknown=(),
    )
    assert "nothing is left to do" in str(plan_report(plan))
