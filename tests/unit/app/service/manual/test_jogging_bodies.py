"""Moving by hand does not move into a body: neither a step nor a joint that is kept moving."""

import asyncio
import math

import pytest

from catseye.app.cell.model import Cell
from catseye.app.service.errors import RefusedError
from catseye.app.service.manual.jogging import Jogging
from tests.unit.app.service.manual.jogs import alive, fed, hold, jogged, nothing, step
from tests.unit.app.service.manual.timed_arm import HOME, ManualFixture, TimedArm


@pytest.fixture
def walled(cell: Cell) -> Cell:
    """Return a cell with a stand where J1 brings the head at 30 deg."""
    turn = math.radians(30.0)
    place = {"x_mm": 550.0 * math.cos(turn), "y_mm": 550.0 * math.sin(turn)}
    return cell.model_copy(update={"reflector": [cell.reflector[0].model_copy(update=place)]})


def test_a_step_into_a_stand_is_refused(walled: Cell) -> None:
    async def script(_fixture: ManualFixture, jog: Jogging) -> None:
        with pytest.raises(RefusedError, match=r"the stand of reflector P1 stands in the arm's way"):
            await alive(jog, step(joint="j1", by=60.0))
        await alive(jog, step(joint="j1", by=5.0))

    assert len(jogged(walled, script).arm.said("move")) == 1


@pytest.mark.parametrize("speed_deg_s", [1.0, 20.0])
def test_a_hold_stops_ahead_of_a_stand(walled: Cell, speed_deg_s: float) -> None:
    async def script(fixture: ManualFixture, jog: Jogging) -> None:
        with pytest.raises(RefusedError, match=r"too near to its limit.*the stand of reflector P1"):
            await fed(jog, 100.0, hold("j1", 1))
        j1_deg = (await fixture.arm.joints())[0]
        # Head, stand and clearance take 50 mm of an arc of 550 mm; a degree and the doubt about the speed are left.
        met_deg = 30.0 - math.degrees(2.0 * math.asin(25.0 / 550.0))
        assert 1.0 <= met_deg - j1_deg < 2.0 + 0.5 * speed_deg_s + 0.5
        away = jog.hold(hold("j1", -1))
        assert isinstance(away, asyncio.Future)
        await away

    fixture = jogged(walled, script, TimedArm(speed_deg_s=speed_deg_s, pose=HOME))
    assert fixture.events("error") == []


def test_an_arm_inside_a_body_is_not_moved(walled: Cell) -> None:
    async def script(_fixture: ManualFixture, jog: Jogging) -> None:
        with pytest.raises(RefusedError, match="move it away with the teach pendant"):
            await jog.hold(hold("j1", 1))  # type: ignore[misc]  # the first feed is answered later

    inside = jogged(walled, script, TimedArm(pose=(30.0, *HOME[1:])))
    assert inside.arm.said("jog", "move") == []


def test_a_real_arm_names_what_nobody_has_confirmed(cell: Cell) -> None:
    fixture = jogged(cell, nothing, TimedArm(simulated=False), arm=cell.name)
    assert any(
        "uses unconfirmed dimensions: base column" in str(event["text"])
        for event in fixture.events("warning")
    )
