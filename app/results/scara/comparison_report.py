"""What two results of one arm differ by: statements, one table of all quantities, the differences of the maps."""

from catseye.app.results.difference import Difference, difference_statement
from catseye.app.results.figures import Axis, Figure, Level, Panel, Points, Role
from catseye.app.results.model import Cell, Column, Origin, Quantity, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import EXPANDED, OF_UNIT, Format, fixed, number
from catseye.app.results.scara.comparison import MapDifference, ResultComparison
from catseye.app.results.scara.names import node_name
from catseye.calibration.core.types import Floats

_ANGLE = fixed(2, signed=True)
_LENGTH = fixed(4)
_COLUMNS = (
    Column("name", "quantity"),
    Column("unit", "unit"),
    Column("first", "first", format=_LENGTH),
    Column("second", "second", format=_LENGTH),
    Column("difference", "difference", format=_LENGTH),
    Column("u", "U (k=2)", format=_LENGTH, standard=True),
    Column("normalised", "in u", format=_ANGLE),
)


def comparison_report(comparison: ResultComparison, names: tuple[str, str], origin: Origin) -> Report:
    """Return what a comparison says.

    Args:
        comparison: second minus first result.
    """
    remarks = (Statement(Sign.NEUTRAL, f"{text[:1].upper()}{text[1:]}.") for text in comparison.remarks)
    figures = [map_differences(comparison, in_u=in_u) for in_u in (False, True)] if comparison.maps else []
    return Report(
        f"{names[1]} minus {names[0]}",
        origin,
        (
            section(
                "verdict",
                "Verdict",
                [comparison_statement(comparison), *_turn(comparison), *remarks],
                brief=True,
            ),
            section("differences", "Differences", [_table(comparison)], brief=True),
            section("maps", "Differences of the maps", figures),
        ),
    )


def comparison_statement(comparison: ResultComparison) -> Statement:
    """Return how many differences lie within what their uncertainties account for."""
    within, count = comparison.within
    if not count:
        text = "No uncertainty is stated that the differences could be compared with."
        return Statement(Sign.NEUTRAL, text)
    return difference_statement(within, count, "differences", _largest(comparison))


def _largest(comparison: ResultComparison) -> tuple[str, float]:
    """Return the difference that is largest in combined standard uncertainties: name and size."""
    sizes = [(difference.name, difference.normalised) for difference in all_differences(comparison)]
    stated = [(name, size) for name, size in sizes if size is not None]
    return max(stated, key=lambda item: abs(item[1]))


def _turn(comparison: ResultComparison) -> list[Statement]:
    if abs(comparison.turn_mdeg) < 5e-3:
        return []
    turn = number(comparison.turn_mdeg, _ANGLE)
    text = f"The second result was turned by {turn} mdeg into the frame of the first."
    return [Statement(Sign.NEUTRAL, text)]


def all_differences(comparison: ResultComparison) -> list[Difference]:
    """Return links, every node of the maps, and reflectors as one list."""
    return [
        *comparison.values,
        *(node for table in comparison.maps for node in _nodes(table)),
        *comparison.reflectors,
    ]


def _nodes(difference: MapDifference) -> list[Difference]:
    return [
        Difference(
            node_name(difference.joint, node, direction),
            "mdeg",
            *(float(values[row, i]) for values in columns),
        )
        for columns in [_columns(difference)]
        for row, direction in enumerate((1, -1))
        for i, node in enumerate(difference.node_deg.tolist())
    ]


def _columns(difference: MapDifference) -> tuple[Floats, ...]:
    return (
        difference.first_mdeg,
        difference.second_mdeg,
        difference.first_u_mdeg,
        difference.second_u_mdeg,
        difference.common_mdeg2,
    )


def _table(comparison: ResultComparison) -> Table:
    rows = tuple(_row(difference) for difference in all_differences(comparison))
    return Table("differences", "Second minus first result", _COLUMNS, rows)


def _row(difference: Difference) -> tuple[Cell, ...]:
    form = OF_UNIT[difference.unit]
    return (
        difference.name,
        difference.unit,
        Quantity(difference.first, form),
        Quantity(difference.second, form),
        Quantity(difference.difference, Format(form.style, form.digits, signed=True)),
        Quantity(difference.u, form),
        difference.normalised,
    )


def map_differences(comparison: ResultComparison, *, in_u: bool) -> Figure:
    """Return the differences of the maps: in mdeg with bars, or in combined standard uncertainties."""
    unit = "combined standard uncertainties" if in_u else "mdeg"
    shown = "lines at ±2" if in_u else "error bars: U (k = 2) of the difference"
    return Figure(
        "differences-in-u" if in_u else "differences",
        f"Differences of the maps in {unit}",
        f"Second minus first map of each joint, in {unit}; {shown}.",
        (tuple(_panel(joint_map, in_u=in_u) for joint_map in comparison.maps),),
    )


def _panel(difference: MapDifference, *, in_u: bool) -> Panel:
    values = difference.normalised if in_u else difference.difference_mdeg
    marks = (
        Points(
            difference.node_deg,
            values[row],
            ink,
            label,
            None if in_u else difference.u_mdeg[row],
            joined=True,
        )
        for row, (ink, label) in enumerate(
            ((Role.POSITIVE, "positive direction"), (Role.NEGATIVE, "negative direction"))
        )
    )
    limits = (-EXPANDED, EXPANDED) if in_u else (0.0,)
    levels = (Level(at, Role.AXIS, dash="dashed") for at in limits)
    return Panel(
        f"J{difference.joint}",
        Axis(f"command θ{difference.joint} / °"),
        Axis(f"Δθ{difference.joint} difference / {'u' if in_u else 'mdeg'}"),
        (*levels, *marks),
    )
