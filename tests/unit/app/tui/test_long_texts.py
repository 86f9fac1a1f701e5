"""Texts longer than their place: what happened and what to do is read whole, and no key goes out of sight."""

import copy
from datetime import UTC, datetime, timedelta

import pytest

from catseye.app.tui.screens.run import RunScreen
from tests.unit.app.tui.screens.run_screen import run_screen
from tests.unit.app.tui.scripted import shown, started
from tests.unit.app.tui.scripted_bench import BENCH
from tests.unit.app.tui.scripted_run import ask, end, measure, publish
from tests.unit.app.tui.test_stale_looks import with_dead

LINK = "tcp://192.168.0.20:10001: cannot connect (Connection refused): check that the instrument is switched on; "
CAUSE = "PRESS THE EMERGENCY STOP: standstill is not confirmed; " + 9 * LINK + "and that is the end of it"
LASER = (
    "the laser is not ready: it is warming up or has lost its lock, and the count is worthless; look at the "
    "laser's lamp. The run continues by itself when it is ready"
)


def in_one(text: str) -> str:
    """Return the words of a screen, whatever line they stand in."""
    return " ".join(text.replace("│", " ").replace("┃", " ").split())


async def test_a_long_question_scrolls_while_its_keys_stay_visible() -> None:
    async with run_screen() as (app, pilot, link):
        measure(link)
        ask(link, id="clear", kind="confirm", text=f"The cause was ‘{CAUSE}’: is it removed?", motion=True)
        await shown(app, pilot)
        await app.workers.wait_for_complete()
        text = await shown(app, pilot)
        assert "THE ARM THEN MOVES" in text
        assert "n  no" in text
        assert "F8  done: the arm may move" in text
        assert "is it removed?" not in text
        for _ in range(4):
            await pilot.press("pagedown")
        assert "is it removed?" in in_one(await shown(app, pilot))


async def test_a_long_cause_leaves_the_end_keys_visible() -> None:
    async with run_screen() as (app, pilot, link):
        measure(link)
        end(link, "aborted", CAUSE)
        await shown(app, pilot)
        await app.workers.wait_for_complete()
        text = await shown(app, pilot)
        assert "PRESS THE EMERGENCY STOP" in text
        assert all(key in text for key in ("x  clear", "r  resume", "p  report"))
        for _ in range(4):
            await pilot.press("pagedown")
        assert "and that is the end of it" in in_one(await shown(app, pilot))


async def test_why_a_run_is_suspended_is_read_to_its_end() -> None:
    async with run_screen() as (app, pilot, link):
        measure(link)
        publish(link, "state", state="SUSPENDED", reason=LASER)
        assert f"Suspended: {LASER}" in in_one(await shown(app, pilot))


async def test_a_stop_by_the_door_says_that_nothing_moves_unasked() -> None:
    async with run_screen() as (app, pilot, link):
        measure(link)
        publish(link, "state", state="UNSUSPENDING", reason="the arm stands: the door is open")
        words = in_one(await shown(app, pilot))
        assert "Stopped, and nothing moves before you agree: the arm stands: the door is open" in words


async def test_drives_that_go_off_by_themselves_are_counted_down() -> None:
    async with run_screen() as (app, pilot, link):
        off_at = datetime.now(UTC) + timedelta(seconds=250)
        link.publish("drives", on=True, off_at_utc=off_at.isoformat())
        assert "DRIVES ON, off in 4 min" in in_one(await shown(app, pilot))
        link.publish("drives", on=False, reason="the arm has rested for 300 s: the drives are off")
        assert "DRIVES ON" not in in_one(await shown(app, pilot))


async def test_drives_out_of_reach_are_not_counted_down() -> None:
    async with run_screen() as (app, pilot, link):
        off_at = datetime.now(UTC) + timedelta(seconds=250)
        link.publish("drives", on=True, off_at_utc=off_at.isoformat())
        link.publish("bench", **with_dead("robot"))
        words = in_one(await shown(app, pilot))
        assert "DRIVES ON when last seen" in words
        assert "off in" not in words


@pytest.mark.parametrize(("on", "said"), [(True, True), (False, False)])
async def test_drives_seen_off_are_not_counted_down(on: bool, said: bool) -> None:
    async with run_screen() as (app, pilot, link):
        off_at = datetime.now(UTC) + timedelta(seconds=250)
        link.publish("drives", on=True, off_at_utc=off_at.isoformat())
        link.publish("bench", **{**BENCH, "robot": {**BENCH["robot"], "servo_on": on}})
        assert ("DRIVES ON" in in_one(await shown(app, pilot))) is said


async def test_the_full_screen_log_wraps_and_shows_the_newest_line() -> None:
    async with run_screen() as (app, pilot, link):
        for number in range(30):
            publish(
                link, "warning", text=f"the beam was lost, number {number}: {LASER}, says number {number}"
            )
        await pilot.press("l")
        assert isinstance(app.screen, RunScreen)
        await shown(app, pilot)
        words = in_one(await shown(app, pilot))
        assert f"the beam was lost, number 29: {LASER}, says number 29" in words
        assert f"the beam was lost, number 28: {LASER}, says number 28" in words
        assert "number 20:" not in words


async def test_an_alarms_remedy_fits_a_small_bench_screen() -> None:
    bench = copy.deepcopy(BENCH)
    bench["robot"]["alarm_number"] = 2600
    bench["robot"]["alarm_text"] = (
        "alarm L2600: position data outside of the range; check the target against the joint limits in the cell file"
    )
    async with started() as (app, pilot, link):
        link.publish("bench", **bench)
        words = in_one(await shown(app, pilot))
        assert "outside of the range → check the target against the joint limits in the cell file" in words


async def test_the_first_line_says_once_why_a_run_was_aborted() -> None:
    async with run_screen(size=(120, 40)) as (app, pilot, link):
        publish(link, "state", state="ABORTED", reason="the robot stands")
        end(link, "aborted", "alarm 2600")
        first = (await shown(app, pilot)).splitlines()[0]
        assert first.strip() == "Look at the bench, then F4 and x.  ABORTED: alarm 2600"
