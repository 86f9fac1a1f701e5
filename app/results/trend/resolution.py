"""Least steps and reversal errors of joints over months."""

from collections.abc import Iterator, Sequence

from catseye.app.results.resolution.naming import direction_sign
from catseye.app.results.resolution.result import AnyTest, ResolutionResult
from catseye.app.results.trend.course import Course, course


def courses_of_resolution(results: Sequence[ResolutionResult], baseline: int) -> tuple[Course, ...]:
    """Return what tests say against those of one result; shipped ones are not of this arm."""
    read = [
        {
            name: (unit, value, u)
            for test in each.tests
            if not test.shipped
            for name, unit, value, u in _values(test)
        }
        for each in results
    ]
    names = dict.fromkeys(name for found in read for name in found)
    return tuple(_course(name, [found.get(name) for found in read], baseline) for name in names)


def _course(name: str, found: Sequence[tuple[str, float, float] | None], baseline: int) -> Course:
    unit = next(one[0] for one in found if one is not None)
    return course(name, unit, [None if one is None else one[1:] for one in found], baseline)


def _values(test: AnyTest) -> Iterator[tuple[str, str, float, float]]:
    """Yield name, unit, value and standard uncertainty of what a test gives."""
    where = test.position_name or test.pose or ("" if test.position is None else f"{test.position:g}")
    about = " ".join(text for text in (test.joint, where, test.test) if text)
    if test.lis is not None:
        yield f"{about} {direction_sign(test.direction)} least step", test.unit, test.lis.value, test.lis.u
    if test.reversal is not None and test.reversal.u is not None:
        yield f"{about} reversal error", test.unit, test.reversal.value, test.reversal.u
