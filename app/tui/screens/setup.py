"""The screen Set-up: a cell file by questions, an emulated bench, the demo."""

import asyncio
from collections.abc import Iterable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Final

from textual.app import ComposeResult, SystemCommand
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.widgets import OptionList

from catseye.app.errors import CatseyeError
from catseye.app.files.atomic import require_output, write_atomically, write_users_file
from catseye.app.files.documents import read_text
from catseye.app.protocol.banners import SIMULATION
from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.tui import demo
from catseye.app.tui.cell_change import is_of, use_cell
from catseye.app.tui.dialogs.form_dialog import Answers, Field, FormDialog
from catseye.app.tui.dialogs.questions import ConfirmDialog
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.screens.working import WorkScreen
from catseye.app.tui.session import Session
from catseye.app.tui.setup.start import CHOICES, Start
from catseye.app.tui.widgets.task_line import TaskLine

if TYPE_CHECKING:
    # The first screen is painted before the drivers and the cell file's model are imported.
    from catseye.app.cell.wizard.draft import Draft
    from catseye.app.tui.setup.wizard import Wizard

_NARROW: Final = 70


class SetupScreen(WorkScreen):
    """Offers the ways to a bench; the wizard takes their place."""

    SCREEN = "setup"

    DEFAULT_CSS = """
    SetupScreen #place { height: 1fr; }
    SetupScreen.wizard Start { display: none; }
    SetupScreen.-narrow #pages { display: none; }
    """

    _START: ClassVar[tuple[str, ...]] = tuple(CHOICES)
    _WIZARD: ClassVar[tuple[str, ...]] = ("next", "before", "test", "save", "add", "remove")

    BINDINGS: ClassVar[list[BindingType]] = [
        *(
            Binding(key, name, title.split(" ", maxsplit=1)[0].lower(), id=f"setup.{name}", tooltip=text)
            for name, (key, title, text) in CHOICES.items()
        ),
        Binding(
            "pagedown,ctrl+n", "next", "next", id="setup.next", tooltip="goes to the next page of questions"
        ),
        Binding("pageup,ctrl+b", "before", "back", id="setup.before", tooltip="goes to the previous page"),
        Binding("ctrl+t", "test", "test", id="setup.test", tooltip="connects to the device of this page"),
        Binding("ctrl+s", "save", "save", id="setup.save", tooltip="writes the cell file and uses it"),
        Binding("ctrl+g", "add", "add", id="setup.add", tooltip="one more reflector"),
        Binding("ctrl+y", "remove", "remove", id="setup.remove", tooltip="this reflector"),
        Binding(
            "escape",
            "leave",
            "leave",
            id="setup.leave",
            tooltip="leaves the questions, whose answers are kept; ends the demo",
        ),
    ]

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._drafts: dict[Path | None, Draft] = {}
        self._source: Path | None = None
        self._asked: Wizard | None = None
        self._demo: asyncio.Task[None] | None = None

    def body(self) -> ComposeResult:
        """Put the choices and the place of the wizard together."""
        with Vertical(id="place"):
            yield Start()
        yield TaskLine(self.session.now_s)

    def commands(self) -> Iterable[SystemCommand]:
        """Return every action of this screen."""
        for name, (_, title, text) in CHOICES.items():
            yield SystemCommand(f"Set-up: {title}", text, getattr(self, f"action_{name}"))
        yield SystemCommand("Questions: next page", "of the wizard", self.action_next)
        yield SystemCommand("Questions: page before", "of the wizard", self.action_before)
        yield SystemCommand("Questions: connection test", "of the device of this page", self.action_test)
        yield SystemCommand("Questions: write the cell file", "and use it", self.action_save)
        yield SystemCommand("Questions: add a reflector", "on its page", self.action_add)
        yield SystemCommand("Questions: remove a reflector", "on its page", self.action_remove)
        yield SystemCommand("Questions: leave", "answers are kept", self.action_leave)

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer what can be done where one is."""
        if action in self._START:
            return not self.asking and (action != "change" or self.session.cell is not None)
        if action in {"add", "remove"}:
            return self.asking and self._wizard.page.name == "reflector"
        if action == "test":
            return self.asking and bool(self._wizard.page.device)
        if action in self._WIZARD:
            return self.asking
        if action == "leave":
            return self.asking or self._demonstrating
        return super().check_action(action, parameters)

    @property
    def asking(self) -> bool:
        """The wizard is shown."""
        return self.has_class("wizard") and self._asked is not None and self._asked.is_attached

    @property
    def _wizard(self) -> "Wizard":
        from catseye.app.tui.setup.wizard import Wizard

        return self.query_one(Wizard)

    def on_mount(self) -> None:
        """Say what there is."""
        self.query_one("#choices", OptionList).focus()

    def show_state(self, engine: EngineState, now_s: float) -> None:
        """Say what there is."""
        del engine, now_s
        self.set_class(self.size.width < _NARROW, "-narrow")
        cell = self.session.cell
        self.query_one(Start).show(cell, None in self._drafts, cell is not None and cell in self._drafts)

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Do what was chosen."""
        event.stop()
        if event.option_id is not None and self.check_action(event.option_id, ()):
            getattr(self, f"action_{event.option_id}")()

    def action_wizard(self) -> None:
        """Ask from nothing, or go on with the questions that were left."""
        self.spawn(partial(self._ask, None), "ask", exclusive=True)

    def action_change(self) -> None:
        """Ask about the present cell file."""
        if self.session.cell is not None:
            self.spawn(partial(self._ask, self.session.cell), "ask", exclusive=True)

    def action_open(self) -> None:
        """Ask for a cell file that is there."""
        present = str(self.session.cell or "cell.toml")
        self.app.push_screen(
            FormDialog("Open a cell file", [Field("file", "file", present)]), self._open_file
        )

    def action_emulated(self) -> None:
        """Write a cell file for emulators of a SCARA's bench and start them."""
        self.spawn(partial(self._emulate, "scara"), "emulate", exclusive=True)

    def action_emulated_arm(self) -> None:
        """Write a cell file for emulators of a six-axis arm with its optics and start them."""
        self.spawn(partial(self._emulate, "resolution"), "emulate", exclusive=True)

    def action_emulated_tracker(self) -> None:
        """Write a cell file for emulators of a six-axis arm before a tracker and start them."""
        self.spawn(partial(self._emulate, "six-axis"), "emulate", exclusive=True)

    def action_demo(self) -> None:
        """Start an emulated bench and let it do its day by itself."""
        if self._demonstrating:
            self.notify("the demo is under way: F4 shows it", severity="warning")
        elif self.session.link.engine.emulated_speed is not None and self.session.speed < demo.SPEED:
            self.notify(
                f"the emulated bench runs at {self.session.speed:g} times real speed, so the demo would take hours: "
                "quit, start again, and begin with the demo",
                severity="warning",
            )
        else:
            self._demo = self.catseye.keep(self._show_demo())

    async def action_next(self) -> None:
        """Show the next page."""
        await self._wizard.turn(1)
        self.refresh_bindings()

    async def action_before(self) -> None:
        """Show the page before."""
        await self._wizard.turn(-1)
        self.refresh_bindings()

    async def action_add(self) -> None:
        """Add a reflector."""
        await self._wizard.add_reflector()

    async def action_remove(self) -> None:
        """Take a reflector away."""
        await self._wizard.remove_reflector()

    def action_test(self) -> None:
        """Connect to the device of this page, with the answers as they are."""
        self.spawn(self._test, "test", exclusive=True)

    def action_save(self) -> None:
        """Write the cell file, if nothing is wrong with it."""
        self.spawn(self._save, "save", exclusive=True)

    def action_leave(self) -> None:
        """Let the demo do no more, or leave the questions for now."""
        if self._demo is not None and self._demonstrating:
            self._demo.cancel()
            self.notify("the demo has ended; a run under way continues: F12 stops it")
        else:
            self.remove_class("wizard")
            self.query_one("#choices", OptionList).focus()
            self.refresh_bindings()

    async def _ask(self, source: Path | None) -> None:
        """Show the questions.

        Args:
            source: cell file to change; None for a new one.
        """
        left = self._drafts.get(source)
        try:
            draft = await asyncio.to_thread(_draft_of, source)
        except (CatseyeError, OSError, UnicodeDecodeError) as error:
            self.catseye.show_error(f"{source} cannot be changed here", str(error))
            return
        if left is not None and left.beginning == draft.beginning:
            draft = left
        else:
            draft.give("file", str(source or await asyncio.to_thread(_new_file)))
            if left is not None:
                self.notify("the file has changed: its questions begin again", severity="warning")
        self._drafts[source], self._source = draft, source
        # Drivers declare their settings; they are loaded beside the screen.
        await asyncio.to_thread(lambda: [draft.questions(page) for page in draft.pages])
        await self._show_wizard(draft)

    async def _show_wizard(self, draft: "Draft") -> None:
        from catseye.app.tui.setup.wizard import Wizard

        await self.query("Wizard").remove()
        self._asked = Wizard(draft)
        await self.query_one("#place").mount(self._asked)
        self.add_class("wizard")
        self.refresh_bindings()

    async def _test(self) -> None:
        from catseye.app.cell.rewriting import plain
        from catseye.app.cell.wizard.draft import with_one_device
        from catseye.app.tui.setup.device_test import DeviceTest

        wizard = self._wizard
        await wizard.judge()
        device, faults = wizard.page.device, wizard.draft.page_faults(wizard.page, wizard.faults)
        data = wizard.draft.data()
        if faults or device not in data:
            self.notify("answer the questions of this device first", severity="warning")
            return
        if self.session.link.engine.running:
            self.notify("a run is under way: its devices are not touched", severity="warning")
            return
        # Controllers serve one link; an engine that nobody watches lets its links go.
        await self._watch(on=False)
        text = plain(with_one_device(data, device))
        await self.app.push_screen_wait(DeviceTest(device, text, self.session.work, self.session.now_s))
        await self._watch(on=True)

    async def _watch(self, *, on: bool) -> None:
        from catseye.app.protocol.requests import Watch

        with suppress(RefusedError, ServiceError):
            await self.session.link.request(Watch(op="watch", on=on))

    async def _save(self) -> None:
        wizard = self._wizard
        await wizard.judge()
        if wizard.faults:
            await wizard.show_page(wizard.draft.pages[-1])
            self.notify("not written: correct the marked answers first", severity="warning")
            return
        path = wizard.path
        try:
            await asyncio.to_thread(require_output, path)
        except CatseyeError as error:
            self.catseye.show_error("The cell file was not written", str(error))
            return
        text, commented = wizard.draft.written()
        if not commented and self._source is not None and path.absolute() == self._source.absolute():
            path = path.with_name(f"{path.stem}-new.toml")
            shown = (
                f"{self._source} is written in a way that cannot be changed line by line: its comments cannot be "
                f"kept. It stays as it is, and {path} is written beside it, without comments."
            )
            if not await self.app.push_screen_wait(
                ConfirmDialog("A new file", shown, "write it", "do not write")
            ):
                return
        if await asyncio.to_thread(path.exists) and not await self._may_replace(path):
            return
        await self._write(path, text)

    async def _may_replace(self, path: Path) -> bool:
        dialog = ConfirmDialog(
            "The file exists", f"{path} is there already. Its text is replaced.", "replace it", "do not write"
        )
        return await self.app.push_screen_wait(dialog)

    async def _write(self, path: Path, text: str) -> None:
        try:
            await asyncio.to_thread(write_users_file, path, text)
        except (CatseyeError, OSError) as error:
            self.catseye.show_error("The cell file was not written", str(error))
            return
        await self.query("Wizard").remove()
        self._drafts.pop(self._source, None)
        self.action_leave()
        await self._use(path)

    async def _use(self, path: Path) -> None:
        """Have a command check a cell file as anybody would, then go on with it."""
        done = await self.session.work.do("config", "validate", path)
        if done.code != 0:
            self.catseye.show_error(f"{path} cannot be used", done.fault)
            return
        warnings = [f"warning: {text}" for text in done.warnings]
        self.notify("\n".join([str(path), *warnings]), title="this cell is used now", markup=False)
        use_cell(self.catseye, path)
        self.show_now()

    def _open_file(self, answers: Answers | None) -> None:
        if answers is not None and answers["file"]:
            self.spawn(partial(self._use, Path(answers["file"]).expanduser()), "open", exclusive=True)

    @property
    def _demonstrating(self) -> bool:
        """The demo is under way."""
        return self._demo is not None and not self._demo.done()

    async def _show_demo(self) -> None:
        emulated = self.session.link.engine.emulated_speed is not None
        if emulated or await self._emulate("scara", max(self.session.own_speed, demo.SPEED)):
            await demo.Demo(self.catseye).do()

    async def _emulate(self, system: str, speed: float | None = None) -> bool:
        """Start the emulators of a system; return whether they answer.

        Args:
            system: name of its template.
            speed: bench seconds in one real second; that which this program was started for when None.
        """
        from catseye.app.tui.setup.emulators import emulated_cell, free_file

        if self.session.link.engine.running:
            self.notify("a run is under way: end it first", severity="warning")
            return False
        path = await asyncio.to_thread(free_file, Path(), system)
        try:
            # One of before is used as it is: it may have been changed.
            if not await asyncio.to_thread(path.exists):
                text = await asyncio.to_thread(emulated_cell, system)
                await asyncio.to_thread(write_atomically, path, text)
        except CatseyeError as error:
            self.catseye.show_error("The emulated bench was not set up", str(error))
            return False
        self.query_one(TaskLine).begin(f"{SIMULATION}: starting the emulators")
        try:
            await self._let_engine_emulate(path, self.session.own_speed if speed is None else speed)
        except (RefusedError, ServiceError, TimeoutError) as error:
            self.catseye.show_error("The emulators did not start", str(error) or "no engine came up")
            return False
        else:
            self.notify(f"{path}: emulators answer; they end with the engine", title=SIMULATION, markup=False)
            self.catseye.action_go("bench")
            return True
        finally:
            self.query_one(TaskLine).end()

    async def _let_engine_emulate(self, path: Path, speed: float) -> None:
        """Have the engine of a cell file emulate its devices: it outlives this program, and they do.

        Raises:
            RefusedError: it does not, or another engine is kept.
            ServiceError: it does not answer.
            TimeoutError: it does not come up.
        """
        from catseye.app.protocol.requests import Emulate

        if not is_of(self.session.link.engine, path):
            use_cell(self.catseye, path)
        async with asyncio.timeout(_ENGINE_S):
            while not (self.session.link.engine.connected and is_of(self.session.link.engine, path)):
                if not self._uses(path):
                    raise RefusedError("the engine that runs keeps its cell")
                await asyncio.sleep(_LOOK_S)
        await self.session.take_free_control()
        await self.session.link.request(Emulate(speed=speed))

    def _uses(self, path: Path) -> bool:
        return self.session.cell == path.absolute()


_ENGINE_S: Final = 60.0
"""For an engine to end and another one to come up, or for a person to say whether it may, s."""

_LOOK_S: Final = 0.1


def _draft_of(source: Path | None) -> "Draft":
    from catseye.app.cell.wizard.draft import Draft

    return Draft.new() if source is None else Draft.of_text(read_text(source))


def _new_file() -> Path:
    """Return a name for a new cell file that is not taken."""
    names = ["cell.toml", *(f"cell-{number}.toml" for number in range(2, 100))]
    return next((Path(name) for name in names if not Path(name).exists()), Path("cell-new.toml"))
