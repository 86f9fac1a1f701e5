"""The screen Results: one result seen in parts, and two compared."""

import asyncio
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Final

from rich.text import Text
from textual.app import ComposeResult, SystemCommand
from textual.binding import Binding, BindingType
from textual.containers import Vertical, VerticalScroll
from textual.content import Content
from textual.timer import Timer
from textual.widgets import ContentSwitcher, DataTable

from catseye.app.results.numbers import counted
from catseye.app.tui import result_shelf as shelf
from catseye.app.tui.dialogs.form_dialog import Answers, Field, FormDialog
from catseye.app.tui.dialogs.text_dialog import TextDialog
from catseye.app.tui.path_questions import newest_path_run, path_fault, reference_of
from catseye.app.tui.resolution.result_view import ResolutionView
from catseye.app.tui.screens.working import WorkScreen, free_name, typed_path, why_not_written
from catseye.app.tui.serial.result_view import SerialArmView
from catseye.app.tui.session import Session
from catseye.app.tui.widgets.bars import TabLine
from catseye.app.tui.widgets.file_table import FileTable
from catseye.app.tui.widgets.report_content import statement_content
from catseye.app.tui.widgets.result_parts import ComparePart, LayoutPart, MapsPart, PathPart, ResidualsPart
from catseye.app.tui.widgets.row_table import RowTable
from catseye.app.tui.widgets.section_view import SectionView
from catseye.app.tui.widgets.static_text import StaticText, lines
from catseye.app.tui.widgets.task_line import TaskLine
from catseye.app.tui.work import Done

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
    "fit": "#fit",
    "path": "#path-figures",
    "compare": "#comparison-text",
}
"""What is scrolled in a part."""
_PARTS: Final = tuple(_FOCUS)
_TITLES: Final = tuple(name.capitalize() for name in _PARTS)

_LOOK_S: Final = 3.0
_VALUE_COLUMNS: Final = (("quantity", 22), ("value", 14), ("u (k=1)", 10), ("U (k=2)", 10), (" unit", 6))
_RIGHT: Final = frozenset({"value", "u (k=1)", "U (k=2)", "distances", "rms µm"})
_OF_SCARAS: Final = frozenset({"diagnose", "validate", "compare", "unit", "export"})
"""What there is to do with a SCARA's result alone."""


class ResultsScreen(WorkScreen):
    """Parts in one line, which result in the next, the part below."""

    SCREEN = "results"
    AUTO_FOCUS = "#file-table"

    DEFAULT_CSS = """
    ResultsScreen #heading { height: 1; padding: 0 1; color: $primary; text-wrap: nowrap; text-overflow: ellipsis; }
    ResultsScreen ContentSwitcher { height: 1fr; }
    ResultsScreen DataTable { height: 1fr; background: $background; scrollbar-size: 1 1; padding: 0 0 0 1; }
    ResultsScreen .part { height: 1fr; }
    ResultsScreen .legend { height: 1; padding: 0 1; color: $text-muted; }
    ResultsScreen .text { padding: 0 1; scrollbar-size-vertical: 1; }
    ResultsScreen .beside { width: 62; }
    ResultsScreen .below { height: 2fr; }
    ResultsScreen .short { height: auto; max-height: 6; }
    ResultsScreen.-high .short { max-height: 9; }
    ResultsScreen .charts { height: 3fr; }
    ResultsScreen.-narrow .beside { width: 1fr; height: auto; max-height: 6; }
    ResultsScreen.-narrow .charts { layout: vertical; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        *(
            Binding(
                str(place + 1),
                f"part({place})",
                name.capitalize(),
                show=False,
                id=f"results.show-{name}",
                tooltip="show this part",
            )
            for place, name in enumerate(_PARTS)
        ),
        Binding("d", "diagnose", "diagnose", id="results.diagnose", tooltip="what speaks against the fit"),
        Binding(
            "t", "validate", "path", id="results.validate", tooltip="against an independently measured path"
        ),
        Binding("b", "compare", "compare", id="results.compare", tooltip="with the result under the cursor"),
        Binding(
            "u", "unit", "mdeg/u", id="results.unit", tooltip="differences in mdeg, or in their uncertainty"
        ),
        Binding("p", "report", "page", id="results.report", tooltip="write the report, one HTML page"),
        Binding("o", "open_page", "open", id="results.open", tooltip="show the last report in the browser"),
        Binding("e", "export", "export", id="results.export", tooltip="values for other programs"),
        Binding(
            "colon",
            "type",
            "type",
            key_display=":",
            id="results.type",
            tooltip="commands: predict, compensate, validate",
        ),
        Binding("escape", "back", "back", show=False, id="results.back", tooltip="cancel; back to the files"),
    ]  # fmt: skip - a key a line

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self.HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (110, "-wide")]
        self.VERTICAL_BREAKPOINTS = [(0, "-low"), (32, "-high")]
        self._shelf: AnyFiles | None = None
        self._files: list[AnyFile] = []
        self._timer: Timer | None = None
        self._looking = False
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
            with Vertical(id="files", classes="part"):
                yield FileTable(id="file-table")
            yield MapsPart(id="maps", classes="part")
            with Vertical(id="values", classes="part"):
                yield RowTable(id="value-table")
            yield LayoutPart(id="layout", classes="part charts")
            yield ResidualsPart(id="residuals", classes="part")
            with VerticalScroll(id="fit", classes="part text"):
                yield StaticText(id="findings")
            yield PathPart(id="path", classes="part")
            yield ComparePart(id="compare", classes="part")
            yield ResolutionView(id="resolution", classes="part")
            yield SerialArmView(id="serial-arm", classes="part")
        yield TaskLine(self.session.now_s)

    def commands(self) -> Iterable[SystemCommand]:
        """Return what this screen can do."""
        for place, name in enumerate(_PARTS):
            part = partial(self.action_part, place)
            yield SystemCommand(f"Results: {name.capitalize()}", "show this part", part)
        yield SystemCommand("Diagnose the result", "outliers, drift, lack of fit", self.action_diagnose)
        yield SystemCommand("Validate the result", "against a measured path", self.action_validate)
        yield SystemCommand("Compare results", "with the one under the cursor", self.action_compare)
        yield SystemCommand("Differences in mdeg or in u", "of two results", self.action_unit)
        yield SystemCommand("Report of the result", "one HTML page", self.action_report)
        yield SystemCommand("Open the report", "in the system's browser", self.action_open_page)
        yield SystemCommand("Export the result", "CSV, JSON or Parquet", self.action_export)
        yield SystemCommand("Predict and compensate", "the commands to type", self.action_type)
        yield SystemCommand("Cancel the work", "that is under way on this screen", self.action_cancel)

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Return whether there is such a thing to do with the result that is shown."""
        del parameters
        return self._paged is None or action not in _OF_SCARAS

    def on_mount(self) -> None:
        """Make the columns; files are read in a thread."""
        for table, columns in (("#file-table", shelf.FILE_COLUMNS), ("#value-table", _VALUE_COLUMNS)):
            for name, width in columns:
                label = Text(name, justify="right" if name in _RIGHT else "left")
                self.query_one(table, DataTable).add_column(label, width=width, key=name or "mark")
        self._timer = self.set_interval(_LOOK_S, self._look)
        self.query_one("#heading", StaticText).set_text(Content("reading the result files …"))

    def on_screen_resume(self) -> None:
        """Look for results."""
        if self._timer is not None:
            self._timer.resume()
        self._look()

    def on_screen_suspend(self) -> None:
        """Do not look while nobody sees it."""
        if self._timer is not None:
            self._timer.pause()

    def on_data_table_row_selected(self, event: DataTable.RowSelected) -> None:
        """Show the chosen result."""
        if event.data_table.id == "file-table" and (file := self._under_cursor()) is not None:
            self._choose(file)

    def action_part(self, place: int) -> None:
        """Show a part."""
        view = self._section_view()
        if view is not None and place > 0:
            name, focus = view.id, f"#{view.id}"
            view.show_section(place - 1)
        else:
            name = _PARTS[place]
            focus = _FOCUS[name]
        self.query_one(ContentSwitcher).current = name
        self.query_one(TabLine).show(place, _TITLES if view is None else view.titles)
        self.set_focus(self.query_one(focus))

    def action_back(self) -> None:
        """Cancel the work, else go back to the files."""
        if not self.cancel_work():
            self.action_part(0)

    def action_cancel(self) -> None:
        """Cancel the work."""
        self.cancel_work()

    def action_unit(self) -> None:
        """Show differences in mdeg, or in combined standard uncertainties."""
        self._in_u = not self._in_u
        self._show_comparison()

    def action_compare(self) -> None:
        """Compare the shown result with the one under the cursor."""
        file, other = self._shown_file(), self._under_cursor()
        if file is None or other is None:
            return
        if file.path == other.path:
            self.notify("put the cursor on another result (1), then b", severity="warning")
            self.action_part(0)
            return
        self.spawn(partial(self._compare, file, other), "compare", exclusive=True)

    def action_diagnose(self) -> None:
        """Find what speaks for and against the fit."""
        file = self._shown_file()
        if file is None or file.result is None:
            return
        source = shelf.source_of(file, self.session.root, self.session.cell)
        if not source:
            self.catseye.show_error(
                "The fit cannot be diagnosed",
                f"the distances of {file.path.name} are neither in {self.session.root} nor beside it "
                f"({', '.join(file.result.provenance.runs) or 'it names no runs'}): put the runs there",
            )
            return
        self.let_work(
            "diagnose",
            "The fit cannot be diagnosed",
            *("diagnose", *source, "--json"),
            done=partial(self._diagnosed, file),
        )

    def action_validate(self) -> None:
        """Ask for a measured path, and compare."""
        if self._shown_file() is not None:
            self.spawn(self._ask_for_path, "ask", exclusive=True)

    def action_report(self) -> None:
        """Write the report."""
        if (file := self._paged or self._shown_file()) is not None:
            page = file.path.with_suffix(".html")
            sources = [file.path] if self._paged is None else self._reported
            self.let_work(
                "report",
                "The report was not written",
                "report",
                *sources,
                "-o",
                page,
                done=lambda _: self.show_written(page, "report"),
            )

    def action_export(self) -> None:
        """Ask for a file, and write the values."""
        if (file := self._shown_file()) is not None:
            fields = [Field("file", "file", str(free_name(file.path.with_suffix(".csv"))))]
            text = f"{file.path.name}: the file ends in .csv, .json or .parquet"
            dialog = FormDialog("Export", fields, text, lambda answers: why_not_written(answers["file"]))
            self.app.push_screen(dialog, partial(self._export, file))

    def action_type(self) -> None:
        """Show commands that go on from the result."""
        if (file := self._paged or self._shown_file()) is not None:
            from catseye.app.tui.result_texts import lines_to_type

            path, kind = file.path, self._kind
            text = lines_to_type(path, self.session.cell) if kind is None else kind.commands(file)
            self.app.push_screen(TextDialog(f"Go on from {path.name}", text))

    def _shown_file(self) -> "ScaraFile | None":
        """Return the chosen result of a SCARA, else the one under the cursor, if it is one and can be read."""
        file = self._under_cursor()
        if self._file is None and file is None:
            self.notify("there is no result yet: identify on Runs (F7), i")
        elif self._file is None and file is not None:
            self._choose(file, go=False)
        return self._file

    def _under_cursor(self) -> "AnyFile | None":
        row = self.query_one("#file-table", DataTable).cursor_row
        return self._files[row] if 0 <= row < len(self._files) else None

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
        self._reported = await asyncio.to_thread(kind.files, file.path, file.result)
        report = await asyncio.to_thread(kind.report, self._reported)
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

    def _diagnosed(self, file: "ScaraFile", done: Done) -> None:
        from catseye.app.results.scara.diagnosis_document import DiagnosisDocument

        self._diagnoses[shelf.version_of(file)] = done.document(DiagnosisDocument)
        self._show()
        self.notify(f"{file.path.name}: outliers at 5, findings at 6", title="diagnosed", markup=False)

    def _export(self, file: "ScaraFile", answers: Answers | None) -> None:
        if answers is not None:
            output = typed_path(answers["file"])
            self.let_work(
                "export",
                "Nothing was exported",
                *("export", file.path, "-o", output),
                done=lambda _: self.show_written(output, "export"),
            )

    async def _ask_for_path(self) -> None:
        file = self._file
        if file is None:
            return
        reference = reference_of(file, shelf.scaras_of(self._files))
        newest = await asyncio.to_thread(newest_path_run, self.session.root)
        fields = [
            Field("measured", "path", newest, hint="run, or CSV"),
            Field("reference", "compared with", str(reference or ""), hint="or empty"),
        ]
        dialog = FormDialog("Validate on a measured path", fields, file.path.name, path_fault)
        self.app.push_screen(dialog, partial(self._validate, file))

    def _validate(self, file: "ScaraFile", answers: Answers | None) -> None:
        if answers is None:
            return
        measured = typed_path(answers["measured"])
        reference = ("--reference", typed_path(answers["reference"])) if answers["reference"] else ()
        self.let_work(
            "validate",
            "The result cannot be validated on this path",
            *(
                "validate",
                file.path,
                "--measured",
                measured,
                "--runs",
                self.session.root,
                *reference,
                "--json",
            ),
            done=partial(self._validated, file),
        )

    def _validated(self, file: "ScaraFile", done: Done) -> None:
        from catseye.app.results.scara.validation_document import AnyValidationDocument, ValidationDocument

        if not isinstance(found := done.document(AnyValidationDocument).root, ValidationDocument):
            self.app.push_screen(TextDialog(f"{file.path.name} on distances along a path", done.talk))
            return
        self._validations[shelf.version_of(file)] = found
        self._show()
        if self._file is file:
            self.action_part(_PARTS.index("path"))
        else:
            self.notify(f"{file.path.name}: choose it, then 7", title="validated", markup=False)

    async def _compare(self, file: "ScaraFile", other: "AnyFile") -> None:
        found = await asyncio.to_thread(shelf.compared, file, other)
        if isinstance(found, str):
            self.catseye.show_error("The results cannot be compared", found)
        elif self._file is file:
            self._other, self._comparison = other, found
            self._show_comparison()
            self._show_files()
            self.action_part(_PARTS.index("compare"))

    def _look(self) -> None:
        if not self._looking:
            self._looking = True
            self.spawn(self._look_for_files, "look")

    async def _look_for_files(self) -> None:
        first = self._shelf is None
        try:
            if self._shelf is None:
                self._shelf = await asyncio.to_thread(shelf.shelf_of, self.session.root)
            files = await asyncio.to_thread(self._shelf.look)
        finally:
            self._looking = False
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
        table = self.query_one("#value-table", DataTable)
        table.clear()
        for row in texts.value_rows(result):
            table.add_row(
                Text(row[0]), *(Text(cell, justify="right") for cell in row[1:4]), Text(f" {row[4]}")
            )
        self.query_one(LayoutPart).show(result)
        self.query_one(ResidualsPart).show(result, diagnosis)
        self.query_one(PathPart).show(self._validations.get(shelf.version_of(file)))
        findings = map(statement_content, texts.fit_sentences(result, diagnosis))
        self.query_one("#findings", StaticText).set_text(lines(*findings))
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
