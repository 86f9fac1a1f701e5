"""A result on the screen Results by the sections of its report, one at a time."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar, Final

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical, VerticalScroll
from textual.content import Content

from catseye.app.results.figures import Figure
from catseye.app.tui.widgets.arranged_tables import ArrangedTables, place_of_choice
from catseye.app.tui.widgets.copying import copy
from catseye.app.tui.widgets.figure_view import Figures
from catseye.app.tui.widgets.report_content import blocks_content
from catseye.app.tui.widgets.static_text import StaticText

if TYPE_CHECKING:
    # The first screen is painted before files and mathematics are imported.
    from catseye.app.results.model import Report, Section

_ABOVE_ROWS: Final = 6
_SIDEWAYS: Final = 8
"""Cells by which a text is scrolled sideways, and that stay in sight left of a column."""

_BESIDE_CELLS: Final = 92
"""A table of fewer rows, or that is wider, stands above the figures on any screen."""

Sections = tuple[tuple[str, str], ...]
"""Keys of a report's sections, and their titles in one line; the files stand before them, under 1."""


def section_bindings(kind: str, sections: Sections) -> list[BindingType]:
    """Return the keys that show the sections of a kind of results."""
    return [
        Binding(
            str(place + 2),
            f"screen.part({place + 1})",
            title,
            show=False,
            id=f"{kind}.show-{key}",
            tooltip="show this part",
        )
        for place, (key, title) in enumerate(sections)
    ]


class SectionView(Vertical, ArrangedTables, can_focus=True):
    """The section that is shown: what it says above, its figures below.

    Attributes:
        SECTIONS: of the kind of results.
        NOTHING: what to say of a section that says nothing, by its key.
        SENTENCES: keys of sections whose text is wrapped; rows of tables are scrolled.
    """

    SECTIONS: ClassVar[Sections] = ()
    NOTHING: ClassVar[Mapping[str, str]] = {}
    SENTENCES: ClassVar[frozenset[str]] = frozenset({"verdict", "flags"})

    DEFAULT_CSS = """
    SectionView #said { height: auto; max-height: 50%; padding: 0 1; scrollbar-size: 1 1; overflow-x: auto; }
    SectionView #said.alone { height: 1fr; max-height: 100%; }
    SectionView #said StaticText { width: auto; }
    SectionView #said.sentences StaticText { width: 1fr; }
    SectionView.no-figures #section-figures, SectionView.borrowed #section-figures { display: none; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "scroll(-1)", "up", show=False, id="section.up"),
        Binding("down", "scroll(1)", "down", show=False, id="section.down"),
        Binding("pageup", "scroll(-10)", "page up", show=False, id="section.page-up"),
        Binding("left", "turn(-1)", "left", show=False, id="section.left", tooltip="column of a table"),
        Binding("right", "turn(1)", "right", show=False, id="section.right", tooltip="column of a table"),
        Binding("C", "copy_text", "copy", show=False, id="section.copy", tooltip="the text of the section"),
        Binding("pagedown", "scroll(10)", "page down", show=False, id="section.page-down"),
    ]

    def __init__(self, *, id: str, classes: str) -> None:
        super().__init__(id=id, classes=classes)
        self._report: Report | None = None
        self._place = 0

    @property
    def titles(self) -> tuple[str, ...]:
        """Titles in one line, of the files and of the sections."""
        return ("Files", *(title for _, title in self.SECTIONS))

    def compose(self) -> ComposeResult:
        """Text above, figures below."""
        with VerticalScroll(id="said", can_focus=False):
            yield StaticText(id="said-text")
        figures = Figures(id="section-figures")
        figures.can_focus = False
        yield figures

    def show(self, report: "Report") -> None:
        """Show a result by its report; the section that was shown stays."""
        self._report = report
        self.forget_order()
        self._show()

    def show_section(self, place: int) -> None:
        """Show a section by its place."""
        if place != self._place:
            self.forget_order()
        self._place = place
        self._show()

    def action_scroll(self, rows: int) -> None:
        """Scroll the figures, or the text where there are none."""
        figures = self.query_one("#section-figures", Figures)
        scrolled = figures if figures.display else self.query_one("#said", VerticalScroll)
        scrolled.scroll_relative(y=rows, animate=False)

    def action_turn(self, step: int) -> None:
        """Choose a column of the tables, which comes into sight; without tables scroll the text sideways."""
        if not self.choose_column(step):
            self.query_one("#said", VerticalScroll).scroll_relative(x=_SIDEWAYS * step, animate=False)

    def on_filtered_rows_rearranged(self, event: ArrangedTables.Rearranged) -> None:
        """Show the rows that are asked for, in their order."""
        event.stop()
        said = self._said()
        self.query_one("#said-text", StaticText).set_text(said)
        place = place_of_choice(said.plain)
        if place is not None:
            self.query_one("#said", VerticalScroll).scroll_to(x=max(place - _SIDEWAYS, 0), animate=False)

    def action_copy_text(self) -> None:
        """Copy what the section says."""
        if text := self.query_one("#said-text", StaticText).text.plain:
            copy(self.app, text)

    def _show(self) -> None:
        key, _ = self.SECTIONS[self._place]
        found = self._section(key)
        figures = _figures_of(found)
        said = self._said()
        self._show_text(said, key, alone=not figures)
        borrowed = [] if figures else self._figures_after()
        self.set_class(not figures and not borrowed, "no-figures")
        self.set_class(bool(borrowed), "borrowed")
        beside = bool(borrowed) or _stands_beside(said.plain, key in self.SENTENCES)
        self.set_class(beside, "beside-text")
        self.query_one("#section-figures", Figures).show(*figures, *borrowed)

    def _said(self) -> Content:
        """Return the text of the section, its tables as they are arranged."""
        key, _ = self.SECTIONS[self._place]
        found = self._section(key)
        blocks = self.arranged(() if found is None else found.blocks)
        return Content(self.NOTHING.get(key, "")) if found is None else blocks_content(blocks)

    def _show_text(self, said: Content, key: str, *, alone: bool) -> None:
        text = self.query_one("#said", VerticalScroll)
        text.display = bool(said.plain)
        text.set_class(alone, "alone")
        text.set_class(key in self.SENTENCES, "sentences")
        text.scroll_home(animate=False)
        self.query_one("#said-text", StaticText).set_text(said)

    def _figures_after(self) -> list[Figure]:
        """Return the figures of the next section that has some: on a wide screen they stand beside this one."""
        keys = [key for key, _ in self.SECTIONS]
        others = (_figures_of(self._section(key)) for key in (*keys[self._place :], *keys[: self._place]))
        return next((figures for figures in others if figures), [])

    def _section(self, key: str) -> "Section | None":
        """Return a section; None where it says nothing."""
        found = None if self._report is None else self._report.section(key)
        return found if found is not None and found.blocks else None


def _figures_of(found: "Section | None") -> list[Figure]:
    return [] if found is None else [block for block in found.blocks if isinstance(block, Figure)]


def _stands_beside(text: str, sentences: bool) -> bool:
    """Return whether a text is read better beside the figures than above them, on a wide screen."""
    rows = text.splitlines()
    return len(rows) > _ABOVE_ROWS and (sentences or max(map(len, rows)) <= _BESIDE_CELLS)
