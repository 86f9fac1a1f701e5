"""No word of a figure is cut, none lies on another, and no two things of a figure look alike."""

import numpy as np
import pytest
from matplotlib.container import ErrorbarContainer

from catseye.app.render.mpl import drawn
from catseye.app.results.figures import Axis, Figure, Line, Mark, Panel, Points, Role, Span
from catseye.app.results.model import Report
from tests.unit.app.render.clipping import clipped, overlapping
from tests.unit.app.render.reports import REPORT
from tests.unit.app.results.scara import sample


def tall_panels() -> Figure:
    """Return four panels of one scale for each axis, about three times as high as wide."""
    low, high = np.array([100.0, 550.0]), np.array([-620.0, 600.0])
    marks: tuple[Mark, ...] = (
        Line(low, high, Role.PATH),
        *(
            Points(low, high, ink, label)
            for ink, label in (
                (Role.TRUTH, "command position"),
                (Role.POSITIVE, "way there, error × 1000"),
                (Role.NEGATIVE, "way back, error × 1000"),
            )
        ),
    )
    across = Axis("X / mm", low=100.0, high=557.0)
    panels = tuple(
        Panel(
            f"{letter}) measured",
            across,
            Axis("" if place else "Y / mm", low=-620.0, high=600.0, shared=place > 0),
            marks,
            equal=True,
        )
        for place, letter in enumerate("abcd")
    )
    return Figure("tall", "Tall", "", (panels,), aspect=0.675, legend_columns=3)


def figures_of(report: Report) -> list[Figure]:
    return [block for block in report.blocks() if isinstance(block, Figure)]


SAMPLES = {
    "every mark": figures_of(REPORT),
    "tall panels of one scale": [tall_panels()],
    "SCARA": figures_of(sample.whole().report),
}


@pytest.mark.parametrize("name", SAMPLES)
def test_no_word_of_a_figure_is_cut(name: str) -> None:
    assert {figure.key: clipped(figure) for figure in SAMPLES[name] if clipped(figure)} == {}


@pytest.mark.parametrize("name", SAMPLES)
def test_entries_titles_and_labels_keep_off_each_other(name: str) -> None:
    assert {figure.key: overlapping(figure) for figure in SAMPLES[name] if overlapping(figure)} == {}


def test_stretches_of_different_kinds_look_different() -> None:
    line = Line(np.array([0.0, 3.0]), np.array([0.0, 1.0]), Role.PATH)
    spans = tuple(Span(float(kind), kind + 0.5, f"kind {kind}", kind) for kind in range(3))
    figure = drawn(Figure("f", "f", "", ((Panel("", Axis("x"), Axis("y"), (line, *spans)),),)))
    looks = {(patch.get_facecolor(), patch.get_hatch()) for patch in figure.axes[0].patches}
    assert len(looks) == 3


@pytest.mark.parametrize("name", SAMPLES)
def test_no_two_entries_of_a_legend_look_alike(name: str) -> None:
    for figure in SAMPLES[name]:
        looks: dict[str, str] = {}
        for axes in drawn(figure).axes:
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
                one = handle.lines[0] if isinstance(handle, ErrorbarContainer) else handle
                drawn_as = (
                    "get_color",
                    "get_facecolor",
                    "get_linestyle",
                    "get_marker",
                    "get_hatch",
                    "get_fillstyle",
                )
                look = str(
                    [np.asarray(getattr(one, get)(), dtype=object) for get in drawn_as if hasattr(one, get)]
                )
                look += str(getattr(one, "get_markerfacecolor", str)())
                assert looks.setdefault(look, label) == label
