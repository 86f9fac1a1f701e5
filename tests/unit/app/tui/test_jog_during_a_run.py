"""F8 on the screen Jog while a run is under way."""

from tests.unit.app.tui.scripted import shown, started
from tests.unit.app.tui.scripted_bench import BENCH
from tests.unit.app.tui.scripted_run import SNAPSHOT


async def test_jogging_during_a_run_is_refused_without_any_request() -> None:
    async with started(
        {**SNAPSHOT, "control": {"client": "attach-2", "who": "Bob"}}, "jog", notifications=True
    ) as (app, pilot, link):
        link.publish("bench", **BENCH)
        await shown(app, pilot)
        await pilot.press("f8")
        await app.workers.wait_for_complete()
        assert "a run is under way: jog when it has ended" in await shown(app, pilot)
        assert link.asked == []
