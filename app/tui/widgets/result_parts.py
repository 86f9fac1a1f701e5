"""The parts of a result that are drawn: maps, layout, residuals, path, comparison."""

from typing import TYPE_CHECKING

from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical, VerticalScroll
from textual.content import Content
from textual.widget import Widget

from catseye.app.tui.widgets.figure_view import Figures
from catseye.app.tui.widgets.static_text import StaticText

if TYPE_CHECKING:
    # The first screen is painted before files and mathematics are imported.
    from catseye.app.results.scara.comparison import ResultComparison
    from catseye.app.results.scara.diagnosis_document import DiagnosisDocument
    from catseye.app.results.scara.result import Result
    from catseye.app.results.scara.validation_document import ValidationDocument


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


class LayoutPart(Horizontal):
    """Reflectors and commands from above; places with their uncertainties."""

    def compose(self) -> ComposeResult:
        """Plan and places."""
        yield Figures(id="plan")
        with VerticalScroll(id="places-text", classes="text beside"):
            yield StaticText(id="places")

    def show(self, result: "Result") -> None:
        """Show where a result has its reflectors."""
        from catseye.app.results.scara.figures.layout import layout_figure
        from catseye.app.results.scara.layout import scene_of
        from catseye.app.tui.result_texts import layout_text

        scene = scene_of(None, result, None)
        self.query_one(Figures).show(None if scene is None else layout_figure(scene))
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

        self.query_one(Figures).show(*(() if found is None else found.figures))
        how = "t: choose a run of a validation path, or a measured file"
        _write(self, "#validation", how if found is None else path_text(found))


class ComparePart(Vertical):
    """Two results: differences of the maps, of links and reflectors."""

    def compose(self) -> ComposeResult:
        """Figure, key, text."""
        yield Figures(id="differences", classes="charts")
        yield StaticText(id="difference-legend", classes="legend")
        with VerticalScroll(id="comparison-text", classes="text below"):
            yield StaticText(id="comparison")

    def show_nothing(self) -> None:
        """Say how a comparison is made."""
        self.query_one(Figures).show()
        _write(self, "#difference-legend", "put the cursor on another result (1), then b")
        _write(self, "#comparison", "")

    def show(self, names: str, found: "ResultComparison", *, in_u: bool) -> None:
        """Show a comparison.

        Args:
            in_u: differences of the maps in combined standard uncertainties, not in mdeg.
        """
        from catseye.app.results.scara.comparison_report import map_differences
        from catseye.app.tui.result_texts import comparison_text

        figures = self.query_one(Figures)
        figures.show(map_differences(found, in_u=in_u) if found.maps else None)
        figures.display = bool(found.maps)
        _write(self, "#difference-legend", "u: mdeg or combined standard uncertainties")
        _write(self, "#comparison", f"{names}\n{comparison_text(found)}")


def _write(part: Widget, widget: str, text: str) -> None:
    part.query_one(widget, StaticText).set_text(Content(text))
