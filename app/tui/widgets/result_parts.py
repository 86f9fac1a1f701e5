"""The parts of a SCARA's result: maps, values, layout, residuals, fit, path, comparison."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar, Final

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical, VerticalScroll
from textual.content import Content
from textual.widget import Widget

from catseye.app.tui.widgets.arranged_tables import ArrangedTables
from catseye.app.tui.widgets.figure_view import Figures
from catseye.app.tui.widgets.report_content import blocks_content, statement_content
from catseye.app.tui.widgets.row_table import RowTable
from catseye.app.tui.widgets.static_text import StaticText, lines

if TYPE_CHECKING:
    # The first screen is painted before files and mathematics are imported.
    from catseye.app.results.model import Block
    from catseye.app.results.scara.comparison import ResultComparison
    from catseye.app.results.scara.diagnosis_document import DiagnosisDocument
    from catseye.app.results.scara.result import Result
    from catseye.app.results.scara.validation_document import ValidationDocument

_VALUE_COLUMNS: Final = (("quantity", 22), ("value", 14), ("U (k=2)", 10), (" unit", 6))
_RIGHT: Final = frozenset({"value", "U (k=2)"})


class MapsPart(Vertical):
    """Both maps side by side."""

    def compose(self) -> ComposeResult:
        """Maps, or why there are none."""
        yield Figures(id="map-figures")
        yield StaticText(id="no-map", classes="legend")

    def show(self, result: "Result") -> None:
        """Show the maps of a result; of a conventional model its offset."""
        from catseye.app.results.scara.figures.maps import map_figure
        from catseye.app.results.scara.fit_text import no_map_text

        self.query_one(Figures).show(map_figure(result))
        text = no_map_text(result)
        self.query_one("#no-map").display = bool(text)
        _write(self, "#no-map", text)


class ValuesPart(Horizontal):
    """Every parameter in a row; the maps beside them where there is room."""

    def __init__(self, *, id: str, classes: str) -> None:
        super().__init__(id=id, classes=classes)
        self._rows: list[list[Text]] = []

    def compose(self) -> ComposeResult:
        """Table and maps."""
        yield RowTable(id="value-table")
        yield Figures(id="value-figures", classes="aside")

    def on_mount(self) -> None:
        """Make the columns."""
        for name, width in _VALUE_COLUMNS:
            label = Text(name, justify="right" if name in _RIGHT else "left")
            self.query_one(RowTable).add_column(label, width=width, key=name)

    def show(self, result: "Result") -> None:
        """Show the parameters of a result."""
        from catseye.app.results.scara.figures.maps import map_figure
        from catseye.app.tui.result_texts import value_rows

        self._rows = [
            [Text(row[0]), *(Text(cell, justify="right") for cell in row[1:3]), Text(f" {row[3]}")]
            for row in value_rows(result)
        ]
        self._fill()
        self.query_one(Figures).show(map_figure(result))

    def on_filtered_rows_rearranged(self, event: RowTable.Rearranged) -> None:
        """Show the parameters that are asked for, in their order."""
        event.stop()
        self._fill()

    def _fill(self) -> None:
        table = self.query_one(RowTable)
        table.clear()
        for row in table.arranged(self._rows, lambda row: row):
            table.add_row(*row)


class LayoutPart(Horizontal):
    """Reflectors and commands from above; places with their uncertainties."""

    def compose(self) -> ComposeResult:
        """Plan and places; where there is room the residuals of each reflector below them."""
        yield Figures(id="plan")
        with Vertical(id="place-side", classes="beside"):
            with VerticalScroll(id="places-text", classes="text"):
                yield StaticText(id="places")
            yield Figures(id="place-figures", classes="aside")

    def show(self, result: "Result") -> None:
        """Show where a result has its reflectors."""
        from catseye.app.results.scara.figures.layout import layout_figure
        from catseye.app.results.scara.figures.residuals import residual_order_figure
        from catseye.app.results.scara.layout import scene_of
        from catseye.app.tui.result_texts import layout_text

        scene = scene_of(None, result, None)
        self.query_one("#plan", Figures).show(None if scene is None else layout_figure(scene))
        order = None if result.residuals is None else residual_order_figure(result.residuals)
        self.query_one("#place-figures", Figures).show(order)
        _write(self, "#places", layout_text(result))


class ResidualsPart(Vertical):
    """Residuals as the report shows them; outliers in a numbered list."""

    def compose(self) -> ComposeResult:
        """Figures and list."""
        yield Figures(id="residual-figures")
        with VerticalScroll(id="outliers-text", classes="text short"):
            yield StaticText(id="outliers")

    def show(self, result: "Result", diagnosis: "DiagnosisDocument | None") -> None:
        """Show the residuals of a result.

        Args:
            diagnosis: of it, its figures before the others; None before it is made.
        """
        from catseye.app.results.scara.result_report import residual_figures
        from catseye.app.tui.result_texts import residual_text

        diagnosed = () if diagnosis is None else diagnosis.figures
        self.query_one(Figures).show(*diagnosed, *residual_figures(result))
        _write(self, "#outliers", residual_text(result, diagnosis))


class FitPart(Horizontal):
    """What was identified and how it fits, in sentences; the residuals beside them where there is room."""

    def compose(self) -> ComposeResult:
        """Sentences and figures."""
        with VerticalScroll(id="findings-text", classes="text"):
            yield StaticText(id="findings")
        yield Figures(id="fit-figures", classes="aside")

    def show(self, result: "Result", diagnosis: "DiagnosisDocument | None") -> None:
        """Show how a result fits.

        Args:
            diagnosis: of it; None before it is made.
        """
        from catseye.app.results.scara.result_report import residual_figures
        from catseye.app.tui.result_texts import fit_sentences

        findings = map(statement_content, fit_sentences(result, diagnosis))
        self.query_one("#findings", StaticText).set_text(lines(*findings))
        # Those in measuring order stand on the parts before.
        self.query_one(Figures).show(*residual_figures(result)[-1:])


class PathPart(Vertical):
    """A validation path: measured, and predicted by both models."""

    def compose(self) -> ComposeResult:
        """Figures and text."""
        yield Figures(id="path-figures")
        with VerticalScroll(id="validation-text", classes="text short"):
            yield StaticText(id="validation")

    def show(self, found: "ValidationDocument | None") -> None:
        """Show a validation."""
        from catseye.app.tui.result_texts import path_text

        figures = self.query_one(Figures)
        figures.show(*(() if found is None else found.figures))
        figures.display = found is not None
        how = "t: choose a run of a validation path, or a measured file"
        _write(self, "#validation", how if found is None else path_text(found))


class ComparedTables(VerticalScroll, ArrangedTables):
    """Links and reflectors of two results, with what is said of them."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("left", "turn(-1)", "left", show=False, id="section.left", tooltip="column of a table"),
        Binding("right", "turn(1)", "right", show=False, id="section.right", tooltip="column of a table"),
    ]

    def __init__(self, *, id: str, classes: str) -> None:
        super().__init__(id=id, classes=classes)
        self._heading = ""
        self._blocks: Sequence[Block] = ()

    def compose(self) -> ComposeResult:
        """Text."""
        yield StaticText(id="comparison")

    def show_blocks(self, heading: str, blocks: "Sequence[Block]") -> None:
        """Show what is said, below a heading."""
        if heading != self._heading:
            self.forget_order()
        self._heading, self._blocks = heading, blocks
        self._fill()

    def action_turn(self, step: int) -> None:
        """Choose a column."""
        self.choose_column(step)

    def on_filtered_rows_rearranged(self, event: ArrangedTables.Rearranged) -> None:
        """Show the rows that are asked for, in their order."""
        event.stop()
        self._fill()

    def _fill(self) -> None:
        said = blocks_content(self.arranged(self._blocks))
        self.query_one("#comparison", StaticText).set_text(lines(Content(self._heading), said))


class ComparePart(Vertical):
    """Two results: differences of the maps, of links and reflectors."""

    def compose(self) -> ComposeResult:
        """Figure, key, text."""
        yield Figures(id="differences", classes="charts")
        yield StaticText(id="difference-legend", classes="legend")
        yield ComparedTables(id="comparison-text", classes="text below")

    def show_nothing(self) -> None:
        """Say how a comparison is made."""
        self.query_one(Figures).display = False
        _write(self, "#difference-legend", "put the cursor on another result (1), then b")
        self.query_one(ComparedTables).show_blocks("", ())

    def show(self, names: str, found: "ResultComparison", *, in_u: bool) -> None:
        """Show a comparison.

        Args:
            in_u: differences of the maps in combined standard uncertainties, not in mdeg.
        """
        from catseye.app.results.scara.comparison_report import map_differences
        from catseye.app.tui.result_texts import comparison_blocks

        figures = self.query_one(Figures)
        figures.show(map_differences(found, in_u=in_u) if found.maps else None)
        figures.display = bool(found.maps)
        _write(self, "#difference-legend", "u: mdeg or combined standard uncertainties")
        self.query_one(ComparedTables).show_blocks(names, comparison_blocks(found))


def _write(part: Widget, widget: str, text: str) -> None:
    part.query_one(widget, StaticText).set_text(Content(text))
