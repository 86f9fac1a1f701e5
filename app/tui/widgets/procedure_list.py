"""The procedures that a cell can run, each with the sign of what it needs."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

from textual.binding import Binding, BindingType
from textual.content import Content
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from catseye.app.results.model import Sign
from catseye.app.results.readiness.survey_report import worst_sign
from catseye.app.tui.widgets.filtered_rows import FilteredRows
from catseye.app.tui.widgets.report_content import sign_content

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.results.readiness.survey_document import ProcedureEntry


class ProcedureList(OptionList, FilteredRows):
    """In the order of the survey or by name; an arrow marks what comes next."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("s", "sort", "sort", show=False, id="list.sort", tooltip="sorts by name; again: unsorted"),
    ]

    def __init__(self, *, id: str) -> None:
        super().__init__(id=id, compact=True, markup=False)
        self.by_name = False
        self._entries: Sequence[ProcedureEntry] = ()
        self._known = False
        self._next = ""

    @property
    def names(self) -> list[str]:
        """Names of the procedures that are shown."""
        return [option.id for option in self.options if option.id is not None]

    def show_entries(self, entries: "Sequence[ProcedureEntry]", following: str, *, known: bool) -> None:
        """Show procedures.

        Args:
            following: name of the one that comes next; empty where none does.
            known: whether it was looked at what they need.
        """
        self._entries, self._next, self._known = entries, following, known
        self.fill()

    def fill(self) -> None:
        """Show what the filter leaves, in the order that was asked for."""
        entries = [each for each in self._entries if self.passes(f"{each.name} {each.title}")]
        if self.by_name:
            entries.sort(key=lambda entry: entry.name)
        self.clear_options()
        self.add_options(self._option(entry) for entry in entries)

    def choose(self, name: str) -> None:
        """Put the cursor on a procedure; a filter that hides it ends."""
        if name not in self.names:
            self.action_unfilter()
            self.fill()
        self.highlighted = self.get_option_index(name)

    def action_sort(self) -> None:
        """Sort by name, or show the order as it was."""
        self.by_name = not self.by_name
        self.post_message(self.Rearranged())

    def _option(self, entry: "ProcedureEntry") -> Option:
        arrow = "→" if entry.name == self._next else " "
        sign = worst_sign(entry.needs) if self._known else Sign.NEUTRAL
        return Option(Content.assemble(arrow, sign_content(sign), f" {entry.name}"), id=entry.name)
