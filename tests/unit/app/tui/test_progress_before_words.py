"""The progress line before the engine's first word of it, and while a run stands without a question."""

from catseye.app.protocol.rehearsal import Rehearsal
from tests.unit.app.tui.scripted import ScriptedLink, shown, started
from tests.unit.app.tui.scripted_run import REHEARSAL, RUN, publish


def begin(link: ScriptedLink) -> None:
    link.publish("run-started", procedure="warmup", title="Warm-up", run=RUN)
    publish(link, "state", state="EXECUTE", reason="devices are ready")
    assert link.engine.run is not None
    link.engine.run.rehearsal = Rehearsal.model_validate_json(REHEARSAL.out)


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


async def test_a_run_joined_later_is_not_reckoned_from_then() -> None:
    async with started({"run": RUN, "procedure": "warmup", "title": "", "state": "EXECUTE"}, "run") as (
        app,
        pilot,
        link,
    ):
        assert link.engine.run is not None
        link.engine.run.rehearsal = Rehearsal.model_validate_json(REHEARSAL.out)
        assert "as rehearsed" not in await shown(app, pilot)
