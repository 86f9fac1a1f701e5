"""Ctrl-C and F12 in the terminal UI, against the one table that the engine climbs by."""

from catseye.app.protocol.ladder import Rung, rung_of, top_text
from catseye.app.protocol.requests import AnyRequest, Plain
from catseye.app.protocol.state import ControlState
from catseye.app.service.errors import RefusedError
from tests.unit.app.tui.scripted import ScriptedLink, make_app, shown

RUN = {"run": "20261121T090000Z_open-loop_abc123", "procedure": "open-loop", "title": "Open loop"}


class ClimbingEngine(ScriptedLink):
    """Answers `ladder` as an engine does: by the state that it is in, which the screen may not know yet.

    Attributes:
        state: of the run.
        rungs: that were taken, in order.
    """

    def __init__(self, state: ControlState = ControlState.EXECUTE) -> None:
        super().__init__({**RUN, "state": "EXECUTE"})
        self.state = state
        self.rungs: list[Rung] = []

    async def request(self, request: AnyRequest) -> None:
        """Climb a rung, or refuse it where there is none."""
        await super().request(request)
        if request == Plain(op="ladder"):
            rung = rung_of(self.state)
            if rung is None:
                raise RefusedError(top_text(self.state))
            self.rungs.append(rung)


async def test_ctrl_c_takes_the_rung_of_every_state() -> None:
    engine = ClimbingEngine()
    app = make_app(engine)
    async with app.run_test(size=(80, 24)) as pilot:
        for state in ControlState:
            engine.state, engine.rungs = state, []
            engine.publish("state", run=RUN["run"], state=state, reason="")
            await pilot.press("ctrl+c")
            await pilot.pause()
            expected = rung_of(state)
            assert engine.rungs == ([] if expected is None else [expected]), state


async def test_f12_stops_in_every_state() -> None:
    engine = ClimbingEngine()
    app = make_app(engine)
    async with app.run_test(size=(80, 24)) as pilot:
        for state in ControlState:
            engine.publish("state", run=RUN["run"], state=state, reason="")
            await pilot.press("f12")
            await pilot.pause()
        assert engine.ops == ["stop"] * len(ControlState)


async def test_two_quick_presses_climb_two_rungs() -> None:
    engine = ClimbingEngine(ControlState.EXECUTE)
    app = make_app(engine)
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("ctrl+c")
        await pilot.pause()
        # The engine holds already, and no event has said so yet.
        engine.state = ControlState.HOLDING
        await pilot.press("ctrl+c")
        await pilot.pause()
    assert engine.rungs == [Rung.HOLD, Rung.STOP]


async def test_above_an_abort_there_is_only_the_emergency_stop() -> None:
    engine = ClimbingEngine(ControlState.ABORTING)
    app = make_app(engine)
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("ctrl+c")
        await shown(app, pilot)
        notes = [note.message for note in app._notifications]  # noqa: SLF001  # what was shown
        assert any("use the emergency stop" in note for note in notes), notes


async def test_ctrl_c_drops_a_run_that_is_being_planned() -> None:
    link = ScriptedLink()
    app = make_app(link)
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("ctrl+c")
        await pilot.pause()
        assert link.ops == []
        app.begins = True
        await pilot.press("ctrl+c")
        await pilot.pause()
        assert link.ops == ["ladder"]
