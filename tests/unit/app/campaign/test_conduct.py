"""A job leads a cell through its stages, and says of each whether it passed."""

import asyncio
import hashlib
import signal
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import pytest

from catseye.app.campaign.deadline import Deadline
from catseye.app.campaign.documents import document_file
from catseye.app.campaign.job import Job
from catseye.app.campaign.words import Driving, Wording
from catseye.app.errors import ConfigError, StorageError
from catseye.app.protocol.campaign_events import CampaignEnded, StageEnded, StageStarted
from catseye.app.protocol.procedures import procedures
from catseye.app.results.readiness.cell_runs import CellRun
from catseye.app.results.readiness.stages import CellStage
from tests.patience import until
from tests.unit.app.campaign.night import IDENTIFY, REPORT, SEARCH, Effect, Night, verdicts


async def test_every_stage_passes(night: Night) -> None:
    ended = await night.conduct(night.campaign(SEARCH, IDENTIFY, REPORT))
    assert (ended.verdict, ended.exit_code) == ("passed", 0)
    assert night.calls == [
        ("run", "search", "--cell", "cell.toml", "--job", "n1", "--speed", "400.0", "--json"),
        ("identify", "abcdef", "-o", "result-abcdef.json", "--json"),
        ("report", "result-abcdef.json", "-o", str(night.folder / "jobs/n1/page.html")),
    ]


def test_runs_of_a_job_write_its_metrics(night: Night) -> None:
    loaded = night.campaign(SEARCH)
    wording = Wording(
        loaded, "n1", night.folder, Driving(metrics=Path("night.prom")), lambda _name: frozenset(), {}
    )
    words = wording.of_procedure(loaded.campaign.stage[0], night.stages["search"])
    assert words[words.index("--metrics") + 1] == "night.prom"


async def test_a_rejected_measurement_has_failed(night: Night) -> None:
    night.effects["search"] = [Effect(code=1, text="the drift is 3 µm, 1 is allowed")]
    ended = await night.conduct(night.campaign(SEARCH, IDENTIFY))
    assert verdicts(ended)["search"] == ("failed", "rejected")
    assert ended.text == "search: the drift is 3 µm, 1 is allowed"
    assert ended.exit_code == 1


async def test_a_failure_may_leave_later_stages_to_do(night: Night) -> None:
    night.effects["identify"] = [Effect(code=1, text="it does not fit")]
    loaded = night.campaign(SEARCH, {**IDENTIFY, "on_failure": "go-on"}, REPORT)
    night.stages["report"] = night.stages["identify"].__class__(
        "report",
        False,
        "later",
        "works",
        "",
        words=("report", "abcdef", "-o", "page.html"),
        runs=("r_abcdef",),
    )
    ended = await night.conduct(loaded)
    assert verdicts(ended) == {
        "search": ("passed", "passed"),
        "identify": ("failed", "rejected"),
        "report": ("passed", "passed"),
    }
    assert ended.exit_code == 1


async def test_what_lacks_an_earlier_result_waits(night: Night) -> None:
    ended = await night.conduct(night.campaign(IDENTIFY))
    assert verdicts(ended)["identify"] == ("not-done", "waits-for")
    assert night.calls == []


async def test_nothing_is_driven_that_would_not_count(night: Night) -> None:
    night.procedures = procedures()
    for name in ("reflector-search", "open-loop"):
        night.stages[name] = CellStage(name, True, "next", "", "", words=("run", name))
    night.effects["reflector-search"] = [Effect(code=3, text="no answer")]
    stages: list[dict[str, object]] = [
        {"name": "reflector-search", "on_failure": "go-on"},
        {"name": "open-loop"},
    ]
    ended = await night.conduct(night.campaign(*stages))
    assert verdicts(ended)["open-loop"] == ("not-done", "waits-for")
    assert "counts only after one of reflector-search" in ended.stages[1].text
    assert (ended.code, ended.exit_code) == ("device", 3)


async def test_a_lost_device_is_tried_again(night: Night) -> None:
    night.effects["search"] = [Effect(code=3, text="no answer"), Effect(code=3, text="no answer")]
    ended = await night.conduct(night.campaign({**SEARCH, "retries": 2, "retry_after_s": 30.0}))
    assert ended.verdict == "passed"
    assert ended.stages[0].tries == 3
    assert [event.attempt for event in night.events if isinstance(event, StageStarted)] == [1, 2, 3]
    assert night.clock.time_s >= 60.0


async def test_a_limit_names_value_and_uncertainty(night: Night) -> None:
    night.document = {"found": {"reflectors": [{"x_mm": {"value": 650.2, "u": 0.1}}]}}
    limit = {"value": "found.reflectors.*.x_mm", "max": 650.3, "guard_k": 2.0}
    ended = await night.conduct(night.campaign({**SEARCH, "limit": [limit]}))
    (judged,) = ended.stages[0].limits
    assert (ended.code, ended.exit_code) == ("limit", 1)
    assert (judged.value, judged.found, judged.u, judged.met) == (
        "found.reflectors.0.x_mm",
        650.2,
        0.1,
        False,
    )


async def test_a_missed_criterion_has_failed(night: Night) -> None:
    night.effects["search"] = [Effect(state="next", found="0.9 of ±0.2 mrad")]
    ended = await night.conduct(night.campaign(SEARCH, IDENTIFY))
    assert verdicts(ended)["search"] == ("failed", "criterion")
    assert ended.exit_code == 1


async def test_the_deadline_ends_the_stage_under_way(night: Night) -> None:
    night.effects["search"] = [Effect(waits=True)]
    loaded = night.campaign(SEARCH, IDENTIFY)
    deadline = Deadline(night.clock.now_utc() + timedelta(hours=1))
    job = asyncio.create_task(night.conduct(loaded, deadline))
    await until(lambda: bool(night.calls))
    while not job.done():
        night.clock.advance(60.0)
        await asyncio.sleep(0)
    ended = await job
    assert night.signals == [signal.SIGTERM]
    assert verdicts(ended) == {
        "search": ("not-done", "deadline"),
        "identify": ("not-done", "deadline"),
    }
    assert ended.exit_code == 4


async def test_a_stage_that_takes_too_long_is_ended(night: Night) -> None:
    night.effects["search"] = [Effect(waits=True)]
    job = asyncio.create_task(night.conduct(night.campaign({**SEARCH, "time_limit_s": 600.0})))
    await until(lambda: bool(night.calls))
    while not job.done():
        night.clock.advance(60.0)
        await asyncio.sleep(0)
    ended = await job
    assert (ended.code, ended.exit_code) == ("time-limit", 4)
    assert "600 s" in ended.text


async def test_sigterm_ends_stage_and_job(night: Night) -> None:
    night.effects["search"] = [Effect(waits=True)]
    job = asyncio.create_task(night.conduct(night.campaign(SEARCH, IDENTIFY)))
    await until(lambda: bool(night.calls))
    await asyncio.sleep(0)
    night.ending.deliver(signal.SIGTERM)
    ended = await job
    assert night.signals == [signal.SIGTERM]
    assert {code for _, code in verdicts(ended).values()} == {"terminated"}
    assert ended.exit_code == 143


async def test_ctrl_c_belongs_to_the_run_under_way(night: Night) -> None:
    night.effects["search"] = [Effect(waits=True)]
    job = asyncio.create_task(night.conduct(night.campaign(SEARCH, IDENTIFY)))
    await until(lambda: bool(night.calls))
    await asyncio.sleep(0)
    night.ending.deliver(signal.SIGINT)
    ended = await job
    assert night.signals == [signal.SIGINT]
    assert [words[1] for words in night.calls] == ["search"]
    assert ended.exit_code == 130


async def test_a_run_left_by_a_killed_job_is_waited_for(night: Night) -> None:
    night.runs = [CellRun("20260102T030405Z_search_abcdef", "search", "running", 0.0, False)]
    job = asyncio.create_task(night.conduct(night.campaign(SEARCH)))
    await until(lambda: night.clock.time_s > 3.0)
    assert night.calls == []
    night.runs = [CellRun("20260102T030405Z_search_abcdef", "search", "stopped", 0.0, True)]
    assert (await job).verdict == "passed"


async def test_a_run_that_never_ends_is_busy(night: Night) -> None:
    night.runs = [CellRun("20260102T030405Z_search_abcdef", "search", "running", 0.0, False)]
    ended = await night.conduct(night.campaign(SEARCH))
    assert (ended.code, ended.exit_code) == ("busy", 4)
    assert night.calls == []


async def test_a_killed_process_is_named_by_its_signal(night: Night) -> None:
    night.effects["search"] = [Effect(code=-9)]
    ended = await night.conduct(night.campaign(SEARCH))
    assert verdicts(ended)["search"] == ("not-done", "killed")
    assert "signal 9" in ended.text


async def test_a_command_of_its_own_takes_the_result(night: Night) -> None:
    own = {"name": "change alarm", "command": ["compare", "base.json", "{result}", "--limit-u", "3"]}
    await night.conduct(night.campaign(SEARCH, IDENTIFY, own))
    assert len(night.calls) == 2
    file = night.folder / "result-abcdef.json"
    night.stages["identify"] = night.stages["identify"].__class__(
        "identify", False, "done", "", "", words=("identify",), runs=("r_abcdef",), files=(file,)
    )
    ended = await night.conduct(night.campaign(SEARCH, IDENTIFY, own))
    assert night.calls[-1] == ("compare", "base.json", str(file), "--limit-u", "3", "--json")
    assert ended.verdict == "passed"


async def test_a_model_beside_the_result_is_not_taken(night: Night) -> None:
    own = {"name": "change alarm", "command": ["compare", "base.json", "{result}"]}
    result, beside = night.folder / "result-abcdef.json", night.folder / "conventional-abcdef.json"
    done = replace(night.stages["identify"], state="done", runs=("r_abcdef",))
    night.stages["identify"] = replace(done, files=(result,), results=(result,))
    night.stages["conventional"] = replace(done, name="conventional", files=(beside,))
    await night.conduct(night.campaign(own))
    assert night.calls == [("compare", "base.json", str(result), "--json")]


async def test_the_verdict_stands_in_the_folder_of_the_job(night: Night) -> None:
    ended = await night.conduct(night.campaign(SEARCH))
    written = (night.folder / "jobs/n1/verdict.json").read_text()
    assert CampaignEnded.model_validate_json(written) == ended
    assert isinstance(night.events[-1], CampaignEnded)
    assert [type(event) for event in night.events[1:3]] == [StageStarted, StageEnded]


async def test_a_record_that_cannot_be_written_ends_the_job(
    night: Night, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_job: Job) -> None:
        raise StorageError("job.json: cannot be written: No space left on device")

    night.effects["search"] = [Effect(then=lambda: monkeypatch.setattr(Job, "save", full))]
    ended = await night.conduct(night.campaign(SEARCH, IDENTIFY))
    assert verdicts(ended)["search"] == ("not-done", "storage")
    assert (ended.code, ended.exit_code) == ("storage", 6)
    assert night.events[-1] == ended


async def test_a_verdict_that_cannot_be_kept_is_no_pass(
    night: Night, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_job: Job, _verdict: CampaignEnded) -> None:
        raise StorageError("verdict.json: cannot be written: No space left on device")

    monkeypatch.setattr(Job, "ended", full)
    ended = await night.conduct(night.campaign(SEARCH))
    assert (ended.verdict, ended.code, ended.exit_code) == ("not-done", "storage", 6)


async def test_a_file_that_cannot_be_read_ends_with_a_verdict(
    night: Night, monkeypatch: pytest.MonkeyPatch
) -> None:
    (night.folder / "points.csv").write_text("a")

    def refuse(_file: object, _name: str) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(hashlib, "file_digest", refuse)
    ended = await night.conduct(night.campaign({**SEARCH, "params": {"points": "points.csv"}}))
    assert (ended.verdict, ended.code, ended.exit_code) == ("not-done", "storage", 6)
    assert "points.csv: cannot be read: Permission denied" in ended.text


@pytest.mark.parametrize("looks", [0, 1, 2, 3])
async def test_a_cell_that_cannot_be_read_ends_with_a_verdict(night: Night, looks: int) -> None:
    """A look comes before the first stage, after each of two, and before what no longer holds is looked for."""
    night.looks_fail = [*([None] * looks), ConfigError("cell.toml: is gone")]
    ended = await night.conduct(night.campaign(SEARCH, IDENTIFY))
    last = night.events[-1]
    assert ended is last
    assert (ended.verdict, ended.code, ended.exit_code) == ("not-done", "usage", 2)
    assert "cell.toml: is gone" in ended.text
    assert CampaignEnded.model_validate_json((night.folder / "jobs/n1/verdict.json").read_bytes()) == ended


async def test_a_fault_of_the_program_has_a_verdict(night: Night) -> None:
    def fail() -> None:
        raise ZeroDivisionError("by nothing")

    night.effects["identify"] = [Effect(then=fail)]
    with pytest.raises(ZeroDivisionError):
        await night.conduct(night.campaign(SEARCH, IDENTIFY))
    ended = night.events[-1]
    assert isinstance(ended, CampaignEnded)
    assert verdicts(ended) == {"search": ("passed", "passed"), "identify": ("not-done", "fault")}
    assert (ended.verdict, ended.code, ended.exit_code) == ("not-done", "fault", 70)
    assert "ZeroDivisionError: by nothing" in ended.text
    assert CampaignEnded.model_validate_json((night.folder / "jobs/n1/verdict.json").read_bytes()) == ended


async def test_a_stage_that_left_the_way_ends_the_job(night: Night) -> None:
    def leave() -> None:
        del night.stages["identify"]

    night.effects["search"] = [Effect(then=leave)]
    ended = await night.conduct(night.campaign(SEARCH, IDENTIFY))
    assert verdicts(ended) == {"search": ("passed", "passed"), "identify": ("not-done", "usage")}


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
async def test_a_signal_between_two_tries_is_the_cause(night: Night, number: int) -> None:
    night.effects["search"] = [Effect(code=3, text="no answer")]
    conducting = asyncio.create_task(
        night.conduct(night.campaign({**SEARCH, "retries": 5, "retry_after_s": 1.0}))
    )
    await until(lambda: bool(night.calls))
    night.ending.deliver(number)
    ended = await conducting
    assert verdicts(ended)["search"] == ("not-done", "terminated")
    assert ended.exit_code == 143


async def test_an_end_while_waiting_for_a_run_has_its_cause(night: Night) -> None:
    night.runs = [
        CellRun("20260102T030405Z_search_abcdef", "search", "running", 1.0, resumable=False, job="n1")
    ]
    conducting = asyncio.create_task(night.conduct(night.campaign(SEARCH), wait_lock_s=1e9))
    await until(lambda: night.clock.time_s > 3.0)
    night.ending.deliver(signal.SIGTERM)
    assert verdicts(await conducting)["search"] == ("not-done", "terminated")


async def test_nothing_begins_once_the_job_has_ended(night: Night) -> None:
    """The run of before ends in the same second as the job that waits for it."""
    run = CellRun("20260102T030405Z_search_abcdef", "search", "running", 1.0, resumable=False, job="n1")
    night.runs = [run]
    conducting = asyncio.create_task(night.conduct(night.campaign(SEARCH)))
    await until(lambda: night.clock.time_s > 3.0)
    night.runs = [replace(run, status="stopped")]
    night.ending.deliver(signal.SIGTERM)
    assert verdicts(await conducting)["search"] == ("not-done", "terminated")
    assert night.calls == []


async def test_an_ended_job_leaves_further_runs_to_do(night: Night) -> None:
    def end() -> None:
        words = ("identify", "bcdef0", "-o", "result-bcdef0.json")
        night.stages["identify"] = replace(night.stages["identify"], words=words)
        night.ending.deliver(signal.SIGTERM)

    night.effects["identify"] = [Effect(state="next", then=end)]
    ended = await night.conduct(night.campaign(SEARCH, IDENTIFY))
    assert verdicts(ended)["identify"] == ("not-done", "terminated")
    assert [words[1] for words in night.calls[1:]] == ["abcdef"]


async def test_work_that_waits_in_vain_is_a_usage_fault(night: Night) -> None:
    ended = await night.conduct(night.campaign(IDENTIFY))
    assert (ended.verdict, ended.code, ended.exit_code) == ("not-done", "waits-for", 2)


async def test_a_clock_set_back_fails_no_work_on_data(night: Night) -> None:
    """The list of the day takes the older file for one that was made before; the command has said that it is done."""
    night.effects["identify"] = [Effect(state="next")]
    ended = await night.conduct(night.campaign(SEARCH, IDENTIFY))
    assert ended.verdict == "passed"


async def test_stages_of_like_names_keep_documents_apart(night: Night) -> None:
    loaded = night.campaign({"name": "a b", "command": ["show"]}, {"name": "a-b", "command": ["show"]})
    night.effects["show"] = [Effect(out='{"a": 1}'), Effect(out='{"a": 2}')]
    await night.conduct(loaded)
    folder = night.folder / "jobs/n1"
    kept = [document_file(folder, entry).read_text() for entry in loaded.campaign.stage]
    assert kept == ['{"a": 1}', '{"a": 2}']
