"""A run that is held says why for as long as it is."""

import asyncio

from catseye.app.engine.control import RunControl
from catseye.app.protocol.state import ControlState
from tests.unit.app.engine.fakes import ManualClock


async def test_a_held_run_says_who_or_what_holds_it() -> None:
    entered: list[tuple[ControlState, str]] = []
    control = RunControl(ManualClock(), lambda state, reason: entered.append((state, reason)))
    control.starting()
    control.started()
    control.hold("Ada (tui-1), who held control, is lost")
    held = asyncio.create_task(control.checkpoint())
    await asyncio.sleep(0)
    assert entered[-1] == (ControlState.HELD, "at a checkpoint: Ada (tui-1), who held control, is lost")
    control.unhold("Bob")
    await held
    assert control.state == ControlState.EXECUTE
