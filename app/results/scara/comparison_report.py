"""What two results of one arm differ by: statements, one table of all quantities, the differences of the maps."""

from catseye.app.results.figures import Axis, Figure, Level, Panel, Points, Role
from catseye.app.results.model import Cell, Column, Origin, Quantity, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import EXPANDED, OF_UNIT, SHARE_EXPECTED, Format, fixed, number
from catseye.app.results.scara.comparison import Difference, MapDifference, ResultComparison
from catseye.app.results.scara.names import node_name

_ANGLE = fixed(2, signed=True)
_LENGTH = fixed(4)
_COLUMNS = (
    Column("name", "quantity"),
    Column("unit", "unit"),
    Column("first", "first", format=_LENGTH),
    Column("second", "second", format=_LENGTH),
    Column("difference", "difference", format=_LENGTH),
    Column("u", "u (k=1)", format=_LENGTH),
    Column("normalised", "in u", format=_ANGLE),
)


def comparison_report(found: ResultComparison, names: tuple[str, str], origin: Origin) -> Report:
    """Return what a comparison says.

    Args:
        found: second minus first result.
        names: of their files.
        origin: of the report.
    """
    remarks = (Statement(Sign.NEUTRAL, f"{text[:1].upper()}{text[1:]}.") for text in found.remarks)
    figures = [map_differences(found, in_u=in_u) for in_u in (False, True)] if found.maps else []
    return Report(
        f"{names[1]} minus {names[0]}",
        origin,
        (
            section("verdict", "Verdict", [comparison_statement(found), *_turn(found), *remarks], brief=True),
            section("differences", "Differences", [_table(found)], brief=True),
            section("maps", "Differences of the maps", figures),
        ),
    )


def comparison_statement(found: ResultComparison) -> Statement:
    """Return how many differences lie within what their uncertainties account for."""
    within, count = found.within
    if not count:
        text = "No uncertainty is stated that the differences could be compared with."
        return Statement(Sign.NEUTRAL, text)
    name, size = _largest(found)
    share = within / count
    return Statement(
        Sign.GOOD if share >= SHARE_EXPECTED else Sign.BAD,
        f"{within} of {count} differences lie within {EXPANDED:g} combined standard uncertainties "
        f"({100.0 * share:.0f} %, 95 % expected); the largest is {number(size, fixed(1, signed=True))} u, {name}.",
    )


def _largest(found: ResultComparison) -> tuple[str, float]:
    """Return the difference that is largest in combined standard uncertainties: name and size."""
    sizes = [(one.name, one.normalised) for one in _differences(found)]
    stated = [(name, size) for name, size in sizes if size is not None]
    return max(stated, key=lambda item: abs(item[1]))


def _turn(found: ResultComparison) -> list[Statement]:
    if abs(found.turn_mdeg) < 5e-3:
        return []
    turn = number(found.turn_mdeg, _ANGLE)
    text = f"The second result was turned by {turn} mdeg into the frame of the first."
    return [Statement(Sign.NEUTRAL, text)]


def _differences(found: ResultComparison) -> list[Difference]:
    """Return links, every node of the maps, and reflectors as one list."""
    return [*found.values, *(one for table in found.maps for one in _nodes(table)), *found.reflectors]


def _nodes(one: MapDifference) -> list[Difference]:
    return [
        Difference(
            node_name(one.joint, node, direction), "mdeg", *(float(values[row, i]) for values in columns)
        )
        for columns in [(one.first_mdeg, one.second_mdeg, one.u_mdeg)]
        for row, direction in enumerate((1, -1))
        for i, node in enumerate(one.node_deg.tolist())
    ]


def _table(found: ResultComparison) -> Table:
    rows = tuple(_row(one) for one in _differences(found))
    return Table("differences", "Second minus first result", _COLUMNS, rows)


def _row(one: Difference) -> tuple[Cell, ...]:
    form = OF_UNIT[one.unit]
    return (
        one.name,
        one.unit,
        Quantity(one.first, form),
        Quantity(one.second, form),
        Quantity(one.difference, Format(form.style, form.digits, signed=True)),
        Quantity(one.u, form),
        one.normalised,
    )


def map_differences(found: ResultComparison, *, in_u: bool) -> Figure:
    """Return the differences of the maps: in mdeg with bars, or in combined standard uncertainties."""
    unit = "combined standard uncertainties" if in_u else "mdeg"
    told = "lines at ±2" if in_u else "bars: standard uncertainty of the difference (k = 1)"
    return Figure(
        "differences-in-u" if in_u else "differences",
        f"Differences of the maps in {unit}",
        f"Second minus first map of each joint, in {unit}; {told}.",
        (tuple(_panel(one, in_u=in_u) for one in found.maps),),
    )


def _panel(one: MapDifference, *, in_u: bool) -> Panel:
    values = one.normalised if in_u else one.difference_mdeg
    marks = (
        Points(one.node_deg, values[row], ink, label, None if in_u else one.u_mdeg[row], joined=True)
        for row, (ink, label) in enumerate(
            ((Role.POSITIVE, "positive direction"), (Role.NEGATIVE, "negative direction"))
        )
    )
    limits = (-EXPANDED, EXPANDED) if in_u else (0.0,)
    levels = (Level(at, Role.AXIS, dash="dashed") for at in limits)
    return Panel(
        f"J{one.joint}",
        Axis(f"command θ{one.joint} / °"),
        Axis(f"Δθ{one.joint} difference / {'u' if in_u else 'mdeg'}"),
        (*levels, *marks),
    )
