"""A trend as a report: verdict, results, quantities, figures."""

from collections.abc import Sequence

import numpy as np

from catseye.app.results.difference import Difference, difference_statement
from catseye.app.results.figures import Axis, Figure, Level, Panel, Points, Role
from catseye.app.results.model import Cell, Column, Quantity, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import (
    EXPANDED,
    NOTHING,
    OF_UNIT,
    THREE_DIGITS,
    Format,
    counted,
    fixed,
    number,
)
from catseye.app.results.trend.course import Course, Trend, Value
from catseye.calibration.core.types import Floats

_IN_U = fixed(1, signed=True)
_CLEAR = 3.0
"""A change beyond this many u of the difference is spoken of by itself."""

_BY_CHANCE = 0.0027
"""Share of the changes of an arm that has not changed beyond three u, in a normal distribution."""

_MOST = 6
"""Quantities that are drawn of each unit, or named: those that change most."""

_DAY_S = 86_400.0


def trend_report(trend: Trend) -> Report:
    """Return what a trend says."""
    remarks = [Statement(Sign.NEUTRAL, f"{text[:1].upper()}{text[1:]}.") for text in trend.remarks]
    return Report(
        f"Trend of {trend.arm}",
        trend.origin,
        (
            section("verdict", "Verdict", [trend_statement(trend), *remarks], brief=True),
            section("results", "Results", [_results(trend)], brief=True),
            section("changes", "Changes against the baseline", [_quantities(trend)], brief=True),
            section("figures", "Over time", [*_changes(trend), *trend.figures]),
        ),
    )


def trend_statement(trend: Trend) -> Statement:
    """Return what has become of the arm since the baseline, by the newest other result."""
    newest = len(trend.results) - 1 if trend.baseline != len(trend.results) - 1 else len(trend.results) - 2
    changes, largest = trend.changes(newest), trend.largest(newest)
    since = f"{trend.results[newest].day} against the baseline of {trend.results[trend.baseline].day}"
    if largest is None:
        return Statement(Sign.NEUTRAL, f"{since}: no change has an uncertainty that it could be judged by.")
    said = difference_statement(trend.within(newest), len(changes), "changes", largest)
    single = _single_changes(changes)
    sign = Sign.ATTENTION if single and said.sign is Sign.GOOD else said.sign
    return Statement(sign, f"{since}: {said.text}{single}", f"{number(largest[1], _IN_U)} u, {largest[0]}")


def _single_changes(changes: Sequence[Difference]) -> str:
    """Return what is said of changes that are too large one by one, however well the others agree; empty without."""
    beyond = sorted(
        (one for one in changes if abs(one.normalised or 0.0) > _CLEAR),
        key=lambda one: -abs(one.normalised or 0.0),
    )
    if not beyond:
        return ""
    named = ", ".join(f"{one.name} ({number(one.normalised, _IN_U)} u)" for one in beyond[:_MOST])
    more = f" and {len(beyond) - _MOST} more" if len(beyond) > _MOST else ""
    lie, chance = "lies" if len(beyond) == 1 else "lie", _BY_CHANCE * len(changes)
    return (
        f" Beyond {_CLEAR:g} u {lie} {counted(len(beyond), 'change')} where chance alone accounts for {chance:.1f}: "
        f"{named}{more}; measure there again before anything rests on it."
    )


def _results(trend: Trend) -> Table:
    columns = (
        Column("measured", "measured (UTC)"),
        Column("file", "result"),
        Column("runs", "runs"),
        Column("within", "within 2 u"),
        Column("largest", "largest / u", format=_IN_U),
        Column("of", "of"),
    )
    rows = tuple(_result_row(trend, place) for place in range(len(trend.results)))
    return Table("results", "Results of this arm", columns, rows)


def _result_row(trend: Trend, place: int) -> tuple[Cell, ...]:
    result, changes, largest = trend.results[place], trend.changes(place), trend.largest(place)
    runs = ", ".join(run.rpartition("_")[2] for run in result.runs)
    if place == trend.baseline:
        return result.day, result.path.name, runs, "baseline", None, ""
    size, name = (None, "") if largest is None else (largest[1], largest[0])
    return result.day, result.path.name, runs, f"{trend.within(place)} of {len(changes)}", size, name


def _quantities(trend: Trend) -> Table:
    columns = (
        Column("name", "quantity"),
        Column("unit", "unit"),
        *(Column(f"value-{place}", _title(trend, place)) for place in range(len(trend.results))),
        Column("change", "last change"),
        Column("u_expanded", "U (k = 2)"),
        Column("normalised", "in u", format=_IN_U),
    )
    caption = (
        "Value ± expanded uncertainty (k = 2) in each result; the change of the newest against the baseline"
    )
    return Table("quantities", caption, columns, tuple(map(_quantity_row, trend.courses)))


def _title(trend: Trend, place: int) -> str:
    title = f"{trend.results[place].measured:%Y-%m-%d}"
    return f"{title}, baseline" if place == trend.baseline else title


def _quantity_row(one: Course) -> tuple[Cell, ...]:
    form = OF_UNIT.get(one.unit, THREE_DIGITS)
    last = next(reversed(one.changes.values()), None)
    values = tuple(_text(each, form) for each in one.values)
    if last is None:
        return one.name, one.unit, *values, None, None, None
    change = Quantity(last.difference, Format(form.style, form.digits, signed=True))
    return one.name, one.unit, *values, change, Quantity(EXPANDED * last.u, form), last.normalised


def _text(value: Value | None, form: Format) -> str:
    if value is None:
        return NOTHING
    return f"{number(value.value, form)} ± {number(EXPANDED * value.u, form)}"


def _changes(trend: Trend) -> list[Figure]:
    """Return the changes against date: of each unit those that are largest, and the largest of each result in u.

    Each has a legend of its own: the looks begin anew in each.
    """
    units = list(dict.fromkeys(one.unit for one in trend.courses if one.judged))
    largest = (
        "The largest change of each result against the baseline, in u, over the days since the first result"
    )
    return [
        *(
            _figure(f"trend-{number}", f"Changes over time, {unit}", _OF_UNIT.format(unit=unit), panel)
            for number, unit in enumerate(units, 1)
            if (panel := _panel(trend, unit)) is not None
        ),
        _figure("trend-largest", "Largest change over time", f"{largest}; dashed: ±2.", _largest(trend)),
    ]


_OF_UNIT = (
    "Changes against the baseline in {unit} with their expanded uncertainties (k = 2), those that are largest in u, "
    "over the days since the first result."
)


def _figure(key: str, label: str, caption: str, panel: Panel) -> Figure:
    return Figure(key, label, caption, ((panel,),), aspect=0.38, legend_columns=_MOST)


def _days(trend: Trend, places: list[int]) -> Floats:
    first = trend.results[0].measured
    return np.array([(trend.results[place].measured - first).total_seconds() / _DAY_S for place in places])


def _panel(trend: Trend, unit: str) -> Panel | None:
    own = [one for one in trend.courses if one.judged and one.unit == unit and one.largest() > 0.0]
    shown = sorted(own, key=lambda one: -one.largest())[:_MOST]
    marks = tuple(_points(trend, one, place) for place, one in enumerate(shown))
    if not marks:
        return None
    return Panel("", Axis(_SINCE), Axis(f"change / {unit}"), (Level(0.0, Role.AXIS, dash="dashed"), *marks))


_SINCE = "days since the first result"


def _points(trend: Trend, one: Course, ink: int) -> Points:
    changes = one.changes
    return Points(
        _days(trend, list(changes)),
        np.array([change.difference for change in changes.values()]),
        ink,
        one.name,
        np.array([change.u for change in changes.values()]),
        joined=True,
    )


def _largest(trend: Trend) -> Panel:
    found = {
        place: largest[1]
        for place in range(len(trend.results))
        if place != trend.baseline and (largest := trend.largest(place)) is not None
    }
    points = Points(_days(trend, list(found)), np.array(list(found.values())), Role.CHANGE, joined=True)
    levels = tuple(Level(end, Role.EXPECTED, dash="dashed") for end in (-EXPANDED, EXPANDED))
    return Panel("", Axis(_SINCE), Axis("largest change / u"), (*levels, points))
