"""What Ctrl-C says in the terminal UI; what it does, `test_every_front_end` has in a table."""

from catseye.app.protocol.ladder import top_text
from catseye.app.protocol.state import ControlState
from tests.unit.app.tui.scripted import ScriptedLink, make_app, shown, started

RUN = {"run": "20261121T090000Z_open-loop_abc123", "procedure": "open-loop", "title": "Open loop"}


async def test_above_an_abort_there_is_only_the_emergency_stop() -> None:
    link = ScriptedLink({**RUN, "state": "ABORTING"})
    link.refusals["ladder"] = top_text(ControlState.ABORTING)
    app = make_app(link)
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("ctrl+c")
        await shown(app, pilot)
        notes = [note.message for note in app._notifications]  # noqa: SLF001  # what was shown
        assert any("use the emergency stop" in note for note in notes), notes


async def test_ctrl_c_drops_a_run_that_is_being_planned() -> None:
    async with started() as (app, pilot, link):
        await pilot.press("ctrl+c")
        await pilot.pause()
        assert link.ops == []
        app.begins = True
        await pilot.press("ctrl+c")
        await pilot.pause()
        assert link.ops == ["ladder"]
