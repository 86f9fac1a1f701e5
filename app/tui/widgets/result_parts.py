"""The parts of a result that are drawn: maps, layout, residuals, path, comparison."""

from functools import partial
from typing import TYPE_CHECKING, Final

from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical, VerticalScroll
from textual.content import Content
from textual.widget import Widget

from catseye.app.tui.widgets.drawing import Drawing
from catseye.app.tui.widgets.static_text import StaticText

if TYPE_CHECKING:
    # The first screen is painted before files and mathematics are imported.
    from catseye.app.results.scara.comparison import ResultComparison
    from catseye.app.results.scara.diagnosis_document import DiagnosisDocument
    from catseye.app.results.scara.result import Result
    from catseye.app.results.scara.validation_document import ValidationDocument

_MAP_LEGEND: Final = "+ approached upwards   − downwards   ± both   bars ±2u (k = 2)"


class MapsPart(Vertical):
    """Both maps side by side."""

    def compose(self) -> ComposeResult:
        """Charts and legend."""
        with Horizontal(classes="charts"):
            yield Drawing(id="map1")
            yield Drawing(id="map2")
        yield StaticText(id="map-legend", classes="legend")

    def show(self, result: "Result") -> None:
        """Show the maps of a result; of a conventional model its offset."""
        from catseye.app.tui.result_texts import map_columns
        from catseye.app.tui.widgets.result_charts import draw_map

        for joint, table in ((1, result.theta1_map), (2, result.theta2_map)):
            draw = None if table is None else partial(draw_map, map_columns(joint, table))
            self.query_one(f"#map{joint}", Drawing).show(draw)
        theta20 = result.theta20_mdeg
        offset = "" if theta20 is None else f"θ20 = {theta20.value:.2f} mdeg, U = {2.0 * theta20.u:.2f}"
        _tell(self, "#map-legend", f"no map: {offset}" if offset else _MAP_LEGEND)


class LayoutPart(Horizontal):
    """Reflectors and commands from above; places with their uncertainties."""

    def compose(self) -> ComposeResult:
        """Plan and places."""
        yield Drawing(id="plan")
        with VerticalScroll(id="places-text", classes="text beside"):
            yield StaticText(id="places")

    def show(self, result: "Result") -> None:
        """Show where a result has its reflectors."""
        import numpy as np

        from catseye.app.tui.result_texts import layout_text
        from catseye.app.tui.widgets.result_charts import draw_layout

        links = result.link1_mm.value, result.link2_mm.value
        places = [(one.name, one.x_mm.value, one.y_mm.value) for one in result.reflectors]
        residuals = result.residuals
        commands = (
            np.zeros((0, 2))
            if residuals is None
            else np.column_stack([residuals.theta1_deg, residuals.theta2_deg])
        )
        self.query_one("#plan", Drawing).show(partial(draw_layout, links, places, commands))
        _tell(self, "#places", layout_text(result))


class ResidualsPart(Vertical):
    """Residuals in measuring order; outliers in a numbered list."""

    def compose(self) -> ComposeResult:
        """Chart and list."""
        yield Drawing(id="scatter")
        with VerticalScroll(id="outliers-text", classes="text short"):
            yield StaticText(id="outliers")

    def show(self, result: "Result", diagnosis: "DiagnosisDocument | None") -> None:
        """Show the residuals of a result.

        Args:
            result: whose residuals.
            diagnosis: of it; None before it is made.
        """
        import numpy as np

        from catseye.app.tui.result_texts import outlier_rows, residual_text
        from catseye.app.tui.widgets.result_charts import draw_residuals

        residuals, scatter = result.residuals, self.query_one("#scatter", Drawing)
        if residuals is None:
            scatter.show(None)
        else:
            outliers = outlier_rows(result, diagnosis)
            values = np.array(residuals.residual_um)
            scatter.show(partial(draw_residuals, values, residuals.reflector, outliers))
        _tell(self, "#outliers", residual_text(result, diagnosis))


class PathPart(Vertical):
    """A validation path: measured, and predicted by both models."""

    def compose(self) -> ComposeResult:
        """Charts, legend, figures."""
        with Horizontal(classes="charts"):
            yield Drawing(id="path1")
            yield Drawing(id="path2")
        yield StaticText(id="path-legend", classes="legend")
        with VerticalScroll(id="validation-text", classes="text short"):
            yield StaticText(id="validation")

    def show(self, found: "ValidationDocument | None") -> None:
        """Show a validation.

        Args:
            found: what a validation found; None before it.
        """
        if found is None:
            for place in (1, 2):
                self.query_one(f"#path{place}", Drawing).show(None)
            _tell(self, "#path-legend", "t: choose a run of a validation path, or a measured file")
            _tell(self, "#validation", "")
            return
        from catseye.app.tui.result_texts import path_text
        from catseye.app.tui.widgets.result_charts import draw_path

        path = found.path
        for place, deviation in enumerate(path.deviations, 1):
            self.query_one(f"#path{place}", Drawing).show(partial(draw_path, path, deviation))
        letters = zip("ce"[-len(path.models) :], path.models, strict=True)
        legend = ["∙ measured", *(f"{letter} {title}" for letter, title in letters)]
        _tell(self, "#path-legend", "   ".join(legend))
        _tell(self, "#validation", path_text(found))


class ComparePart(Vertical):
    """Two results: differences of the maps, of links and reflectors."""

    def compose(self) -> ComposeResult:
        """Charts, legend, figures."""
        with Horizontal(id="differences", classes="charts"):
            yield Drawing(id="difference1")
            yield Drawing(id="difference2")
        yield StaticText(id="difference-legend", classes="legend")
        with VerticalScroll(id="comparison-text", classes="text below"):
            yield StaticText(id="comparison")

    def show_nothing(self) -> None:
        """Say how a comparison is made."""
        for joint in (1, 2):
            self.query_one(f"#difference{joint}", Drawing).show(None)
        _tell(self, "#difference-legend", "put the cursor on another result (1), then c")
        _tell(self, "#comparison", "")

    def show(self, names: str, found: "ResultComparison", *, in_u: bool) -> None:
        """Show a comparison.

        Args:
            names: of both results.
            found: the comparison.
            in_u: differences of the maps in combined standard uncertainties, not in mdeg.
        """
        from catseye.app.tui.result_texts import comparison_text, difference_columns
        from catseye.app.tui.widgets.result_charts import draw_map

        for joint, one in enumerate(found.maps, 1):
            draw = partial(draw_map, difference_columns(one, in_u=in_u))
            self.query_one(f"#difference{joint}", Drawing).show(draw)
        self.query_one("#differences").display = bool(found.maps)
        what = "lines at ±2 u" if in_u else "bars ±2 combined u"
        _tell(self, "#difference-legend", f"+ upwards   − downwards   {what}   (u switches)")
        _tell(self, "#comparison", f"{names}\n{comparison_text(found)}")


def _tell(part: Widget, widget: str, text: str) -> None:
    part.query_one(widget, StaticText).set_text(Content(text))
