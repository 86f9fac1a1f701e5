"""Error maps and links of a SCARA over months."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from catseye.app.results.figures import Axis, Figure, Ink, Panel, Points, Role
from catseye.app.results.scara.comparison import MapDifference, ResultComparison, compare_results
from catseye.app.results.scara.comparison_report import all_differences
from catseye.app.results.scara.result import Result
from catseye.app.results.stored_results import StoredResult
from catseye.app.results.trend.course import Course, Value


@dataclass(frozen=True)
class ScaraCourses:
    """What results of one SCARA say.

    Attributes:
        courses: of all quantities, in the frame of the baseline.
        figures: the maps over months.
        remarks: what a reader has to know.
    """

    courses: tuple[Course, ...]
    figures: tuple[Figure, ...]
    remarks: tuple[str, ...]


def courses_of_scara(results: Sequence[StoredResult], read: Sequence[Result], baseline: int) -> ScaraCourses:
    """Return what results say against one of them.

    Args:
        results: files of the results.
        read: what they hold.

    Raises:
        UsageError: one has no angle in common with the baseline.
    """
    compared = [compare_results(read[baseline], one) for one in read]
    beside = {change.name for one in compared for change in one.reflectors}
    by_name = [{change.name: change for change in all_differences(one)} for one in compared]
    names = dict.fromkeys(name for found in by_name for name in found)
    courses = []
    for name in names:
        found = [each.get(name) for each in by_name]
        values = tuple(
            None
            if change is None
            else Value(change.second, change.u_second, None if number == baseline else change)
            for number, change in enumerate(found)
        )
        unit = next(change.unit for change in found if change is not None)
        courses.append(Course(name, unit, name not in beside, values))
    remarks = dict.fromkeys(
        text for number, one in enumerate(compared) if number != baseline for text in one.remarks
    )
    return ScaraCourses(tuple(courses), _maps(results, compared), tuple(remarks))


def _maps(results: Sequence[StoredResult], compared: Sequence[ResultComparison]) -> tuple[Figure, ...]:
    """Return the maps of all results, a row of panels a joint; the latest stands out."""
    if not all(one.maps for one in compared):
        return ()
    rows = tuple(
        tuple(_panel(results, [one.maps[joint] for one in compared], direction) for direction in (0, 1))
        for joint in (0, 1)
    )
    caption = (
        "Error maps of all results in the frame of the baseline, each by the day of its measurement; error bars: "
        "U (k = 2) of the latest."
    )
    return (Figure("maps-over-months", "Error maps over months", caption, rows, aspect=0.8),)


def _panel(results: Sequence[StoredResult], maps: Sequence[MapDifference], direction: int) -> Panel:
    last = len(results) - 1
    marks = tuple(
        Points(
            one.node_deg,
            one.second_mdeg[direction],
            *(look := _look(results, number)),
            one.second_u_mdeg[direction] if number == last else None,
            joined=True,
            faint=look[0] is Role.SCATTER,
        )
        for number, one in enumerate(maps)
    )
    joint, sign = maps[0].joint, "+−"[direction]
    return Panel(
        f"J{joint}, direction {sign}", Axis(f"command θ{joint} / °"), Axis(f"Δθ{joint} / mdeg"), marks
    )


_NAMED: Final = 5
"""Newest results that have a look of their own; so has the oldest one."""


def _look(results: Sequence[StoredResult], number: int) -> tuple[Ink, str]:
    """Return ink and label of a result: the same in every panel, so that one legend names all curves."""
    age = len(results) - 1 - number
    if number > 0 and age >= _NAMED:
        return Role.SCATTER, "the others"
    return min(age, _NAMED), f"{results[number].measured:%Y-%m-%d}"
