"""Parameters of a serial arm over months."""

from collections.abc import Sequence
from dataclasses import replace

from catseye.app.results.serial_arm.result import SerialArmResult
from catseye.app.results.trend.course import Course, course


def courses_of_serial_arm(results: Sequence[SerialArmResult], baseline: int) -> tuple[Course, ...]:
    """Return what calibrations say against one of them; where the base stands is shown and not judged."""
    read = [{one.name: one for one in each.parameters if one.identified} for each in results]
    names = dict.fromkeys(name for parameters in read for name in parameters)
    courses = []
    for name in names:
        found = [parameters.get(name) for parameters in read]
        unit = next(one.unit for one in found if one is not None)
        values = [None if one is None else (one.value, one.u) for one in found]
        judged = not name.startswith("base.")
        courses.append(replace(course(name, unit, values, baseline), judged=judged))
    return tuple(courses)
