"""The progress line before the engine's first word of it, and while a run stands without a question."""

import pytest

from catseye.app.protocol.rehearsal import Rehearsal
from catseye.app.tui.run_state import SoFar
from tests.unit.app.tui.scripted import ScriptedLink, shown, started
from tests.unit.app.tui.scripted_run import REHEARSAL, RUN, publish


def begin(link: ScriptedLink) -> None:
    link.publish("run-started", procedure="warmup", title="Warm-up", run=RUN)
    publish(link, "state", state="EXECUTE", reason="devices are ready")
    assert link.engine.run is not None
    link.engine.run.take_rehearsal(Rehearsal.model_validate_json(REHEARSAL.out))


async def test_the_rehearsal_gives_the_time_left_before_any_progress() -> None:
    async with started(screen="run") as (app, pilot, link):
        begin(link)
        link.now_s += 2.0
        text = await shown(app, pilot)
        # 2 of 5.2 s.
        assert " 38 %" in text
        assert "left 3.2 s, as rehearsed" in text
        link.now_s += 10.0
        # How far it is nobody knows then.
        text = await shown(app, pilot)
        assert "longer than rehearsed" in text
        assert " 100 %" not in text


async def test_time_alone_never_makes_a_hundred_percent() -> None:
    async with started(screen="run") as (app, pilot, link):
        begin(link)
        # The bench takes ten times as long as rehearsed: 1 of 5.2 s of the plan took 10 s.
        publish(
            link,
            "progress",
            done=1.0,
            total=5.2,
            text="",
            elapsed_bench_s=10.0,
            left_bench_s=42.0,
            elapsed_s=10.0,
            left_s=42.0,
        )
        link.now_s += 21.0
        assert " 60 %" in await shown(app, pilot)
        link.now_s += 60.0
        assert " 99 %" in await shown(app, pilot)


async def test_a_resumed_run_expects_the_rest_alone() -> None:
    async with started(screen="run") as (app, pilot, link):
        link.publish("run-started", procedure="open-loop", title="Measurement", run=RUN)
        publish(link, "state", state="EXECUTE", reason="devices are ready")
        assert link.engine.run is not None
        link.engine.run.take_record(SoFar([("P1/0000", "P1: first"), ("P1/0001", "P1: second")], 2, []))
        link.engine.run.take_rehearsal(Rehearsal.model_validate_json(REHEARSAL.out))
        # 5.2 s in all, two steps of 1.3 s are done.
        text = await shown(app, pilot)
        assert "left 2.6 s, as rehearsed" in text
        assert "2 of 8 steps" in text


@pytest.mark.parametrize(("step", "said"), [("more/1", "1 of 9 steps"), ("P1/0000", "1 of 8 steps")])
async def test_steps_beyond_the_rehearsal_count(step: str, said: str) -> None:
    async with started(screen="run") as (app, pilot, link):
        begin(link)
        publish(link, "step-done", step=step, title="one more round", stored=False)
        assert said in await shown(app, pilot)


async def test_a_complete_run_lacks_no_rehearsed_step() -> None:
    async with started(screen="run") as (app, pilot, link):
        begin(link)
        publish(link, "step-done", step="P1/0000", title="first", stored=False)
        publish(link, "run-ended", status="complete", exit_code=0, text="", path="", drives_on=False)
        text = await shown(app, pilot)
        assert "1 step" in text
        assert "of 8 steps" not in text


async def test_time_stands_while_a_run_is_held_or_suspended() -> None:
    async with started(screen="run") as (app, pilot, link):
        begin(link)
        for state, said in (("HELD", "held: 42 s"), ("SUSPENDED", "suspended: 42 s")):
            publish(link, "state", state=state, reason="somebody")
            link.now_s += 42.0
            text = await shown(app, pilot)
            assert said in text
            assert "left 5.2 s" in text
            publish(link, "state", state="EXECUTE", reason="goes on")
            assert "left 5.2 s" in await shown(app, pilot)
        publish(
            link,
            "progress",
            done=2.6,
            total=5.2,
            text="",
            elapsed_bench_s=2.6,
            left_bench_s=2.6,
            elapsed_s=2.6,
            left_s=2.6,
        )
        text = await shown(app, pilot)
        assert " 50 %" in text
        assert "as rehearsed" not in text


async def test_more_time_than_rehearsed_says_so() -> None:
    async with started(screen="run", size=(120, 40)) as (app, pilot, link):
        begin(link)
        publish(
            link,
            "progress",
            done=1.0,
            total=5.2,
            text="",
            elapsed_bench_s=10.0,
            left_bench_s=40.0,
            elapsed_s=10.0,
            left_s=40.0,
        )
        assert "left 40 s, 45 s more than expected" in await shown(app, pilot)


async def test_a_run_joined_later_is_not_reckoned_from_then() -> None:
    async with started({"run": RUN, "procedure": "warmup", "title": "", "state": "EXECUTE"}, "run") as (
        app,
        pilot,
        link,
    ):
        assert link.engine.run is not None
        link.engine.run.rehearsal = Rehearsal.model_validate_json(REHEARSAL.out)
        assert "as rehearsed" not in await shown(app, pilot)
