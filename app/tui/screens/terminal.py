"""The screen Terminal: raw traffic of each link, and bytes sent by hand."""

import asyncio
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import ClassVar, Final

from textual.app import ComposeResult, SystemCommand
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical
from textual.content import Content
from textual.widgets import Input

from catseye.app.errors import CatseyeError, UsageError
from catseye.app.files.atomic import write_atomically
from catseye.app.protocol.raw_text import LineEnd, encoded
from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.tui.dialogs.form_dialog import Answers, Field, FormDialog
from catseye.app.tui.dialogs.start_dialog import Permission, StartDialog
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.screens.base import MainScreen
from catseye.app.tui.session import Session
from catseye.app.tui.widgets.static_text import StaticText
from catseye.app.tui.widgets.wire_view import WireView
from catseye.app.tui.wire_lines import saved_line

_ENDS: Final[tuple[LineEnd, ...]] = ("crlf", "cr", "lf", "none")
_HISTORY: Final = 100
_GIVES_BACK: Final = "esc, then a: the driver has its link again"


class TerminalScreen(MainScreen):
    """Shows what goes over the wires while it is shown; sends only between runs."""

    SCREEN = "terminal"
    F8 = "send"
    AUTO_FOCUS = "WireView"

    DEFAULT_CSS = """
    TerminalScreen #top { height: 1; }
    TerminalScreen #facts { width: 1fr; }
    TerminalScreen #filter { width: 24; background: $boost; }
    TerminalScreen #sender { height: 2; background: $surface; }
    TerminalScreen #how { height: 1; }
    TerminalScreen #line { background: $boost; }
    TerminalScreen #line:focus, TerminalScreen #filter:focus { background: $primary-muted; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("n", "device", "device", id="terminal.device", tooltip="shows the next device, or all"),
        Binding("slash", "filter", "filter", id="terminal.filter", tooltip="by text or hex digits"),
        Binding(
            "space", "follow", "pause", id="terminal.follow", tooltip="pauses the display, or follows again"
        ),
        Binding(
            "a",
            "link",
            "take link",
            id="terminal.link",
            tooltip="takes the link from its driver, or gives it back",
        ),
        Binding(
            "colon",
            "type",
            "type",
            key_display=":",
            id="terminal.type",
            tooltip="type bytes to send; needs the link",
        ),
        Binding("backslash", "end", "line end", show=False, id="terminal.end", tooltip="CR LF, CR, LF, none"),
        Binding(
            "m", "hex", "hex", show=False, id="terminal.hex", tooltip="switches between text and hex bytes"
        ),
        Binding("f8", "send", "send", show=False, id="terminal.send", tooltip="sends to the robot"),
        Binding("c", "copy", "copy", show=False, id="terminal.copy", tooltip="copies the visible lines"),
        Binding(
            "e",
            "save",
            "save",
            show=False,
            id="terminal.save",
            tooltip="saves all lines that pass the filter",
        ),
        Binding("delete", "clear", "clear", show=False, id="terminal.clear", tooltip="forget all lines"),
        Binding("escape", "leave", "back to the lines", show=False, id="terminal.leave"),
        Binding("up", "older", "older input", show=False, id="terminal.older"),
        Binding("down", "newer", "newer input", show=False, id="terminal.newer"),
    ]

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._device = ""
        self._end: LineEnd = "crlf"
        self._hex = False
        self._history: list[str] = []
        self._recalled = 0
        self._subscribed: object = None

    def body(self) -> ComposeResult:
        """Put facts, lines and the line to send together."""
        with Horizontal(id="top"):
            yield StaticText(id="facts")
            yield Input(id="filter", compact=True, placeholder="/ filter: text or hex")
        yield WireView(id="wire")
        with Vertical(id="sender"):
            yield StaticText(id="how")
            yield Input(id="line", compact=True, disabled=True)

    def commands(self) -> Iterable[SystemCommand]:
        """Return every action of this screen."""
        yield SystemCommand("Traffic: next device", "one device, or all", self.action_device)
        yield SystemCommand("Traffic: filter", "by text or hex digits", self.action_filter)
        yield SystemCommand("Traffic: pause or follow", "stand still while you read", self.action_follow)
        yield SystemCommand("Traffic: copy", "copies the visible lines", self.action_copy)
        yield SystemCommand("Traffic: save", "saves all lines that pass the filter", self.action_save)
        yield SystemCommand("Traffic: clear", "forget all lines", self.action_clear)
        yield SystemCommand("Send: take the link, or give it back", "between runs", self.action_link)
        yield SystemCommand("Send: type", "bytes to send", self.action_type)
        yield SystemCommand("Send: line end", "CR LF, CR, LF, none", self.action_end)
        yield SystemCommand("Send: text or hex", "how you type", self.action_hex)
        yield SystemCommand("Send: older input", "that was sent earlier", self.action_older)
        yield SystemCommand("Send: newer input", "that was sent later", self.action_newer)
        yield SystemCommand("Send to the robot", "what is typed; the arm may move", self.action_send)
        yield SystemCommand("Back to the lines", "leave the input", self.action_leave)

    def on_screen_suspend(self) -> None:
        """Give the link back and ask for no more traffic when another screen is shown; a dialog changes nothing."""
        if self.app.current_mode == self.SCREEN:
            return
        if self._is_mine(self.session.link.engine):
            self._give_back()
            self.notify(f"{self._device} has its link again")
        if self._subscribed is not None:
            self._subscribed = None
            self.run_worker(self._ask_for_traffic(on=False), exit_on_error=False)

    def show_state(self, engine: EngineState, now_s: float) -> None:
        """Show what is new, and whether something may be sent."""
        del now_s
        self._subscribe(engine)
        view = self.query_one(WireView)
        view.take(engine.wire, engine.wire_seen)
        self.query_one("#facts", StaticText).set_text(self._facts(engine, view))
        self.query_one("#how", StaticText).set_text(self._how(engine))
        line = self.query_one("#line", Input)
        line.disabled = not self._is_mine(engine)
        line.placeholder = "" if line.disabled else _GIVES_BACK
        if line.disabled and line.has_focus:
            view.focus()

    def action_device(self) -> None:
        """Show the next device; all after the last."""
        names = ["", *self._devices()]
        at = names.index(self._device) if self._device in names else 0
        self._device = names[(at + 1) % len(names)]
        self._choose()

    def action_filter(self) -> None:
        """Type what the lines have to hold."""
        self.query_one("#filter", Input).focus()

    def action_follow(self) -> None:
        """Stand still, or follow again."""
        view = self.query_one(WireView)
        view.follow(not view.following)
        self.show_now()

    def action_clear(self) -> None:
        """Forget all lines."""
        self.query_one(WireView).clear()
        self.show_now()

    def action_copy(self) -> None:
        """Put the lines in sight on the clipboard."""
        self.app.copy_to_clipboard(self.query_one(WireView).visible_text)
        self.notify("copied the visible lines")

    def action_save(self) -> None:
        """Ask where, then write all lines that pass the filter."""
        self.app.push_screen(
            FormDialog("Save these lines", [Field("file", "file", "traffic.log")]), self._save
        )

    def action_end(self) -> None:
        """Take the next line end."""
        self._end = _ENDS[(_ENDS.index(self._end) + 1) % len(_ENDS)]
        self.show_now()

    def action_hex(self) -> None:
        """Type text or hex bytes; behind hex bytes nothing is put unless it is chosen."""
        self._hex = not self._hex
        self._end = "none" if self._hex else "crlf"
        self.show_now()

    def action_type(self) -> None:
        """Go to the line that is sent."""
        line = self.query_one("#line", Input)
        if line.disabled:
            self.notify(self._why_not() or "take the link first: a", severity="warning")
        else:
            line.focus()

    def action_leave(self) -> None:
        """Go back to the lines."""
        self.query_one(WireView).focus()

    def action_link(self) -> None:
        """Take the device's link from its driver, or give it back."""
        engine = self.session.link.engine
        if self._is_mine(engine):
            self._give_back()
        elif reason := self._why_not():
            self.notify(reason, severity="warning")
        elif self._moves(self._device):
            self._ask_to_arm(engine)
        else:
            self._take(None)

    def action_send(self) -> None:
        """Send what is typed; this key sends to every device, also to those that move."""
        line = self.query_one("#line", Input)
        if line.disabled:
            self.action_type()
        elif line.value:
            self._send(line.value)

    def action_older(self) -> None:
        """Show what was sent before."""
        self._recall(-1)

    def action_newer(self) -> None:
        """Show what was sent after it."""
        self._recall(1)

    def on_input_changed(self, event: Input.Changed) -> None:
        """Filter as it is typed."""
        if event.input.id == "filter":
            self._choose()

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Send to instruments; what could move the arm is sent by F8 alone."""
        if event.input.id == "filter":
            self.action_leave()
        elif self._moves(self._device):
            self.notify("it may move the arm: F8 sends", severity="warning")
        elif event.value:
            self._send(event.value)

    def _choose(self) -> None:
        self.query_one(WireView).choose(self._device, self.query_one("#filter", Input).value)
        self.show_now()

    def _subscribe(self, engine: EngineState) -> None:
        """Ask for traffic; again when the connection is another."""
        if not engine.connected:
            self._subscribed = None
        elif self._subscribed is not engine.snapshot and self.app.current_mode == self.SCREEN:
            self._subscribed = engine.snapshot
            self.run_worker(self._ask_for_traffic(on=True), exit_on_error=False)

    async def _ask_for_traffic(self, *, on: bool) -> None:
        from catseye.app.protocol.requests import Watch

        # An engine that is gone sends nothing; the status line says so.
        with suppress(RefusedError, ServiceError):
            await self.session.link.request(Watch(op="traffic", on=on))

    def _devices(self) -> list[str]:
        """Return the names of all devices, those of the cell file first."""
        bench = self.session.link.engine.bench
        known = [] if bench is None else [device.name for device in bench.devices]
        passed = {line.device for line in self.query_one(WireView).lines}
        return known + sorted(passed - set(known))

    def _moves(self, name: str) -> bool:
        """Return whether bytes to a device may move an arm; so they may where nobody knows the device."""
        bench = self.session.link.engine.bench
        device = None if bench is None else bench.device(name)
        return device is None or device.moves_arm

    def _is_mine(self, engine: EngineState) -> bool:
        taken = engine.raw.get(self._device)
        return taken is not None and taken.client == engine.you

    def _give_back(self) -> None:
        from catseye.app.protocol.requests import Raw

        self.catseye.order(Raw(device=self._device, on=False), "The link was not given back")

    def _why_not(self) -> str:
        """Return why nothing can be sent now; empty when the link can be taken."""
        engine = self.session.link.engine
        if not engine.connected:
            return "nothing can be sent: no engine is connected"
        if engine.running:
            return "nothing can be sent while a run is under way: its driver has the link"
        if engine.jogging:
            return "nothing can be sent during a jog: end it first (F5, Esc)"
        if not self._device:
            return "choose a device first: n"
        taken = engine.raw.get(self._device)
        if taken is None or self._is_mine(engine):
            return ""
        return f"{taken.by} has the link of {self._device}"

    def _facts(self, engine: EngineState, view: WireView) -> Content:
        missed = engine.missed["wire"]
        state = "following" if view.following else f"PAUSED, {view.waiting} new"
        return Content.assemble(
            (f"{self._device or 'all devices'}  ", "bold"),
            (f"{state}  ", "" if view.following else "$warning bold"),
            (f"{missed} lines missed  " if missed else "", "$warning"),
            ("UTC", "dim"),
        )

    def _how(self, engine: EngineState) -> Content:
        form = "hex bytes" if self._hex else r"text, \r \n \xNN"
        if self._is_mine(engine):
            key = "F8 sends: it may move the arm" if self._moves(self._device) else "Enter sends"
            return Content.assemble(
                (f"→ {self._device}  ", "bold $accent"),
                f"{form}  end: {self._end}  ",
                (key, "dim"),
            )
        reason = self._why_not()
        return Content.assemble(
            ("not sending  ", "dim"), reason or f"a takes the link of {self._device} from its driver"
        )

    def _ask_to_arm(self, engine: EngineState) -> None:
        device = None if engine.bench is None else engine.bench.device(self._device)
        identity = None if device is None else device.identity
        simulated = None if identity is None else identity.simulated
        text = (
            "Bytes sent to it may move the arm, past every check of this program. Keep everybody out of the cell, "
            "and a hand on the emergency stop. A motion started in this way continues after the link is given "
            "back."
        )
        dialog = StartDialog(
            f"Bytes to the {self._device} by hand", text, engine.cell_name, simulated=simulated
        )
        self.app.push_screen(dialog, self._armed)

    def _armed(self, permission: Permission | None) -> None:
        if permission is not None:
            self._take(permission.arm)

    def _take(self, arm: str | None) -> None:
        from catseye.app.protocol.requests import Raw

        failure = f"The link of {self._device} was not taken"
        self.catseye.order(Raw(device=self._device, arm=arm), failure, control=True, then=self._taken)

    def _taken(self) -> None:
        self.call_after_refresh(self._begin_typing)

    def _begin_typing(self) -> None:
        self.show_now()
        line = self.query_one("#line", Input)
        if not line.disabled:
            line.focus()

    def _send(self, text: str) -> None:
        from catseye.app.protocol.requests import request_of

        try:
            data = encoded(text, self._end, as_hex=self._hex)
            if not data:
                return
            # More may be typed than one request carries.
            request = request_of({"op": "send", "device": self._device, "hex": data.hex()})
        except ValueError as error:
            self.notify(f"not sent: {error}", severity="error")
            return
        self._history = [*(old for old in self._history if old != text), text][-_HISTORY:]
        self._recalled = 0
        self.query_one("#line", Input).value = ""
        self.catseye.order(request, "The bytes were not sent")

    def _recall(self, by: int) -> None:
        line = self.query_one("#line", Input)
        if not line.has_focus:
            return
        self._recalled = min(max(self._recalled - by, 0), len(self._history))
        line.value = self._history[-self._recalled] if self._recalled else ""
        line.cursor_position = len(line.value)

    def _save(self, answers: Answers | None) -> None:
        if answers is not None and answers["file"]:
            text = "".join(f"{saved_line(line)}\n" for line in self.query_one(WireView).lines)
            self.run_worker(self._write(Path(answers["file"]).expanduser(), text), exit_on_error=False)

    async def _write(self, path: Path, text: str) -> None:
        try:
            if await asyncio.to_thread(path.exists):
                raise UsageError(f"{path} exists already: choose another name")
            await asyncio.to_thread(write_atomically, path, text)
        except CatseyeError as error:
            self.catseye.show_error("The lines were not saved", str(error))
            return
        self.notify(f"saved: {path}")
