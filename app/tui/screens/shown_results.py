"""What the screen Results shows: the result files, the parts of the chosen one, and two compared."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

from rich.text import Text
from textual.app import ComposeResult
from textual.containers import Horizontal
from textual.content import Content
from textual.widgets import ContentSwitcher, DataTable

from catseye.app.results.numbers import counted
from catseye.app.tui import result_shelf as shelf
from catseye.app.tui.aside import read_aside
from catseye.app.tui.previewed import previewed_result
from catseye.app.tui.resolution.result_view import ResolutionView
from catseye.app.tui.screens.looking import LookingScreen
from catseye.app.tui.serial.result_view import SerialArmView
from catseye.app.tui.session import Session
from catseye.app.tui.widgets.bars import TabLine
from catseye.app.tui.widgets.file_table import FileTable
from catseye.app.tui.widgets.preview import Preview
from catseye.app.tui.widgets.result_parts import (
    ComparePart,
    FitPart,
    LayoutPart,
    MapsPart,
    PathPart,
    ResidualsPart,
    ValuesPart,
)
from catseye.app.tui.widgets.row_table import RowTable
from catseye.app.tui.widgets.section_view import SectionView
from catseye.app.tui.widgets.static_text import StaticText
from catseye.app.tui.widgets.task_line import TaskLine

if TYPE_CHECKING:
    # The first screen is painted before files and mathematics are imported.
    from catseye.app.results.scara.comparison import ResultComparison
    from catseye.app.results.scara.diagnosis_document import DiagnosisDocument
    from catseye.app.results.scara.validation_document import ValidationDocument
    from catseye.app.tui.report_kind import ReportKind
    from catseye.app.tui.result_shelf import AnyFile, AnyFiles, ScaraFile

_FOCUS: Final = {
    "files": "#file-table",
    "maps": "#map-figures",
    "values": "#value-table",
    "layout": "#places-text",
    "residuals": "#residual-figures",
    "fit": "#findings-text",
    "path": "#path-figures",
    "compare": "#comparison-text",
}
"""What is scrolled in a part."""
PARTS: Final = tuple(_FOCUS)
"""Names of the parts of a SCARA's result, the files first."""

_TITLES: Final = tuple(name.capitalize() for name in PARTS)

_RIGHT: Final = frozenset({"distances", "rms µm"})


class ShownResults(LookingScreen):
    """Parts in one line, which result in the next, the part below."""

    AUTO_FOCUS = "#file-table"
    look_s = 3.0

    DEFAULT_CSS = """
    ShownResults #heading { height: 1; padding: 0 1; color: $primary; text-wrap: nowrap; text-overflow: ellipsis; }
    ShownResults ContentSwitcher { height: 1fr; }
    ShownResults DataTable { height: 1fr; background: $background; scrollbar-size: 1 1; padding: 0 0 0 1; }
    ShownResults .part { height: 1fr; }
    ShownResults .legend { height: 1; padding: 0 1; color: $text-muted; }
    ShownResults .text { padding: 0 1; scrollbar-size-vertical: 1; }
    ShownResults .beside { width: 62; }
    ShownResults .below { height: 2fr; }
    ShownResults .short { height: auto; max-height: 6; }
    ShownResults.-high .short { max-height: 9; }
    ShownResults .charts { height: 3fr; }
    ShownResults.-narrow .beside { width: 1fr; height: auto; max-height: 6; }
    ShownResults.-narrow .charts { layout: vertical; }
    ShownResults .aside { display: none; width: 1fr; }
    ShownResults.-huge .aside { display: block; }
    ShownResults.-huge #file-table { width: 84; }
    ShownResults.-huge #value-table { width: 66; }
    ShownResults.-huge #findings-text { width: 2fr; }
    ShownResults.-huge FitPart .aside { width: 3fr; }
    ShownResults.-huge #place-figures { height: 1fr; }
    ShownResults.-huge #places-text { height: auto; max-height: 60%; }
    ShownResults.-huge #place-side { width: 72; }
    ShownResults.-huge PathPart, ShownResults.-huge ComparePart { layout: horizontal; }
    ShownResults.-huge PathPart .short { width: 72; height: 1fr; max-height: 100%; }
    ShownResults.-huge ComparePart .charts { width: 1fr; height: 1fr; }
    ShownResults.-huge ComparePart .below { width: 96; height: 1fr; }
    ShownResults.-huge #difference-legend { dock: bottom; }
    ShownResults.-huge SectionView.beside-text { layout: horizontal; }
    ShownResults.-huge SectionView.beside-text #said { width: auto; max-width: 50%; height: 1fr; max-height: 100%; }
    ShownResults.-huge SectionView.beside-text #said.sentences { width: 40%; }
    ShownResults.-huge SectionView.borrowed #section-figures { display: block; }
    """

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self.HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (110, "-wide"), (160, "-huge")]
        self.VERTICAL_BREAKPOINTS = [(0, "-low"), (32, "-high")]
        self._shelf: AnyFiles | None = None
        self._files: list[AnyFile] = []
        self._file: ScaraFile | None = None
        # A result that is shown by the sections of its report, and how.
        self._paged: AnyFile | None = None
        self._kind: ReportKind | None = None
        self._reported: list[Path] = []
        self._other: AnyFile | None = None
        self._in_u = False
        self._diagnoses: dict[shelf.Version, DiagnosisDocument] = {}
        self._validations: dict[shelf.Version, ValidationDocument] = {}
        self._comparison: ResultComparison | None = None

    def body(self) -> ComposeResult:
        """Parts, which result, the part."""
        yield TabLine(_TITLES)
        yield StaticText(id="heading")
        with ContentSwitcher(initial="files"):
            with Horizontal(id="files", classes="part"):
                yield FileTable(id="file-table")
                yield Preview(id="preview", classes="aside")
            yield MapsPart(id="maps", classes="part")
            yield ValuesPart(id="values", classes="part")
            yield LayoutPart(id="layout", classes="part charts")
            yield ResidualsPart(id="residuals", classes="part")
            yield FitPart(id="fit", classes="part")
            yield PathPart(id="path", classes="part")
            yield ComparePart(id="compare", classes="part")
            yield ResolutionView(id="resolution", classes="part")
            yield SerialArmView(id="serial-arm", classes="part")
        yield TaskLine(self.session.now_s)

    def on_mount(self) -> None:
        """Make the columns; files are read in a thread."""
        for name, width in shelf.FILE_COLUMNS:
            label = Text(name, justify="right" if name in _RIGHT else "left")
            self.query_one(FileTable).add_column(label, width=width, key=name or "mark")
        self.query_one("#heading", StaticText).set_text(Content("reading the result files …"))

    def on_data_table_row_selected(self, event: DataTable.RowSelected) -> None:
        """Show the chosen result."""
        if event.data_table.id == "file-table" and (file := self._under_cursor()) is not None:
            self._choose(file)

    def on_data_table_row_highlighted(self, event: DataTable.RowHighlighted) -> None:
        """Show what the result under the cursor comes to, where there is room."""
        if event.data_table.id == "file-table":
            file = self._under_cursor()
            self.query_one(Preview).show_soon(None if file is None else partial(previewed_result, file))

    def action_part(self, place: int) -> None:
        """Show a part."""
        view = self._section_view()
        if view is not None and place > 0:
            name, focus = view.id, f"#{view.id}"
            view.show_section(place - 1)
        else:
            name = PARTS[place]
            focus = _FOCUS[name]
        self.query_one(ContentSwitcher).current = name
        self.query_one(TabLine).show(place, _TITLES if view is None else view.titles)
        self.set_focus(self.query_one(focus))

    def _shown_file(self) -> "ScaraFile | None":
        """Return the chosen result of a SCARA, else the one under the cursor, if it is one and can be read."""
        file = self._under_cursor()
        if self._file is None and file is None:
            self.notify("there is no result yet: identify on Runs (F7), i")
        elif self._file is None and file is not None:
            self._choose(file, go=False)
        return self._file

    def _under_cursor(self) -> "AnyFile | None":
        chosen = self.query_one(FileTable).chosen
        return next((file for file in self._files if str(file.path) == chosen), None)

    def _choose(self, file: "AnyFile", *, go: bool = True) -> None:
        if file.result is None:
            self.catseye.show_error(f"{file.path.name} cannot be read", file.fault)
            return
        if (kind := shelf.report_kind(file)) is not None:
            self.spawn(partial(self._open_paged, file, kind), "report-of", exclusive=True)
        elif (scaras := shelf.as_scaras(file)) is not None and scaras.result is not None:
            self._file, self._comparison, self._other = scaras, None, None
            self._paged, self._kind = None, None
            self._show_chosen()
            if go:
                self.action_part(1 if scaras.result.has_maps else 2)

    async def _open_paged(self, file: "AnyFile", kind: "ReportKind", *, go: bool = True) -> None:
        """Show a result by the sections of its report, which is made in a thread."""
        self._reported = await read_aside(partial(kind.files, file.path, file.result))
        report = await read_aside(partial(kind.report, self._reported))
        self._paged, self._kind = file, kind
        self._file, self._comparison, self._other = None, None, None
        self.query_one(f"#{kind.view}", SectionView).show(report)
        self._show_chosen()
        if go:
            self.action_part(1)

    def _section_view(self) -> SectionView | None:
        """Return what shows the chosen result by its sections; None for a SCARA's."""
        return None if self._kind is None else self.query_one(f"#{self._kind.view}", SectionView)

    def _show_chosen(self) -> None:
        self.refresh_bindings()
        self._show()
        self._show_files()

    async def look_once(self) -> None:
        """Look for result files."""
        first = self._shelf is None
        try:
            if self._shelf is None:
                self._shelf = await read_aside(partial(shelf.shelf_of, self.session.root))
            files = await read_aside(self._shelf.look)
        finally:
            self.looking = False
        if files != self._files or first:
            self._files = files
            self._follow(files)
            self._show_files()
            self._show()
        self._show_wanted()

    def _show_wanted(self) -> None:
        """Show the result that another screen has named."""
        wanted, self.session.wanted = self.session.wanted, None
        file = next((file for file in self._files if wanted and file.path == wanted.absolute()), None)
        if file is not None:
            self._choose(file)
        elif wanted is not None:
            self.notify(f"{wanted} is not among the results here", severity="warning", markup=False)

    def _follow(self, files: "list[AnyFile]") -> None:
        """Show the chosen result as its file is now; a comparison with what was before is none."""
        now = {file.path: file for file in files}
        compared = [file for file in (self._file, self._other) if file is not None]
        if any(now.get(file.path) is not file for file in compared):
            self._comparison, self._other = None, None
        again = None if self._file is None else now.get(self._file.path)
        if again is not None and (scaras := shelf.as_scaras(again)) is not None:
            self._file = scaras
        chosen = self._paged
        later = None if chosen is None else now.get(chosen.path)
        if later is not None and later is not chosen and (kind := shelf.report_kind(later)) is not None:
            self.spawn(partial(self._open_paged, later, kind, go=False), "report-of", exclusive=True)

    def on_filtered_rows_rearranged(self, event: RowTable.Rearranged) -> None:
        """Show the files that are asked for, in their order."""
        event.stop()
        self._show_files()

    def _show_files(self) -> None:
        shown, other = self._file or self._paged, self._other
        self.query_one(FileTable).show_files(
            self._files, None if shown is None else shown.path, None if other is None else other.path
        )

    def _show(self) -> None:
        """Show every part of the chosen result."""
        if self._paged is not None and self._kind is not None:
            self._show_heading(self._paged, self._kind.heading_of(self._paged))
            return
        file = self._file
        if file is None or file.result is None:
            where = "Enter shows one" if self._files else "none yet: identify on Runs (F7), i"
            count = counted(len(self._files), "result")
            self.query_one("#heading", StaticText).set_text(Content(f"{count}; {where}"))
            return
        from catseye.app.tui import result_texts as texts

        result = file.result
        diagnosis = self._diagnoses.get(shelf.version_of(file))
        self._show_heading(file, texts.heading(file))
        self.query_one(MapsPart).show(result)
        self.query_one(ValuesPart).show(result)
        self.query_one(LayoutPart).show(result)
        self.query_one(ResidualsPart).show(result, diagnosis)
        self.query_one(PathPart).show(self._validations.get(shelf.version_of(file)))
        self.query_one(FitPart).show(result, diagnosis)
        self._show_comparison()

    def _show_heading(self, file: "AnyFile", text: str) -> None:
        gone = "" if any(each is file for each in self._files) else "THE FILE IS GONE OR CANNOT BE READ · "
        self.query_one("#heading", StaticText).set_text(Content(f"{gone}{text}"))

    def _show_comparison(self) -> None:
        part = self.query_one(ComparePart)
        if self._comparison is None or self._other is None or self._file is None:
            part.show_nothing()
            return
        names = f"{self._other.path.name} (second) minus {self._file.path.name} (first)"
        part.show(names, self._comparison, in_u=self._in_u)
