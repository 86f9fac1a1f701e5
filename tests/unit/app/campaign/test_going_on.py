"""A job that exists goes on: what holds stays, what is another work now is done again."""

from collections.abc import Callable
from dataclasses import replace

from catseye.app.campaign.job import Job
from catseye.app.results.readiness.cell_runs import CellRun
from tests.unit.app.campaign.night import IDENTIFY, REPORT, SEARCH, Effect, Night, verdicts


async def test_a_job_that_exists_does_what_is_left(night: Night) -> None:
    loaded = night.campaign(SEARCH, IDENTIFY, REPORT)
    night.effects["identify"] = [Effect(code=6, text="the disk is full")]
    first = await night.conduct(loaded)
    assert verdicts(first)["identify"] == ("not-done", "storage")
    assert verdicts(first)["report"] == ("not-done", "waits-for")
    assert first.exit_code == 6
    night.calls.clear()
    second = await night.conduct(loaded)
    assert second.verdict == "passed"
    assert [words[0] for words in night.calls] == ["identify", "report"]
    assert second.started == first.started
    assert second.stages[1].tries == 2


async def test_a_lost_stage_and_all_after_it_are_done_anew(night: Night) -> None:
    night.effects["report"] = [Effect(then=lambda: night.lose("search", "bench restarted since"))]
    ended = await night.conduct(night.campaign(SEARCH, IDENTIFY, REPORT))
    assert [words[0] for words in night.calls] == ["run", "identify", "report"] * 2
    assert ended.verdict == "passed"


async def test_a_job_that_goes_on_has_no_verdict_meanwhile(night: Night) -> None:
    file = night.folder / "jobs/n1/verdict.json"
    night.effects["identify"] = [Effect(code=6), Effect(then=lambda: there.append(file.exists()))]
    there: list[bool] = []
    loaded = night.campaign(SEARCH, IDENTIFY)
    await night.conduct(loaded)
    assert file.exists()
    await night.conduct(loaded)
    assert there == [False]
    assert file.exists()


async def test_a_clock_set_back_makes_nothing_newer(night: Night) -> None:
    own = {"name": "change alarm", "command": ["compare", "base.json", "other.json"]}
    loaded = night.campaign(SEARCH, own, REPORT)
    night.effects["report"] = [Effect(code=6)]
    await night.conduct(loaded)
    night.lose("search", "bench restarted since")
    night.clock.advance(-3600.0)
    night.calls.clear()
    await night.conduct(loaded)
    assert [words[0] for words in night.calls[:2]] == ["run", "compare"]


def leaves_a_run(night: Night, words: tuple[str, ...], code: int, text: str) -> None:
    """Let the search end with a code and leave a run that can be resumed."""

    def leave() -> None:
        night.stages["search"] = replace(night.stages["search"], words=words)
        night.runs = [CellRun(words[1], "search", "stopped", 1.0, resumable=True, job="n1")]

    night.effects["search"] = [Effect(code=code, text=text, then=leave)]


async def test_a_rejected_run_is_not_gone_on_with(night: Night) -> None:
    loaded = night.campaign(SEARCH)
    words = ("resume", "20260102T030405Z_search_abcdef", "--runs", "r")
    leaves_a_run(night, words, 1, "P3 was found from 1 pose")
    await night.conduct(loaded)
    await night.conduct(loaded)
    assert night.calls[1][:6] == ("run", "search", "--cell", "cell.toml", "--runs", "r")


async def test_a_run_that_a_device_ended_goes_on(night: Night) -> None:
    loaded = night.campaign(SEARCH)
    words = ("resume", "20260102T030405Z_search_abcdef")
    leaves_a_run(night, words, 3, "no answer")
    await night.conduct(loaded)
    await night.conduct(loaded)
    assert night.calls[1][:2] == words


def interrupted(night: Night, job: str) -> None:
    """Let the search have a run that was interrupted."""
    run = CellRun("20260102T030405Z_search_abcdef", "search", "stopped", 60.0, resumable=True, job=job)
    night.runs = [run]
    night.stages["search"] = replace(night.stages["search"], words=("resume", run.name))


async def test_a_run_of_another_job_is_never_resumed(night: Night) -> None:
    interrupted(night, "n0")
    await night.conduct(night.campaign({**SEARCH, "params": {"step_deg": 1}}, reuse="cell"))
    assert night.calls[0][:7] == ("run", "search", "--cell", "cell.toml", "--job", "n1", "--param")


async def test_an_interrupted_run_of_the_job_goes_on(night: Night) -> None:
    interrupted(night, "n1")
    await night.conduct(night.campaign(SEARCH, reuse="cell"))
    assert night.calls[0][:2] == ("resume", "20260102T030405Z_search_abcdef")


async def test_other_parameters_make_a_stage_anew(night: Night) -> None:
    await night.conduct(night.campaign(SEARCH, IDENTIFY))
    night.calls.clear()
    limit = {"value": "found", "max": 1.0}
    await night.conduct(night.campaign({**SEARCH, "retries": 3}, {**IDENTIFY, "limit": [limit]}))
    assert night.calls == [], "limits and retries are no other work"
    await night.conduct(night.campaign({**SEARCH, "params": {"step_deg": 2}}, IDENTIFY))
    assert [words[0] for words in night.calls] == ["run"]


async def test_another_file_beside_the_campaign_is_other_work(night: Night) -> None:
    path = night.folder / "points.csv"
    loaded = night.campaign({**SEARCH, "params": {"points": "points.csv"}})
    for text, times in (("a", 1), ("a", 1), ("b", 2)):
        path.write_text(text)
        await night.conduct(loaded)
        assert len(night.calls) == times


async def test_a_job_that_has_passed_is_not_touched(night: Night) -> None:
    loaded = night.campaign(SEARCH)
    await night.conduct(loaded)
    path = night.folder / "jobs/n1/job.json"
    before = path.stat().st_mtime_ns, path.read_bytes()
    opened = Job.opened(night.folder, "n1", loaded, "lab-1", night.clock.now_utc())
    assert opened.record.passed
    assert (path.stat().st_mtime_ns, path.read_bytes()) == before
    changed = replace(loaded, sha256="cd" * 32)
    assert not Job.opened(night.folder, "n1", changed, "lab-1", night.clock.now_utc()).record.passed


async def test_work_on_several_runs_is_done_for_each(night: Night) -> None:
    def wait(run: str) -> Callable[[], None]:
        words = ("identify", run, "-o", f"result-{run}.json")
        return lambda: night.stages.update(identify=replace(night.stages["identify"], words=words))

    night.effects["identify"] = [
        Effect(state="next", then=wait("bcdef0")),
        Effect(state="next", then=wait("cdef01")),
        Effect(),
    ]
    ended = await night.conduct(night.campaign(SEARCH, IDENTIFY))
    assert ended.verdict == "passed"
    assert [words[1] for words in night.calls[1:]] == ["abcdef", "bcdef0", "cdef01"]


async def test_other_options_are_for_every_run(night: Night) -> None:
    await night.conduct(night.campaign(SEARCH, IDENTIFY))
    runs = ("20260102T030405Z_search_abcdef", "20260102T040506Z_search_bcdef0")
    night.stages["identify"] = replace(night.stages["identify"], runs=runs)
    night.calls.clear()
    await night.conduct(night.campaign(SEARCH, {**IDENTIFY, "options": {"model": "error-map"}}))
    assert [words[:4] for words in night.calls] == [
        ("identify", "abcdef", "-o", "result-abcdef.json"),
        ("identify", "bcdef0", "-o", "result-bcdef0.json"),
    ]


async def test_a_fault_at_one_of_several_runs_ends_the_stage(night: Night) -> None:
    words = ("identify", "bcdef0", "-o", "result-bcdef0.json")
    night.effects["identify"] = [
        Effect(
            state="next",
            then=lambda: night.stages.update(identify=replace(night.stages["identify"], words=words)),
        ),
        Effect(code=1, text="it does not fit"),
    ]
    ended = await night.conduct(night.campaign(SEARCH, IDENTIFY))
    assert verdicts(ended)["identify"] == ("failed", "rejected")
