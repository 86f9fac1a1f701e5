"""Figures in letters and dots against their data."""

import re
from dataclasses import replace

import numpy as np
import pytest
from textual.app import App
from textual.theme import Theme

from catseye.app.render.palette import SERIES
from catseye.app.results.figures import (
    Axis,
    Bars,
    Figure,
    Heat,
    Level,
    Line,
    Mark,
    Panel,
    Points,
    Role,
    Shape,
    Span,
    Stems,
    Text,
)
from catseye.app.tui.themes import THEMES
from catseye.app.tui.widgets.figure_drawing import draw_figure, rows_needed
from catseye.app.tui.widgets.inks import FIGURE_STYLES, ink_name
from tests.unit.app.render.reports import FIGURE, MARKS

X = np.array([0.0, 1.0, 2.0])


def figure(*marks: Mark, equal: bool = False) -> Figure:
    axes = Axis("x", low=0.0, high=10.0), Axis("y", low=0.0, high=10.0)
    return Figure("key", "", "", ((Panel("title", *axes, marks, equal=equal),),))


def text(shown: Figure, width: int = 60, height: int = 24) -> list[str]:
    return ["".join(piece for piece, _ in line) for line in draw_figure(shown, width, height)]


def numbers_of(lines: list[str]) -> tuple[list[int], list[float]]:
    """Return the rows that have a number of the upright axis, and the numbers."""
    marked = [(row, re.match(r" *(−?[\d.]+)┤", line)) for row, line in enumerate(lines)]
    known = [(row, float(found[1].replace("−", "-"))) for row, found in marked if found]
    return [row for row, _ in known], [value for _, value in known]


def values_at(lines: list[str], sign: str) -> list[float]:
    """Return the heights of signs, left to right, read from the numbers of the axis."""
    slope, offset = np.polyfit(*numbers_of(lines), 1)
    plot = [(line.index("│") if "│" in line else line.find("┤")) for line in lines]
    places = [
        (column, slope * row + offset)
        for row, line in enumerate(lines)
        for column, letter in enumerate(line)
        if letter == sign and 0 <= plot[row] < column
    ]
    return [value for _, value in sorted(places)]


@pytest.mark.parametrize(
    ("title", "label", "heading"),
    [("moved", "moved / µm", "moved / µm"), ("a", "along / mm", "a  along / mm"), ("", "S / µm", "S / µm")],
)
def test_a_panel_is_named_once(title: str, label: str, heading: str) -> None:
    panel = Panel(title, Axis("x", low=0.0, high=10.0), Axis(label), (Line(X, X, 0),))
    assert [line.strip() for line in text(Figure("key", "", "", ((panel,),))) if label in line] == [heading]


@pytest.mark.parametrize("theme", THEMES, ids=lambda theme: theme.name)
def test_every_ink_names_a_colour_of_the_theme(theme: Theme) -> None:
    colours = App[None]().get_theme_variable_defaults() | theme.to_color_system().generate()
    assert {style.split()[0].removeprefix("$") for style in FIGURE_STYLES.values()} <= set(colours)
    assert {ink_name(role) for role in Role} <= set(FIGURE_STYLES)
    assert ink_name(len(SERIES)) == ink_name(0)


@pytest.mark.parametrize("mark", MARKS, ids=lambda mark: type(mark).__name__.lower())
def test_every_mark_draws(mark: Mark) -> None:
    legend = rows_needed(figure(mark), 60) - rows_needed(figure(), 60)
    assert text(figure(mark), 60, 24 + legend)[legend:] != text(figure(), 60, 24)


def test_legend_has_every_label_once() -> None:
    shown = "\n".join(text(FIGURE, 110, 60))
    for label in ("a line", "points", "a reflector", "a band", "a span", "a circle"):
        assert shown.count(f"{label}   ") == 1, label
    assert "heat, 0 to 2" in shown
    assert "a scale, 0 to 1" in shown
    assert "E_YY / y" in shown
    assert "a note" in shown
    assert "What marks look like." in shown


def test_signs_stand_at_the_values_of_points() -> None:
    y = np.array([1.0, 9.0, 4.0])
    lines = text(figure(Points(4.0 * X + 1.0, y, Role.POSITIVE)), 60, 43)
    assert values_at(lines, "▲") == pytest.approx(y, abs=0.2)


def test_signs_of_both_directions_share_a_cell() -> None:
    there, back = (Points(X, X, Role.POSITIVE, marker=sign, hollow=sign != "x") for sign in ("x", "o"))
    assert "⊗" in "".join(text(figure(there, back)))
    first, second = Points(X, X, Role.POSITIVE), Points(X, X, Role.NEGATIVE)
    assert "✱" in "".join(text(figure(first, second)))


def test_error_bars_reach_twice_u_to_either_side() -> None:
    lines = text(figure(Points(np.array([5.0]), np.array([5.0]), Role.POSITIVE, u=np.array([1.0]))), 60, 43)
    column = next(line.index("▲") for line in lines if "▲" in line)
    rows = [row for row, line in enumerate(lines[1:-2]) if len(line) > column and line[column] not in " "]
    assert len(rows) == pytest.approx(40 * 4.0 / 10.0, abs=2)


def test_crowded_points_are_dots_with_a_few_signs() -> None:
    x = np.linspace(0.0, 10.0, 500)
    lines = text(figure(Points(x, x, Role.POSITIVE, "many")))
    assert sum(line.count("▲") for line in lines[1:]) == 7
    assert sum("⠀" < letter <= "⣿" for line in lines for letter in line) > 20


def test_gap_in_a_line_is_not_bridged() -> None:
    y = np.full(11, 5.0)
    whole = "".join(text(figure(Line(np.arange(11.0), y, Role.PATH))))
    y[4:7] = np.nan
    broken = "".join(text(figure(Line(np.arange(11.0), y, Role.PATH))))
    counts = [sum("⠀" < letter <= "⣿" for letter in shown) for shown in (whole, broken)]
    assert counts[1] == pytest.approx(0.6 * counts[0], rel=0.1)


def test_panels_that_share_a_scale_hold_the_marks_of_both() -> None:
    left = Panel("a", Axis("x"), Axis("y"), (Line(X, X, 0),))
    right = Panel("b", Axis("x"), Axis(shared=True), (Points(np.array([1.0]), np.array([50.0]), 1),))
    lines = text(Figure("key", "", "", ((left, right),)), 100, 24)
    assert values_at(lines, "■") == pytest.approx([50.0], abs=2.0)


def test_narrow_screens_put_panels_below_each_other() -> None:
    assert rows_needed(FIGURE, 40) > rows_needed(FIGURE, 110)
    lines = text(FIGURE, 40, rows_needed(FIGURE, 40))
    titles = [next(row for row, line in enumerate(lines) if name in line) for name in ("b)", "c)")]
    assert titles[0] < titles[1]


def test_equal_scales_draw_circles_as_high_as_wide() -> None:
    circle = Shape((5.0, 5.0), (4.0, 4.0), Role.COLUMN)
    lines = [line[6:] for line in text(figure(circle, equal=True), 70, 30)[1:-2]]
    drawn = [[column for column, letter in enumerate(line) if "⠀" < letter <= "⣿"] for line in lines]
    rows = [row for row, columns in enumerate(drawn) if columns]
    across = max(max(columns) for columns in drawn if columns) - min(min(c) for c in drawn if c) + 1
    # A cell is twice as high as wide.
    assert 2 * (rows[-1] - rows[0] + 1) == pytest.approx(across, abs=3)


def test_heat_grows_darker_with_its_values() -> None:
    grid = np.meshgrid(np.linspace(0.0, 10.0, 21), np.linspace(0.0, 10.0, 21))
    lines = text(figure(Heat(grid[0], grid[1], grid[0], "u", 10.0)))
    row = next(line for line in lines if "█" in line and "░" in line and "┤" not in line)
    shades = [letter for letter in row if letter in "░▒▓█"]
    assert shades == sorted(shades, key="░▒▓█".index)
    assert set(shades) == set("░▒▓█")


def test_values_of_points_are_digits_of_their_scale() -> None:
    marks = Points(
        4.0 * X + 1.0, np.full(3, 5.0), 0, value=np.array([0.0, 5.0, 99.0]), value_ends=(0.0, 10.0)
    )
    lines = text(figure(marks), 60, 43)
    assert any(re.search(r"0 +4 +9", line) for line in lines[2:-2])


def test_levels_stems_bars_and_spans_end_where_they_say() -> None:
    def highest(mark: Mark) -> float:
        lines = text(figure(mark), 60, 43)
        drawn = [row for row, line in enumerate(lines[1:-3], 1) if re.search("[⠁-⣿]", line)]
        return float(np.polyval(np.polyfit(*numbers_of(lines), 1), drawn[0]))

    one = np.array([5.0])
    assert highest(Level(7.0, Role.CHANGE)) == pytest.approx(7.0, abs=0.3)
    assert highest(Stems(one, one, Role.MUTED)) == pytest.approx(5.0, abs=0.3)
    assert highest(Bars(np.array([2.0, 4.0]), np.array([3.0]), Role.SCATTER)) == pytest.approx(3.0, abs=0.3)
    assert highest(Span(2.0, 4.0, "")) == pytest.approx(10.0, abs=0.3)


def test_text_stands_beside_above_and_in_the_corner() -> None:
    shown = figure(
        Text("beside", (5.0, 5.0)), Text("above", (5.0, 5.0), centred=True), Text("in the\ncorner")
    )
    lines = text(shown, 60, 43)
    row = next(number for number, line in enumerate(lines) if "beside" in line)
    assert "above" in lines[row - 1]
    assert lines[row - 1].index("above") < lines[row].index("beside")
    assert "in the" in lines[1]
    assert "corner" in lines[2]


@pytest.mark.parametrize("size", [(0, 0), (1, 1), (5, 3), (9, 4), (12, 30), (30, 8)])
def test_no_room_is_no_fault(size: tuple[int, int]) -> None:
    assert len(draw_figure(FIGURE, *size)) <= size[1]
    rows_needed(FIGURE, size[0])


def test_marks_without_places_are_no_fault() -> None:
    none = np.zeros(0)
    empty = Figure(
        "key", "", "", ((Panel("", Axis(), Axis(), (Points(none, none, 0), Line(none, none, 1))),),)
    )
    assert text(empty)
    assert text(replace(empty, rows=((None, empty.rows[0][0]),)))
