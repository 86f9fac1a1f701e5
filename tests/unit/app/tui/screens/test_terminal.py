"""The screen Terminal: every key, and when nothing may be sent."""

from pathlib import Path
from typing import Any

from textual.pilot import Pilot
from textual.widgets import Input

from catseye.app.protocol.requests import Raw, Send, Watch
from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.dialogs.error_dialog import ErrorDialog
from catseye.app.tui.dialogs.form_dialog import FormDialog
from catseye.app.tui.dialogs.start_dialog import StartDialog
from catseye.app.tui.widgets.wire_view import WireView
from tests.unit.app.tui.scripted import ScriptedLink, changed_screen, make_app, shown, snapshot_with
from tests.unit.app.tui.scripted_bench import BENCH

RUN = {
    "run": "20261121T090000Z_open-loop_abc123",
    "procedure": "open-loop",
    "title": "Open loop",
    "state": "EXECUTE",
}


def wire(second: float, device: str, direction: str, data: bytes, **more: object) -> dict[str, Any]:
    stamp = f"2026-11-21T09:00:{second:09.6f}+00:00"
    return {"t": stamp, "device": device, "dir": direction, "hex": data.hex(), **more}


LINES = [
    wire(1.0, "robot", "tx", b"1;1;STATE"),
    wire(1.012, "robot", "rx", b"QoK0;10;0;0100000;000,000,000,000;\xff"),
    wire(1.1, "interferometer", "tx", b"R\r\n"),
    wire(1.104, "interferometer", "rx", b"+743.123456 mm\r\n"),
    wire(1.2, "environment", "rx", bytes(range(64)), bytes=300),
]


def link_with_traffic(run: dict[str, Any] | None = None) -> ScriptedLink:
    link = ScriptedLink(run)
    link.publish("bench", **BENCH)
    link.publish("wire", lines=LINES, missed=3)
    return link


def traffic(link: ScriptedLink) -> list[bool]:
    """Return whether traffic was asked for, in order."""
    return [request.on for request in link.asked_for(Watch) if request.op == "traffic"]


def view_of(app: CatseyeApp) -> WireView:
    return app.screen_stack[0].query_one(WireView)


async def to_device(app: CatseyeApp, pilot: Pilot[Any], name: str) -> None:
    for _ in range(6):
        if name in await shown(app, pilot) and view_of(app)._device == name:  # noqa: SLF001  # what is filtered
            return
        await pilot.press("n")
    raise AssertionError(name)


async def take_link(app: CatseyeApp, pilot: Pilot[Any], link: ScriptedLink, device: str) -> None:
    await to_device(app, pilot, device)
    await pilot.press("a")
    await pilot.pause()
    link.publish("raw", device=device, on=True, by="Ada (tui-1)", client="tui-1")
    await shown(app, pilot)


async def test_the_terminal_fits_every_size_and_shows_missed_lines() -> None:
    app = make_app(link_with_traffic(), "terminal")
    async with app.run_test(size=(80, 24)) as pilot:
        text = await shown(app, pilot)
        assert not changed_screen("terminal_80x24", text)
        assert "3 lines missed" in text
        for size in ((60, 20), (100, 30), (200, 60), (120, 40)):
            await pilot.resize_terminal(*size)
            text = await shown(app, pilot)
            assert "30 31 32" in text, size
        assert not changed_screen("terminal_120x40", text)
        screen: Any = app.screen
        actions = {binding.action for binding in screen.BINDINGS}
        offered = {command.callback.__name__.removeprefix("action_") for command in screen.commands()}
        assert actions == offered
        assert "1;1;STATE" in text
        await pilot.press("delete")
        assert "1;1;STATE" not in await shown(app, pilot)


async def test_traffic_is_subscribed_only_while_shown() -> None:
    link = link_with_traffic()
    app = make_app(link, "terminal")
    async with app.run_test(size=(80, 24)) as pilot:
        await shown(app, pilot)
        assert traffic(link) == [True]
        await pilot.press("f2")
        await shown(app, pilot)
        assert traffic(link) == [True, False]
        await pilot.press("f9")
        await shown(app, pilot)
        assert traffic(link)[2:] == [True]
        link.engine.lost("gone")
        await shown(app, pilot)
        link.engine.met(snapshot_with(), 0.0)
        await shown(app, pilot)
        assert traffic(link)[3:] == [True]


async def test_traffic_pauses_scrolls_follows_and_filters() -> None:
    link = link_with_traffic()
    app = make_app(link, "terminal")
    async with app.run_test(size=(80, 24)) as pilot:
        await shown(app, pilot)
        await pilot.press("space")
        link.publish("wire", lines=[wire(2.0, "robot", "tx", b"LATER")], missed=0)
        text = await shown(app, pilot)
        assert "PAUSED, 1 new" in text
        assert "LATER" not in text
        await pilot.press("space")
        assert "LATER" in await shown(app, pilot)
        link.publish("wire", lines=[wire(3.0, "robot", "tx", b"%d" % i) for i in range(60)], missed=0)
        await shown(app, pilot)
        await shown(app, pilot)
        low = view_of(app).scroll_offset.y
        assert low > 0
        await pilot.press("up", "up")
        assert "PAUSED" in await shown(app, pilot)
        assert view_of(app).scroll_offset.y == low - 2
        await pilot.press("down")
        await shown(app, pilot)
        assert view_of(app).scroll_offset.y == low - 1
        await pilot.press("home")
        await shown(app, pilot)
        assert view_of(app).scroll_offset.y == 0
        await pilot.press("end")
        assert "following" in await shown(app, pilot)
        assert view_of(app).scroll_offset.y == low
        await to_device(app, pilot, "interferometer")
        assert len(view_of(app).lines) == 2
        await pilot.press("slash", *"743.1")
        await shown(app, pilot)
        assert [line.text for line in view_of(app).lines] == ["+743.123456 mm.."]
        await pilot.press("enter")
        assert app.focused is view_of(app)


async def test_instruments_are_sent_to_with_enter() -> None:
    link = link_with_traffic()
    app = make_app(link, "terminal")
    async with app.run_test(size=(80, 24)) as pilot:
        await take_link(app, pilot, link, "interferometer")
        assert link.asked_for(Raw) == [Raw(device="interferometer")]
        await pilot.press("colon", *r"R\x41", "enter")
        await pilot.pause()
        assert link.asked_for(Send) == [Send(device="interferometer", hex="52410d0a")]
        await pilot.press("escape", "backslash", "colon", "Z", "enter")
        await pilot.pause()
        assert link.asked_for(Send)[1:] == [Send(device="interferometer", hex="5a0d")]
        await pilot.press("up", "up", "down")
        assert app.focused is not None
        assert app.screen.query_one("#line", Input).value == "Z"
        await pilot.press("escape", "m", "colon", "home", "ctrl+k", *"31 3b", "enter")
        await pilot.pause()
        assert link.asked_for(Send)[2:] == [Send(device="interferometer", hex="313b")]
        await pilot.press("escape", "a")
        await pilot.pause()
        assert link.asked_for(Raw)[1:] == [Raw(device="interferometer", on=False)]


async def test_invalid_input_is_not_sent_and_leaving_releases_the_link() -> None:
    link = link_with_traffic()
    link.refusals["raw"] = "the engine is busy: try again"
    app = make_app(link, "terminal")
    async with app.run_test(size=(80, 24)) as pilot:
        await to_device(app, pilot, "interferometer")
        await pilot.press("a")
        await pilot.pause()
        assert isinstance(app.screen, ErrorDialog)
        await pilot.press("escape")
        link.refusals.clear()
        link.asked.clear()
        await take_link(app, pilot, link, "interferometer")
        await pilot.press("colon", *r"\q", "enter")
        await pilot.pause()
        assert link.asked_for(Send) == []
        assert any("is no escape" in note.message for note in app._notifications)  # noqa: SLF001  # what was said
        await pilot.press("f2")
        await shown(app, pilot)
        assert link.asked_for(Raw)[1:] == [Raw(device="interferometer", on=False)]


async def test_the_robot_is_sent_to_by_f8_alone() -> None:
    link = link_with_traffic()
    app = make_app(link, "terminal")
    async with app.run_test(size=(80, 24)) as pilot:
        await to_device(app, pilot, "robot")
        await pilot.press("a")
        await pilot.pause()
        assert isinstance(app.screen, StartDialog)
        await pilot.press("f8")
        await pilot.pause()
        assert link.asked_for(Raw) == [Raw(device="robot")]
        link.publish("raw", device="robot", on=True, by="Ada (tui-1)", client="tui-1")
        text = await shown(app, pilot)
        assert "F8 sends: it may move the arm" in text
        assert "esc, then a: the driver has its link again" in text
        await pilot.press("colon", *"1;1;STATE", "enter")
        await pilot.pause()
        assert link.asked_for(Send) == []
        await pilot.press("f8")
        await pilot.pause()
        assert link.asked_for(Send) == [Send(device="robot", hex=b"1;1;STATE\r\n".hex())]


async def test_a_real_robot_needs_the_cells_name() -> None:
    link = ScriptedLink()
    devices = [{**d, "identity": {**d["identity"], "simulated": False}} for d in BENCH["devices"]]
    link.publish("bench", **{**BENCH, "devices": devices, "simulated": False})
    app = make_app(link, "terminal")
    async with app.run_test(size=(80, 24)) as pilot:
        await to_device(app, pilot, "robot")
        await pilot.press("a")
        await pilot.pause()
        await pilot.press("f8")
        await pilot.pause()
        assert link.asked_for(Raw) == []
        await pilot.press(*"lab-1", "f8")
        await pilot.pause()
        assert link.asked_for(Raw) == [Raw(device="robot", arm="lab-1")]


async def test_nothing_is_sent_during_a_run() -> None:
    link = link_with_traffic(RUN)
    app = make_app(link, "terminal")
    async with app.run_test(size=(80, 24)) as pilot:
        await to_device(app, pilot, "interferometer")
        assert "a run is under way" in await shown(app, pilot)
        await pilot.press("a", "colon", "f8")
        await pilot.pause()
        assert link.asked_for(Raw) == []
        assert app.screen.query_one("#line", Input).disabled


async def test_copies_and_saves(tmp_path: Path) -> None:
    link = link_with_traffic()
    app = make_app(link, "terminal")
    async with app.run_test(size=(80, 24)) as pilot:
        await shown(app, pilot)
        await pilot.press("c")
        assert "1;1;STATE" in app.clipboard
        for _ in range(2):
            await pilot.press("e")
            await pilot.pause()
            assert isinstance(app.screen, FormDialog)
            app.screen.query_one(Input).value = str(tmp_path / "traffic.log")
            await pilot.press("enter")
            await app.workers.wait_for_complete()
            await pilot.pause()
        saved = (tmp_path / "traffic.log").read_text(encoding="utf-8").splitlines()
        assert len(saved) == len(LINES)
        assert saved[4].endswith("+236 bytes")
        assert isinstance(app.screen, ErrorDialog)
