"""Questions that a key answers; Esc is the safe answer, and Enter does nothing."""

from collections.abc import Callable
from typing import ClassVar, Final, Literal

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import Static

from catseye.app.tui.dialogs.box_dialog import BoxDialog

READ_S: Final = 1.2
"""F8 is not pressed for what nobody has had this long to read. No keyboard waits longer before it repeats a key."""


class ConfirmDialog(BoxDialog[bool]):
    """Asks; y agrees, Esc does not.

    Args:
        text: what follows from yes, and from no.
        yes: what y does, in a word or two.
    """

    DEFAULT_CLASSES = "-warning"
    DEFAULT_CSS = """
    ConfirmDialog > Vertical { width: 70; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("y", "choose(True)", "yes", id="confirm.yes"),
        Binding("escape", "choose(False)", "no", id="confirm.no"),
    ]

    def __init__(self, title: str, text: str, yes: str, no: str) -> None:
        super().__init__(title, f"{text}\n\ny  {yes}      Esc  {no}")

    def action_choose(self, agreed: bool) -> None:
        """Close with the answer."""
        self.dismiss(agreed)


class MotionDialog(BoxDialog[bool]):
    """Says what will move, how far and how fast; F8, the key for motion, has it done.

    Args:
        changed: returns why what is said does not hold any more, empty while it does; F8 then does nothing.
        now_s: monotonic time, s, where F8 leads here, too: held down, or pressed twice by mistake, it moves nothing.
    """

    DEFAULT_CLASSES = "-warning"
    DEFAULT_CSS = """
    MotionDialog > Vertical { width: 74; }
    MotionDialog Label { color: $warning; }
    MotionDialog #fault { color: $error; height: auto; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        # Keys in the footer can be clicked: this one is in the text.
        Binding("f8", "choose(True)", "move", show=False, id="motion.confirm", tooltip="the arm moves"),
        Binding("escape", "choose(False)", "do not move", id="motion.refuse"),
    ]

    def __init__(
        self,
        title: str,
        text: str,
        changed: Callable[[], str] = lambda: "",
        now_s: Callable[[], float] | None = None,
    ) -> None:
        super().__init__(title, f"{text}\n\nF8  move    Esc  do not move")
        self._changed = changed
        self._now_s = now_s
        self._pressed_s = 0.0 if now_s is None else now_s()

    def body(self) -> ComposeResult:
        """The text, and why F8 does nothing."""
        yield from super().body()
        yield Static("", id="fault", markup=False)

    def action_choose(self, move: bool) -> None:
        """Close with the decision, if what was read still holds."""
        fault = self._why_not() if move else ""
        self.query_one("#fault", Static).update(f"✗ {fault}" if fault else "")
        if not fault:
            self.dismiss(move)

    def _why_not(self) -> str:
        if changed := self._changed():
            return f"{changed}: nothing was moved; Esc, then look again"
        if self._now_s is None:
            return ""
        before_s, self._pressed_s = self._pressed_s, self._now_s()
        return "" if self._pressed_s - before_s >= READ_S else "read it, then press F8 once"


Choice = Literal["leave", "hold", "stop"]


class QuitDialog(BoxDialog[Choice | None]):
    """Asks what becomes of the run when the user quits; None goes back to it.

    Args:
        run: its name.
        bench: what becomes of an emulated bench when the run is left; empty for a real one.
    """

    DEFAULT_CLASSES = "-warning"
    DEFAULT_CSS = """
    QuitDialog > Vertical { width: 66; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("1", "choose('leave')", "leave it running", id="quit.leave"),
        Binding("2", "choose('hold')", "hold it", id="quit.hold"),
        Binding("3", "choose('stop')", "stop it", id="quit.stop"),
        Binding("escape", "choose('')", "stay here", id="quit.stay"),
    ]

    def __init__(self, run: str, bench: str = "") -> None:
        super().__init__(
            "A run is under way",
            f"{run}\n\n"
            "1  leave it running: the engine goes on without this screen; its questions wait"
            f"{f'; {bench}' if bench else ''}\n"
            "2  hold it at the next checkpoint, then quit\n"
            "3  stop it now, wait for standstill, then quit; it can be resumed\n"
            "Esc  stay here\n\n"
            "catseye tui comes back to it at any time.",
        )

    def action_choose(self, choice: str) -> None:
        """Take a choice."""
        match choice:
            case "leave" | "hold" | "stop":
                self.dismiss(choice)
            case _:
                self.dismiss(None)
