"""Where joints are tested, and how the rest of the arm stands meanwhile."""

from collections.abc import Sequence
from typing import Final

from catseye.drivers.roles.pose import Axis, Pose, pose_of, with_axis
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.errors import PlanError

COUNT: Final = 5
"""Places of a joint: K1 … K5 (resolution paper, Table 2)."""

_MARGIN: Final = 10.0
"""From either end of a range to the outermost place, deg or mm, where the arm's description names no places."""


def places_of(bench: Bench, axis: str) -> tuple[float, ...]:
    """Return K1 … K5 of an axis, deg or mm: as the arm's description has them, else spread over its range."""
    number = axis_number(bench, axis)
    stated = bench.arm.test_places[number] if bench.arm.test_places else ()
    return stated or _spread(bench.arm.axes[number])


def chosen_places(bench: Bench, axis: str, names: Sequence[str]) -> tuple[tuple[str, float], ...]:
    """Return places of an axis with their names.

    Args:
        names: of those that are chosen; all when empty.

    Raises:
        PlanError: there is no such place.
    """
    known = {f"K{number}": value for number, value in enumerate(places_of(bench, axis), 1)}
    if unknown := [name for name in names if name not in known]:
        raise PlanError(f"there is no position {unknown[0]}: choose among {', '.join(known)}")
    return tuple((name, known[name]) for name in names or known)


def chosen_axes(bench: Bench, names: Sequence[str]) -> tuple[str, ...]:
    """Return the axes to test: those named, or every one that turns.

    Raises:
        PlanError: there is no such axis, or it slides.
    """
    turning = [axis.name for axis in bench.arm.axes if axis.unit == "deg"]
    if unknown := [name for name in names if name not in turning]:
        raise PlanError(
            f"{unknown[0]} is not an axis that turns: angular optics measure {', '.join(turning)}; correct joints"
        )
    return tuple(names) or tuple(turning)


def axis_number(bench: Bench, axis: str) -> int:
    """Return the number of an axis, from 0.

    Raises:
        PlanError: the arm has no such axis.
    """
    names = [each.name for each in bench.arm.axes]
    if axis not in names:
        raise PlanError(f"the arm has no axis {axis}: it has {', '.join(names)}")
    return names.index(axis)


def standing(bench: Bench, given: Sequence[float]) -> Pose:
    """Return how the axes stand that are not tested: as given, else each in the middle of its range.

    Raises:
        PlanError: a value is missing, or there is one too many.
    """
    if not given:
        return tuple((axis.low + axis.high) / 2.0 for axis in bench.arm.axes)
    try:
        return pose_of(bench.arm.axes, given)
    except ValueError as error:
        raise PlanError(f"pose_deg: {error}; give one value for each axis") from error


def turned(bench: Bench, pose: Pose, axis: str, value: float) -> Pose:
    """Return a pose with another value of one axis, deg or mm."""
    return with_axis(pose, axis_number(bench, axis), value)


def _spread(axis: Axis) -> tuple[float, ...]:
    low, high = axis.low + _MARGIN, axis.high - _MARGIN
    if not low < high:
        raise PlanError(
            f"{axis.name} has a range of {axis.low:g} … {axis.high:g} {axis.unit}: too small for a test that begins "
            f"{_MARGIN:g} {axis.unit} from its ends; widen it in the cell file"
        )
    return tuple(low + (high - low) * number / (COUNT - 1) for number in range(COUNT))
