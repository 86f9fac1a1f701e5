"""The speed override that a jog leaves goes back by a person's word, to what stood before and no higher."""

from dataclasses import replace

import pytest

from catseye.app.protocol.requests import ResetAlarm, RestoreOverride
from catseye.app.service.errors import RefusedError
from catseye.app.service.walk.walk import WalkedOverride
from catseye.drivers.roles.robot import RobotStatus
from tests.unit.app.service.manual.played_engine import Engine, played


def stands(engine: Engine, percent: float) -> None:
    engine.arm.state = replace(engine.arm.state, override_percent=percent)


def overrides(engine: Engine) -> float:
    return engine.arm.state.override_percent


async def jog_once(engine: Engine) -> None:
    """Jog at the 5 % of the request; the cell allows 20 %."""
    await engine.jog()
    await engine.jog(on=False)


@pytest.mark.parametrize(("before", "back"), [(12.0, 12.0), (20.0, 20.0), (100.0, 20.0)])
def test_it_goes_back_to_what_stood_before_or_the_cap(
    before: float, back: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def script(engine: Engine) -> None:
        stands(engine, before)
        await jog_once(engine)
        assert overrides(engine) == 5.0
        await engine.manual.restore_override(RestoreOverride(percent=back), "Ada")
        assert overrides(engine) == back
        with pytest.raises(RefusedError, match="did not stand before a jog or a walk"):
            await engine.manual.restore_override(RestoreOverride(percent=back), "Ada")

    left = played(script, monkeypatch).fixture.events("override-left")
    assert [each["left"] for each in left] == [{"before_percent": back, "left_percent": 5.0}, None]


def test_no_other_percentage_is_set(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        stands(engine, 12.0)
        await jog_once(engine)
        for percent in (13.0, 20.0, 100.0, 11.0):
            with pytest.raises(RefusedError, match="did not stand before a jog or a walk"):
                await engine.manual.restore_override(RestoreOverride(percent=percent), "Ada")
        assert overrides(engine) == 5.0

    played(script, monkeypatch)


@pytest.mark.parametrize("changed", [3.0, 8.0])
def test_an_override_that_somebody_has_changed_stays(changed: float, monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        stands(engine, 12.0)
        await jog_once(engine)
        stands(engine, changed)
        with pytest.raises(RefusedError, match="somebody has changed it since, and it stays"):
            await engine.manual.restore_override(RestoreOverride(percent=12.0), "Ada")
        assert overrides(engine) == changed

    left = played(script, monkeypatch).fixture.events("override-left")
    assert left[-1]["left"] is None


def test_nothing_is_set_while_a_controller_program_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        stands(engine, 12.0)
        await jog_once(engine)
        running = replace(engine.arm.state, running=True)

        async def status() -> RobotStatus:
            return running

        monkeypatch.setattr(engine.arm, "status", status)
        with pytest.raises(RefusedError, match="the arm moves, or a program runs: the override stays"):
            await engine.manual.restore_override(RestoreOverride(percent=12.0), "Ada")
        assert overrides(engine) == 5.0

    played(script, monkeypatch)


@pytest.mark.parametrize("pendant", [4.0, 8.0])
def test_a_jog_has_not_left_what_the_pendant_set(pendant: float, monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        stands(engine, 20.0)
        await engine.jog()
        stands(engine, pendant)
        await engine.jog(on=False)
        with pytest.raises(RefusedError, match="did not stand before a jog or a walk"):
            await engine.manual.restore_override(RestoreOverride(percent=20.0), "Ada")

    assert played(script, monkeypatch).fixture.events("override-left") == []


def test_a_cap_that_was_lowered_since_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        stands(engine, 100.0)
        await jog_once(engine)
        engine.fixture.facts_now = replace(engine.fixture.facts_now, override_cap_percent=10.0)
        with pytest.raises(RefusedError, match="the cell allows 10 % by now"):
            await engine.manual.restore_override(RestoreOverride(percent=20.0), "Ada")
        assert overrides(engine) == 5.0
        await engine.manual.restore_override(RestoreOverride(percent=10.0), "Ada")
        assert overrides(engine) == 10.0

    played(script, monkeypatch)


def test_several_jogs_lead_back_to_what_stood_before_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        stands(engine, 12.0)
        await jog_once(engine)
        # The second one finds 5 % and leaves it.
        await jog_once(engine)
        await engine.manual.restore_override(RestoreOverride(percent=12.0), "Ada")
        assert overrides(engine) == 12.0

    played(script, monkeypatch)


def test_after_a_walk_it_goes_back_likewise(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        stands(engine, 6.0)
        engine.manual.take_walked(WalkedOverride(12.0, 6.4, 6.0), 20.0)
        await jog_once(engine)
        for percent in (6.0, 20.0):
            with pytest.raises(RefusedError, match="did not stand before a jog or a walk"):
                await engine.manual.restore_override(RestoreOverride(percent=percent), "Ada")
        await engine.manual.restore_override(RestoreOverride(percent=12.0), "Ada")
        assert overrides(engine) == 12.0

    left = played(script, monkeypatch).fixture.events("override-left")
    assert left[0]["left"] == {"before_percent": 12.0, "left_percent": 6.0}


def test_an_override_of_zero_is_a_stops_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        stands(engine, 12.0)
        await engine.jog()
        stands(engine, 0.0)
        await engine.jog(on=False)

    assert played(script, monkeypatch).fixture.events("override-left") == []


def test_nothing_is_set_during_a_run_or_a_jog(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        stands(engine, 12.0)
        await jog_once(engine)
        engine.busy = RefusedError("a run is under way")
        with pytest.raises(RefusedError, match="a run is under way"):
            engine.manual.restore_override(RestoreOverride(percent=12.0), "Ada")
        engine.busy = None
        await engine.jog()
        with pytest.raises(RefusedError, match="moves the arm by hand"):
            engine.manual.restore_override(RestoreOverride(percent=12.0), "Ada")
        with pytest.raises(RefusedError, match="moves the arm by hand"):
            engine.manual.reset_alarm(ResetAlarm(number=1, text="one"), "Ada")
        assert overrides(engine) == 5.0

    played(script, monkeypatch)


def test_an_alarm_that_is_reset_is_said_to_everybody(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        async def reset() -> None:
            engine.arm.state = replace(engine.arm.state, alarm_number=0, alarm_text="")

        monkeypatch.setattr(engine.arm, "reset_alarm", reset)
        engine.arm.state = replace(engine.arm.state, alarm_number=50, alarm_text="external emergency stop")
        with pytest.raises(RefusedError, match="another alarm by now, 50"):
            await engine.manual.reset_alarm(ResetAlarm(number=2600, text="out of the range"), "Ada")
        await engine.manual.reset_alarm(ResetAlarm(number=50, text="external emergency stop"), "Ada")
        assert engine.fixture.owned_for == ["its alarm is reset"] * 2

    warnings = played(script, monkeypatch).fixture.events("warning")
    assert [each["text"] for each in warnings] == ["Ada has reset the alarm 50: external emergency stop"]
