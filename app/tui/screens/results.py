"""The screen Results: what there is to do with a result."""

from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING, ClassVar, Final

from textual.app import SystemCommand
from textual.binding import Binding, BindingType

from catseye.app.service.command_process import Done
from catseye.app.tui import result_shelf as shelf
from catseye.app.tui.aside import read_aside
from catseye.app.tui.dialogs.form_dialog import Answers, Field, FormDialog
from catseye.app.tui.dialogs.text_dialog import TextDialog
from catseye.app.tui.path_questions import newest_path_run, path_fault, reference_of
from catseye.app.tui.screens.shown_results import PARTS, ShownResults
from catseye.app.tui.screens.working import free_name, typed_path, why_not_written

if TYPE_CHECKING:
    # The first screen is painted before files and mathematics are imported.
    from catseye.app.tui.result_shelf import AnyFile, ScaraFile

_OF_SCARAS: Final = frozenset({"diagnose", "validate", "compare", "unit", "export"})
"""What there is to do with a SCARA's result alone."""


class ResultsScreen(ShownResults):
    """The results that are there; the keys diagnose, validate, compare, report and export the chosen one."""

    SCREEN = "results"

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
            for place, name in enumerate(PARTS)
        ),
        Binding("d", "diagnose", "diagnose", id="results.diagnose", tooltip="checks the fit"),
        Binding(
            "t",
            "validate",
            "path",
            id="results.validate",
            tooltip="compares the result with an independently measured path",
        ),
        Binding(
            "b",
            "compare",
            "compare",
            id="results.compare",
            tooltip="compares with the result under the cursor",
        ),
        Binding(
            "u", "unit", "mdeg/u", id="results.unit", tooltip="shows differences in mdeg or in units of u"
        ),
        Binding("p", "report", "page", id="results.report", tooltip="writes the report, one HTML page"),
        Binding("o", "open_page", "open", id="results.open", tooltip="opens the last report in the browser"),
        Binding("e", "export", "export", id="results.export", tooltip="writes the values for other programs"),
        Binding(
            "colon",
            "type",
            "type",
            key_display=":",
            id="results.type",
            tooltip="shows the commands for predict, compensate and validate",
        ),
        Binding(
            "escape", "back", "back", show=False, id="results.back", tooltip="cancels; back to the files"
        ),
    ]  # fmt: skip - a key a line

    def commands(self) -> Iterable[SystemCommand]:
        """Return what this screen can do."""
        for place, name in enumerate(PARTS):
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
        offered = self._paged is None or action not in _OF_SCARAS
        return offered and super().check_action(action, parameters)

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
        newest = await read_aside(partial(newest_path_run, self.session.root))
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
            self.action_part(PARTS.index("path"))
        else:
            self.notify(f"{file.path.name}: choose it, then 7", title="validated", markup=False)

    async def _compare(self, file: "ScaraFile", other: "AnyFile") -> None:
        found = await read_aside(partial(shelf.compared, file, other))
        if isinstance(found, str):
            self.catseye.show_error("The results cannot be compared", found)
        elif self._file is file:
            self._other, self._comparison = other, found
            self._show_comparison()
            self._show_files()
            self.action_part(PARTS.index("compare"))
