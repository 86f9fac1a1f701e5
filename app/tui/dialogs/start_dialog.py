"""Before a run begins: what it will do, on what, and the key that lets the arm move."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Final

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.widgets import Input, Static

from catseye.app.tui.dialogs.box_dialog import BoxDialog

_LONGEST_NAME: Final = 200
"""More than a cell's name has, and less than a request takes."""


@dataclass(frozen=True)
class Permission:
    """What a person has agreed to.

    Attributes:
        arm: the cell's name, typed to let real hardware move; None for emulators.
    """

    arm: str | None


class StartDialog(BoxDialog[Permission | None]):
    """Shows what is about to begin. F8 begins it, Enter never does; None goes back.

    Args:
        simulated: every device is an emulator; None when nobody knows yet.
        changed: returns why what is said does not hold any more, empty while it does; F8 then does nothing.
    """

    DEFAULT_CLASSES = "-warning"
    DEFAULT_CSS = """
    StartDialog > Vertical { width: 74; max-height: 92%; }
    StartDialog VerticalScroll { height: auto; max-height: 14; scrollbar-size-vertical: 1; }
    StartDialog #arm { margin-top: 1; background: $boost; }
    StartDialog #fault { color: $error; height: auto; }
    StartDialog #key { text-style: bold; color: $warning; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        # Keys in the footer can be clicked: this one is in the text.
        Binding(
            "f8",
            "begin",
            "let the arm move",
            show=False,
            id="start.begin",
            tooltip="the only key that begins it",
        ),
        Binding("escape", "back", "back", id="start.back"),
        Binding("pageup", "scroll(-1)", "earlier", show=False, id="start.earlier"),
        Binding("pagedown", "scroll(1)", "later", show=False, id="start.later"),
    ]

    def __init__(
        self,
        title: str,
        text: str,
        cell: str,
        *,
        simulated: bool | None,
        changed: Callable[[], str] = lambda: "",
    ) -> None:
        super().__init__(title, text)
        self._changed = changed
        self._cell = cell
        self._simulated = simulated

    def body(self) -> ComposeResult:
        """What begins, and what to do."""
        with VerticalScroll(can_focus=False):
            yield Static(self._text, id="text", markup=False)
        if self._simulated is not True:
            unless = "" if self._simulated is False else " (leave it empty for emulators)"
            yield Static(f"Real hardware: type the cell's name to arm it{unless}.", markup=False)
            yield Input(id="arm", compact=True, placeholder="name of the cell", max_length=_LONGEST_NAME)
        yield Static("", id="fault", markup=False)
        yield Static("F8  the arm moves        Esc  back; nothing moves", id="key", markup=False)

    def show_text(self, text: str) -> None:
        """Say something else: more is known by now."""
        self._text = text
        # It may not stand there yet, or not any more.
        for shown in self.query("#text").results(Static):
            shown.update(text)

    def action_scroll(self, pages: int) -> None:
        """Show what is above or below."""
        scrolled = self.query_one(VerticalScroll)
        scrolled.scroll_relative(y=pages * max(scrolled.size.height - 1, 1), animate=False)

    def action_begin(self) -> None:
        """Agree, if the name is right."""
        if changed := self._changed():
            text = f"✗ {changed}: nothing begins; Esc, then look again"
            self.query_one("#fault", Static).update(text)
            return
        typed = self.query_one("#arm", Input).value.strip() if self._simulated is not True else ""
        if self._simulated is False and typed != self._cell:
            self.query_one("#fault", Static).update(f"The devices are real: type {self._cell} to arm them.")
            return
        self.dismiss(Permission(typed or None))

    def action_back(self) -> None:
        """Go back."""
        self.dismiss(None)
