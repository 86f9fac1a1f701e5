"""The screen Jog: looks, every key, and everything that lets the arm go."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any

import pytest
from textual.events import AppBlur, AppFocus
from textual.pilot import Pilot
from textual.widgets import Input

from catseye.app.protocol.engine_events import Client
from catseye.app.protocol.requests import (
    AnyRequest,
    Control,
    JogHold,
    JogMode,
    JogStep,
    Plain,
    RestoreOverride,
)
from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.dialogs.error_dialog import ErrorDialog
from catseye.app.tui.dialogs.questions import ConfirmDialog, MotionDialog
from catseye.app.tui.screens.jog import JogScreen
from catseye.app.tui.widgets.strip import Strip
from tests.patience import until
from tests.unit.app.tui.scripted import ScriptedLink, changed_screen, make_app, shown, snapshot_with, started
from tests.unit.app.tui.scripted_bench import BENCH, bench, publish_strip

SIZES = [(80, 24), (120, 40)]
MINE = {"on": True, "by": "Ada (tui-1)", "percent": 5.0, "moving": None}
_STEPS: tuple[tuple[tuple[str, ...], str, int], ...] = (
    (("left", "a"), "j1", 1),
    (("right", "d"), "j1", -1),
    (("up", "w"), "j2", 1),
    (("down", "s"), "j2", -1),
    (("q",), "j4", 1),
    (("e",), "j4", -1),
)
HOLD = JogHold(joint="j1", direction=1)
STOP = JogHold(joint="j1", direction=0)


@dataclass
class Play:
    """The program on a scripted engine, with somebody at the keys."""

    app: CatseyeApp
    link: ScriptedLink
    pilot: Pilot[Any]


Script = Callable[[Play], Awaitable[None]]


def jog_screen(app: CatseyeApp) -> JogScreen:
    screen = app.screen_stack[0]
    assert isinstance(screen, JogScreen)
    return screen


async def jogging(
    script: Script, size: tuple[int, int] = (80, 24), status: dict[str, Any] = BENCH
) -> ScriptedLink:
    """Play a script while this client jogs."""
    async with started(screen="jog", size=size) as (app, pilot, link):
        link.publish("bench", **status)
        publish_strip(link)
        link.engine.control = Client(client="tui-1", who="Ada")
        link.publish("jog", **MINE)
        await shown(app, pilot)
        await script(Play(app, link, pilot))
    return link


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize(("name", "status"), [("simulated", BENCH), ("real", bench(simulated=False))])
async def test_looks_before(size: tuple[int, int], name: str, status: dict[str, Any]) -> None:
    async with started(screen="jog", size=size) as (app, pilot, link):
        link.publish("bench", **status)
        publish_strip(link)
        await shown(app, pilot)
        assert not changed_screen(f"jog-{name}-{size[0]}x{size[1]}", await shown(app, pilot))


@pytest.mark.parametrize("size", SIZES)
async def test_looks_while_jogging(size: tuple[int, int]) -> None:
    async def look(play: Play) -> None:
        await play.pilot.press("n", "m")
        play.link.publish("jog", **{**MINE, "moving": "j1"})
        assert not changed_screen(f"jog-moving-{size[0]}x{size[1]}", await shown(play.app, play.pilot))

    await jogging(look, size)


async def test_a_high_screen_shows_each_axis_within_its_range() -> None:
    """A joint 10 degrees below its upper end stands in the last sixteenth of its bar."""
    axis = {"name": "J1", "unit": "deg", "low": -150.0, "high": 150.0}
    rest = [{"name": f"J{number}", "unit": "deg", "low": -150.0, "high": 150.0} for number in (2, 3, 4)]
    robot = {**BENCH["robot"], "joints": [140.0, 0.0, 0.0, 0.0]}
    async with started(screen="jog", size=(200, 60)) as (app, pilot, link):
        link.publish("bench", **bench(robot=robot, axes=[axis, *rest]))
        assert f"J1   ├{'─' * 15}●┤  -150 … 150 deg" in await shown(app, pilot)


async def test_other_sizes_and_changes_of_size() -> None:
    async def look(play: Play) -> None:
        for size in ((60, 20), (100, 30), (200, 60), (24, 8)):
            await play.pilot.resize_terminal(*size)
            await play.pilot.press("v")
            assert "JOG" in await shown(play.app, play.pilot)

    await jogging(look)


async def test_an_override_that_stays_low_is_shown() -> None:
    async with started(screen="jog") as (app, pilot, link):
        for percent, raised in ((5.0, True), (19.5, False), (20.0, False), (100.0, False)):
            link.publish("bench", **bench(robot={**BENCH["robot"], "override_percent": percent}))
            text = " ".join((await shown(app, pilot)).split())
            assert (f"override {percent:g} %" in text) == raised, percent
            assert ("until raised at controller" in text) == raised, percent


async def begin_by_keys(app: CatseyeApp, pilot: Pilot[Any], link: ScriptedLink) -> None:
    """Press F8, read what it says, and press it again."""
    await pilot.press("f8")
    await shown(app, pilot)
    assert isinstance(app.screen, MotionDialog)
    link.now_s += 2.0
    await pilot.press("f8")
    await pilot.pause()


SPEEDS = ((("plus",), 10.0), (("pageup", "pageup", "pageup", "plus"), 20.0), (("minus",) * 9, 1.0))


async def test_only_f8_begins_at_the_chosen_speed_within_the_cap() -> None:
    async with started(screen="jog") as (app, pilot, link):
        link.publish("bench", **BENCH)
        await shown(app, pilot)
        await pilot.press("enter", "space", "left", "a", "q", "z", "p", "1", "escape")
        await pilot.pause()
        assert link.asked == []
        callbacks = {command.title: command.callback for command in jog_screen(app).commands()}
        callbacks["Begin to jog"]()
        text = await shown(app, pilot)
        assert "this is emulators" in text
        assert "override   5 %, at most 20 %" in text
        await pilot.press("enter", "escape")
        await pilot.pause()
        assert link.asked == []
        begin = JogMode(on=True, percent=5.0)
        await pilot.press("f8")
        assert "override   5 %, at most 20 %" in await shown(app, pilot)
        # Held down, or pressed twice by mistake.
        await pilot.press("f8")
        assert "read it, then press F8 once" in await shown(app, pilot)
        assert link.asked == []
        link.now_s += 2.0
        await pilot.press("f8")
        await pilot.pause()
        assert link.asked == [Control(), begin]
        callbacks["Begin to jog"]()
        await pilot.press("f8")
        await pilot.pause()
        assert link.asked[2:] == [begin]
        for keys, percent in SPEEDS:
            await pilot.press(*keys)
            assert f"{percent:g} % (cap 20 %)" in await shown(app, pilot), keys
            await begin_by_keys(app, pilot, link)
            assert link.asked[-1] == JogMode(on=True, percent=percent), keys


async def test_a_real_arm_needs_the_typed_name() -> None:
    async with started(screen="jog") as (app, pilot, link):
        link.publish("bench", **bench(simulated=False))
        text = await shown(app, pilot)
        assert "REAL ARM" in text
        await pilot.press(*"lab-1", "pagedown")
        assert app.screen.query_one("#typed", Input).value == "lab-1"
        await begin_by_keys(app, pilot, link)
        assert link.asked[-1] == JogMode(on=True, percent=2.0, arm="lab-1")
        link.publish("jog", **MINE)
        await shown(app, pilot)
        link.publish("jog", **{**MINE, "on": False, "reason": "Ada (tui-1) ended it"})
        assert "Ada (tui-1) ended it" in await shown(app, pilot)
        assert app.screen.query_one("#typed", Input).value == ""


async def test_a_refused_jog_is_shown_with_its_remedy() -> None:
    link = ScriptedLink()
    link.refusals["jog"] = "the door is open: no motion; close it when nobody is inside, then jog again"
    app = make_app(link, "jog")
    async with app.run_test(size=(80, 24)) as pilot:
        link.publish("bench", **BENCH)
        await begin_by_keys(app, pilot, link)
        text = await shown(app, pilot)
        assert isinstance(app.screen, ErrorDialog)
        assert "→ close it when nobody is inside" in text


async def test_keys_step_joints_and_beam_by_the_chosen_size() -> None:
    async def press(play: Play) -> None:
        for keys, joint, sign in _STEPS:
            for key in keys:
                await play.pilot.press(key)
                await play.pilot.pause()
                assert play.link.asked[-1] == JogStep(joint=joint, by=sign * 0.1)
        for key, by in (("1", 0.01), ("3", 1.0), ("4", 5.0), ("5", 10.0), ("2", 0.1)):
            await play.pilot.press(key, "q")
            await play.pilot.pause()
            assert play.link.asked_for(JogStep)[-1].by == by
            assert f"[{by:g}]" in await shown(play.app, play.pilot)
        play.link.asked.clear()
        await play.pilot.press("z")
        assert "choose one with n" in await shown(play.app, play.pilot)
        assert play.link.asked == []
        for aim in ("P1", "P2"):
            await play.pilot.press("n", "z")
            await play.pilot.pause()
            assert play.link.asked[-1] == JogStep(joint="beam", by=0.1, aim=aim)
        await play.pilot.press("x")
        await play.pilot.pause()
        assert play.link.asked_for(JogStep)[-1].by == -0.1
        await play.pilot.press("n", "n", "left")
        await play.pilot.pause()
        assert play.link.asked_for(JogStep)[-1].aim is None
        await play.pilot.press("comma")
        assert play.app.screen.query_one(Strip).window_s == 30
        await play.pilot.press("v")
        assert "From above" in await shown(play.app, play.pilot)
        play.link.refusals["jog-step"] = "J1 would leave its range of -170 to 170 deg"
        await play.pilot.press("left")
        assert "J1 would leave its range" in await shown(play.app, play.pilot)

    await jogging(press)


async def test_pointing_asks_first() -> None:
    async def press(play: Play) -> None:
        await play.pilot.press("p")
        assert "there is nothing to point at" in await shown(play.app, play.pilot)
        await play.pilot.press("n", "n", "p")
        text = await shown(play.app, play.pilot)
        assert isinstance(play.app.screen, MotionDialog)
        # From (344.471, 332.738) mm to P2 at (680, 0) mm: -44.761 deg in the world, less 80 deg.
        assert "-147.366 to -124.761 deg (+22.605 deg)" in text
        await play.pilot.press("enter", "escape")
        await play.pilot.pause()
        assert play.link.asked_for(JogStep) == []
        await play.pilot.press("p", "f8")
        await play.pilot.pause()
        (step,) = play.link.asked_for(JogStep)
        assert step.joint == "j4"
        assert step.by == pytest.approx(22.605, abs=0.001)

    await jogging(press)


async def test_where_the_arm_points_is_not_reckoned_from_old_joints() -> None:
    async def press(play: Play) -> None:
        play.link.now_s += 5.0
        await play.pilot.press("n", "p")
        assert "the last reading of the joints is too old" in await shown(play.app, play.pilot)
        assert not isinstance(play.app.screen, MotionDialog)

    await jogging(press, (120, 40))


async def hold_j1(play: Play) -> None:
    """Hold a key until the joint is fed."""
    await play.pilot.press("left")
    await play.pilot.pause()
    assert play.link.asked == []
    play.link.now_s += 0.5
    await play.pilot.press("left")
    await asks(play.link, HOLD)


async def asks(link: ScriptedLink, request: AnyRequest, case: object = "") -> None:
    """Wait until something is asked; where it is not, say in which case."""
    try:
        await until(lambda: request in link.asked)
    except TimeoutError:
        raise AssertionError(f"{request} is not asked; {link.asked} {case}") from None


async def no_repeat(play: Play) -> None:
    play.link.now_s += 0.31


async def no_look(play: Play) -> None:
    play.app.post_message(AppBlur())


async def another_screen(play: Play) -> None:
    await play.pilot.press("f2")


async def a_dialog(play: Play) -> None:
    play.app.show_error("Something", "happened")


async def the_palette(play: Play) -> None:
    await play.pilot.press("ctrl+p")


async def another_mode(play: Play) -> None:
    await play.pilot.press("m")


async def escape(play: Play) -> None:
    await play.pilot.press("escape")


async def jog_over(play: Play) -> None:
    play.link.publish("jog", **{**MINE, "on": False, "reason": "the door is open"})


async def link_lost(play: Play) -> None:
    play.link.engine.lost("the engine is gone")


async def another_key(play: Play) -> None:
    await play.pilot.press("right")


ENDS: tuple[Script, ...] = (
    no_repeat,
    no_look,
    another_screen,
    a_dialog,
    the_palette,
    another_mode,
    escape,
    jog_over,
    another_key,
    link_lost,
)


async def test_what_lets_the_arm_go() -> None:
    async def each(play: Play) -> None:
        await play.pilot.press("m")
        for end in ENDS:
            play.link.asked.clear()
            await hold_j1(play)
            assert STOP not in play.link.asked, end
            await end(play)
            await asks(play.link, STOP, end)
            fed = play.link.asked.count(HOLD)
            await play.pilot.pause()
            assert play.link.asked.count(HOLD) == fed, end
            assert not jog_screen_of(play.app).jog_client.busy, end
            if end is escape:
                assert JogMode(on=False) in play.link.asked
            await jog_again(play, end)
        play.link.engine.met(snapshot_with(control={"client": "tui-1", "who": "Ada"}), play.link.now_s)
        await jog_again(play, link_lost)
        play.link.asked.clear()
        await hold_j1(play)
        await play.pilot.press("f12")
        await asks(play.link, Plain(op="stop"))

    await jogging(each)


async def jog_again(play: Play, end: Script) -> None:
    """Have the program jog as before, by keys that are held."""
    if end in {a_dialog, the_palette}:
        await play.pilot.press("escape")
    if end is another_screen:
        await play.pilot.press("f5")
    if end is another_mode:
        await play.pilot.press("m")
    play.app.post_message(AppFocus())
    play.link.now_s += 2.0
    play.link.publish("bench", **BENCH)
    play.link.publish("jog", **MINE)
    await shown(play.app, play.pilot)


def jog_screen_of(app: CatseyeApp) -> JogScreen:
    stacks = app._screen_stacks  # noqa: SLF001  # Textual has no public way to a screen of another mode
    return next(screen for screen in stacks["jog"] if isinstance(screen, JogScreen))


async def test_palette_motions_need_f8_and_leaving_ends_the_jog() -> None:
    async def call(play: Play) -> None:
        callbacks = {command.title: command.callback for command in jog_screen(play.app).commands()}
        callbacks["Steps of 1 deg"]()
        callbacks["One step: J2 clockwise"]()
        text = await shown(play.app, play.pilot)
        assert "J2 clockwise by 1 deg" in text
        # It stands at 60 deg; (20, 59) deg is at (348.308, 329.975) mm.
        assert "J2 59.00°" in text
        assert "J2 by 1.00°" in text
        assert "5 %, at most 20 %" in text
        await play.pilot.press("enter", "escape")
        await play.pilot.pause()
        assert play.link.asked == []
        callbacks["One step: J2 clockwise"]()
        await play.pilot.press("f8")
        await asks(play.link, JogStep(joint="j2", by=-1.0))
        for title in ("Steps or hold", "Next aim", "Beam or arm", "Length of the strip chart"):
            callbacks[title]()
        text = await shown(play.app, play.pilot)
        assert "[hold]" in text
        assert "[P1]" in text
        callbacks["End the jog"]()
        await asks(play.link, JogMode(on=False))
        for key in ("escape", "f2"):
            play.link.asked.clear()
            play.link.publish("jog", **{**MINE, "on": False, "reason": "Ada (tui-1) ended it"})
            play.link.publish("jog", **MINE)
            await shown(play.app, play.pilot)
            await play.pilot.press(key)
            await asks(play.link, JogMode(on=False), key)

    await jogging(call)


async def test_who_else_jogs_is_shown_and_keys_do_nothing() -> None:
    async with started(screen="jog") as (app, pilot, link):
        link.publish("bench", **BENCH)
        link.engine.control = Client(client="tui-2", who="Bob")
        link.publish("jog", on=True, by="Bob (tui-2)", percent=10.0, moving="j4")
        text = await shown(app, pilot)
        assert "Bob (tui-2) jogs at 10 %, moving j4" in text
        await pilot.press("left", "f8", "p", "escape")
        await pilot.pause()
        assert link.asked == []


async def test_the_override_before_the_jog_is_set_by_y() -> None:
    left = {"before_percent": 20.0, "left_percent": 5.0}
    async with started(screen="jog") as (app, pilot, link):
        link.publish("bench", **bench(robot={"override_percent": 5.0}))
        assert "until raised at controller" in await shown(app, pilot)
        await pilot.press("equals_sign")
        assert "no jog or walk has lowered the override" in await shown(app, pilot)
        link.publish("override-left", left=left)
        assert "= sets 20 % again" in await shown(app, pilot)
        for key in ("enter", "f8", "escape", "y"):
            if not isinstance(app.screen, ConfirmDialog):
                await pilot.press("equals_sign")
            assert "Set the speed override to 20 % again?" in await shown(app, pilot)
            await pilot.press(key)
            await shown(app, pilot)
            asked = [RestoreOverride(percent=20.0)] if key == "y" else []
            assert link.asked_for(RestoreOverride) == asked
        link.publish(
            "override-left", left=None, reason="the override reads 8 %: somebody has changed it since"
        )
        assert "until raised at controller" in await shown(app, pilot)


async def test_no_override_is_set_while_the_jog_goes_on() -> None:
    async def call(play: Play) -> None:
        play.link.publish("override-left", left={"before_percent": 20.0, "left_percent": 5.0})
        await play.pilot.press("equals_sign")
        assert "end it first" in await shown(play.app, play.pilot)
        assert not isinstance(play.app.screen, ConfirmDialog)

    await jogging(call)


async def test_an_arm_that_moved_meanwhile_is_not_pointed() -> None:
    async def press(play: Play) -> None:
        await play.pilot.press("n", "n", "p")
        text = await shown(play.app, play.pilot)
        for said in ("J4 by 22.61°", "0.0 mm in x and y", "5 %, at most 20 %", "rehearsed"):
            assert said in text
        play.link.publish("bench", **bench(robot={"joints": [21.0, 60.0, 50.0, -147.366]}))
        await play.pilot.press("f8")
        assert "has moved meanwhile" in await shown(play.app, play.pilot)
        await play.pilot.press("escape")
        assert play.link.asked_for(JogStep) == []

    await jogging(press)
