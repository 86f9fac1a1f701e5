"""A report with every kind of block, and a figure with every kind of mark."""

import numpy as np

from catseye.app.results.figures import (
    Axis,
    Band,
    Bars,
    Figure,
    Heat,
    Level,
    Line,
    Panel,
    Points,
    Role,
    Shape,
    Span,
    Stems,
    Text,
)
from catseye.app.results.model import (
    Bullets,
    Column,
    Entries,
    Listing,
    Origin,
    Paragraph,
    Quantity,
    Report,
    Section,
    Sign,
    Statement,
    Table,
)
from catseye.app.results.numbers import COUNT, OF_UNIT, fixed

X = np.array([0.0, 1.0, 2.0])
GRID = np.meshgrid(X, X)

TABLE = Table(
    "values",
    "Values",
    (
        Column("name", "quantity"),
        Column("unit", "unit"),
        Column("value_mm", "value", "mm", fixed(2)),
        Column("count", "rows", format=COUNT),
    ),
    (("L1", "mm", Quantity(-1.23456, OF_UNIT["mm"]), 3), ("L2 µ", "mm", None, 12)),
)

MARKS = (
    Line(X, X, Role.TRUTH, "a line", dash="dashed", step=True, faint=True),
    Points(X, X, Role.POSITIVE, "points", u=0.1 * X, joined=True),
    Points(X, X, 1, "a reflector", hollow=True),
    Points(X, X, Role.ABOVE, area=10.0 * X),
    Points(X, X, Role.MUTED, value=X, value_label="a scale", value_ends=(0.0, 1.0)),
    Band(X, X - 1.0, X + 1.0, Role.EXPECTED, "a band"),
    Bars(X, np.array([1.0, 2.0]), Role.SCATTER),
    Stems(X, X, Role.MUTED),
    Level(0.5, Role.AXIS, dash="dotted"),
    Level(0.5, Role.CHANGE, vertical=True),
    Span(0.0, 0.5, "a span"),
    Shape((1.0, 1.0), (0.5, 0.5), Role.COLUMN, "a circle", filled=True),
    Shape((1.0, 1.0), (0.5, 0.5), 2, filled=True, from_deg=0.0, to_deg=90.0),
    Shape((1.0, 1.0), (0.5, 0.2), Role.REGION, turn_deg=30.0, dashed=True),
    Text("beside", (1.0, 1.0)),
    Text("above", (1.0, 1.0), centred=True),
    Text("in the corner"),
)

FIGURE = Figure(
    "marks",
    "Every mark",
    "What marks look like.",
    (
        (Panel("a)", Axis(shared=True), Axis("y", "E_{YY}"), MARKS), None),
        (
            Panel("b)", Axis("x"), Axis("y", low=0.0), (Heat(GRID[0], GRID[1], GRID[0], "heat", 2.0),)),
            Panel("c)", Axis("x"), Axis(shared=True), (Line(X, 3.0 * X, 0),)),
        ),
    ),
    note="a note",
)

REPORT = Report(
    "Title",
    Origin("catseye 0.1.0", "2026-01-02T03:04:05Z"),
    (
        Section(
            "verdict",
            "Verdict",
            tuple(Statement(sign, f"A sentence that is {sign}.") for sign in Sign),
            brief=True,
        ),
        Section("values", "Values", (TABLE,), brief=True),
        Section(
            "more",
            "More",
            (
                Paragraph("Text & text"),
                Bullets("Left out", ("one", "two")),
                Listing((("a = 1", "default"), ("b < 2", ""))),
                Entries((("poses", "how many\na whole number"),)),
                FIGURE,
                Statement(Sign.GOOD, "Only on the page."),
            ),
        ),
        Section("empty", "Nothing", ()),
    ),
)
