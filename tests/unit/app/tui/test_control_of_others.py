"""Control that somebody else holds, and control that somebody else takes."""

import pytest

from catseye.app.protocol.requests import Control
from catseye.app.tui.dialogs.questions import ConfirmDialog
from tests.unit.app.tui.scripted import ScriptedLink, shown, started
from tests.unit.app.tui.scripted_run import SNAPSHOT, end, measure, publish

BOB = {"client": "attach-2", "who": "Bob"}


@pytest.mark.parametrize(("key", "asked"), [("escape", []), ("enter", []), ("y", ["control"])])
async def test_control_is_taken_from_somebody_only_after_a_question(key: str, asked: list[str]) -> None:
    async with started({**SNAPSHOT, "control": BOB}, "bench") as (app, pilot, link):
        app.action_take_control()
        assert "Take control from Bob (attach-2)?" in await shown(app, pilot)
        assert isinstance(app.screen, ConfirmDialog)
        await pilot.press(key)
        await shown(app, pilot)
        assert link.ops == asked


async def test_free_control_is_taken_without_asking_or_force() -> None:
    async with started({**SNAPSHOT, "control": None}, "bench") as (app, pilot, link):
        app.action_take_control()
        await shown(app, pilot)
        assert link.asked == [Control()]


async def test_who_loses_control_learns_to_whom() -> None:
    async with started(SNAPSHOT, "bench", size=(120, 40), notifications=True) as (app, pilot, link):
        await shown(app, pilot)
        app._show_changes()  # noqa: SLF001  # what the clock does five times a second
        publish(link, "control", what="taken by force", by="Bob (attach-2)", before="Ada (tui-1)", holder=BOB)
        app._show_changes()  # noqa: SLF001  # what the clock does five times a second
        await pilot.pause()
        assert "Bob (attach-2) has taken control" in " ".join((await shown(app, pilot)).split())


async def test_a_name_resembling_markup_is_shown_verbatim() -> None:
    async with started(SNAPSHOT, "bench", size=(120, 40), notifications=True) as (app, pilot, link):
        await shown(app, pilot)
        app._show_changes()  # noqa: SLF001  # what the clock does five times a second
        publish(
            link,
            "control",
            what="taken by force",
            by="[/x] (attach-2)",
            before="Ada (tui-1)",
            holder={**BOB, "who": "[/x]"},
        )
        app._show_changes()  # noqa: SLF001  # what the clock does five times a second
        await pilot.pause()
        assert "[/x] (attach-2) has taken control" in " ".join((await shown(app, pilot)).split())


async def test_a_holder_whose_name_looks_like_markup_is_shown() -> None:
    controlled = {**SNAPSHOT, "control": {**BOB, "who": "[/x]"}}
    async with started(controlled, "run", size=(120, 40)) as (app, pilot, link):
        measure(link)
        assert "control: [/x]" in await shown(app, pilot)


async def test_an_aborted_idle_engine_offers_clearing() -> None:
    async with started(SNAPSHOT, "run", size=(120, 40)) as (app, pilot, link):
        end(link, "stopped", "the guard stopped the arm; nobody was there")
        link.publish("state", run=None, state="ABORTED", reason="the guard stopped the arm")
        link.publish("idle", run=None, state="ABORTED")
        assert "x  clear" in await shown(app, pilot)


def abort_by_hand(link: ScriptedLink) -> None:
    """Have a jog end with a stop."""
    link.publish("state", run=None, state="ABORTED", reason="the guard stopped the jog")
    link.publish("idle", run=None, state="ABORTED")


async def test_an_aborted_jog_before_any_run_is_cleared_by_key() -> None:
    async with started(screen="run", size=(120, 40)) as (app, pilot, link):
        abort_by_hand(link)
        text = " ".join((await shown(app, pilot)).split())
        assert "Look at the bench, then F4 and x. ABORTED: the guard stopped the jog" in text
        assert "Find and remove the cause, then press x." in text
        await pilot.press("x")
        await shown(app, pilot)
        assert link.ops[-1] == "clear"


@pytest.mark.parametrize("status", ["complete", "stopped"])
async def test_an_aborted_jog_after_a_run_is_cleared_by_key(status: str) -> None:
    async with started(SNAPSHOT, "run", size=(120, 40)) as (app, pilot, link):
        end(link, status)
        abort_by_hand(link)
        assert "x  clear" in await shown(app, pilot)
        await pilot.press("x")
        await shown(app, pilot)
        assert link.ops[-1] == "clear"


async def test_without_an_abort_the_key_clears_nothing() -> None:
    async with started(SNAPSHOT, "run", size=(120, 40)) as (app, pilot, link):
        end(link, "complete")
        assert "x  clear" not in await shown(app, pilot)
        await pilot.press("x")
        await shown(app, pilot)
        assert link.asked == []


async def test_a_cleared_abort_offers_resuming_instead_of_clearing() -> None:
    async with started(SNAPSHOT, "run", size=(120, 40)) as (app, pilot, link):
        publish(link, "state", state="ABORTED", reason="the robot stands")
        end(link, "aborted", "alarm 2600")
        assert "x  clear" in await shown(app, pilot)
        publish(link, "state", state="STOPPED", reason="Ada cleared the abort")
        text = await shown(app, pilot)
        assert "x  clear" not in text
        assert "r  resume" in text
