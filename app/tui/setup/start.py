"""What a first start offers."""

from pathlib import Path
from typing import Final

from textual.app import ComposeResult
from textual.containers import Vertical
from textual.content import Content
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from catseye.app.protocol.banners import SIMULATION
from catseye.app.tui.widgets.static_text import StaticText

CHOICES: Final = {
    "wizard": (
        "1",
        "Describe a bench by questions",
        "writes a cell file; each device's connection can be tested",
    ),
    "change": ("2", "Change the present cell file", "the same questions, with its values"),
    "open": ("3", "Open a cell file", "choose an existing one"),
    "emulated": (
        "4",
        "Emulated bench",
        f"{SIMULATION}: emulators of all devices; they end with the engine",
    ),
    "emulated_arm": (
        "5",
        "KUKA bench, emulated",
        f"{SIMULATION}: emulators of a KR 210 with optics for its motion resolution",
    ),
    "emulated_tracker": (
        "6",
        "IRB bench, emulated",
        f"{SIMULATION}: emulators of an IRB 120 in front of a laser tracker",
    ),
    "demo": ("7", "Demo", f"{SIMULATION}: the whole job on emulators, with its results"),
}
"""By name: key, title, what it does."""


class Start(Vertical):
    """The ways to a bench."""

    DEFAULT_CSS = """
    Start { padding: 0 2; height: 1fr; }
    Start #present { height: auto; padding: 1 0; }
    Start OptionList { height: auto; max-height: 14; border: none; background: $background; padding: 0; }
    Start OptionList:focus { border: none; }
    """

    def compose(self) -> ComposeResult:
        """What there is, and the choices."""
        yield StaticText(id="present")
        yield OptionList(*(Option(_prompt(name), id=name) for name in CHOICES), id="choices")

    def show(self, cell: Path | None, describing: bool, changing: bool) -> None:
        """Say what there is.

        Args:
            cell: the cell file; None while there is none.
            describing: questions about a new bench were left half-way.
            changing: so were those about the present cell file.
        """
        there = (
            Content.assemble("Cell file  ", (str(cell), "bold"))
            if cell is not None
            else Content("There is no cell file yet. It describes the bench.")
        )
        left = " ".join(key for key, half_way in (("1", describing), ("2", changing)) if half_way)
        more = Content(f"\nThe questions were left half-way: {left} continues with them." if left else "")
        self.query_one("#present", StaticText).set_text(there + more)
        choices = self.query_one(OptionList)
        if cell is None:
            choices.disable_option("change")
        elif choices.get_option("change").disabled:
            choices.enable_option("change")


def _prompt(name: str) -> Content:
    key, title, text = CHOICES[name]
    return Content.assemble((f" {key} ", "bold reverse"), f"  {title}\n", (f"     {text}", "dim"))
