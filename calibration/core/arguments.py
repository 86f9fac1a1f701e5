"""Arguments that have no meaning are refused: one rule each, and a text that says what, where and what to do."""

from collections.abc import Callable
from typing import Any, get_args

import numpy as np
from numpy.typing import ArrayLike

from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Bools, Floats, Ints


def require_one_of(names: Any, value: object, what: str) -> None:
    """Refuse a name that a Literal type does not list.

    Args:
        names: the Literal type.
        what: whose name it is, as the text calls it.

    Raises:
        ArgumentError: the text lists the names.
    """
    known = get_args(names)
    if value not in known:
        listed = ", ".join(str(name) for name in known)
        raise ArgumentError(f"{what} is {value!r}, which is unknown: use one of {listed}")


def require_finite(values: ArrayLike, what: str) -> None:
    """Refuse numbers that are NaN or infinite."""
    _require(values, np.isfinite, what, "it has to be a finite number")


def require_positive(values: ArrayLike, what: str, *, infinite: bool = False) -> None:
    """Refuse numbers that are NaN, negative or zero; infinite ones, too, unless they are permitted."""
    _require(values, lambda x: (x > 0.0) & (infinite | (x < np.inf)), what, "it has to be positive")


def require_not_negative(values: ArrayLike, what: str) -> None:
    """Refuse numbers that are NaN, negative or infinite."""
    _require(values, lambda x: (x >= 0.0) & (x < np.inf), what, "it has to be zero or positive")


def require_share(values: ArrayLike, what: str) -> None:
    """Refuse numbers that do not lie between 0 and 1."""
    wanted = "it has to lie between 0 and 1, as 0.95 for 95 %"
    _require(values, lambda x: (x > 0.0) & (x < 1.0), what, wanted)


def require_directions(values: ArrayLike, what: str) -> None:
    """Refuse directions of approach other than 1 and -1."""
    _require(values, lambda x: np.abs(x) == 1.0, what, "use 1 for upwards and -1 for downwards")


def require_count(value: float, what: str, least: int = 1) -> None:
    """Refuse a count that is not whole, or too small."""
    _require(value, lambda x: (x >= least) & (x == np.floor(x)), what, f"use a whole number from {least} on")


def require_below(numbers: Ints, end: int, what: str) -> None:
    """Refuse numbers that count something of which there are fewer."""
    _require(numbers, lambda x: (x >= 0) & (x < end), what, f"there are {end}, counted from 0")


def require_range(ends: tuple[float, float], what: str) -> None:
    """Refuse a range whose ends are exchanged or no numbers."""
    low, high = ends
    if not low <= high:
        raise ArgumentError(f"{what} goes from {low:g} to {high:g}: state the smaller end first")


def require_increasing(nodes: Floats, what: str) -> None:
    """Refuse nodes that are none, not finite, or do not increase strictly."""
    require_shape(nodes, (None,), what)
    if not nodes.size:
        raise ArgumentError(f"{what} are empty: state one node or more")
    require_finite(nodes, what)
    steps = np.append(1.0, np.diff(nodes))
    _require(steps, lambda x: x > 0.0, f"steps of {what}", "nodes have to increase strictly; sort them")


def require_shape(array: ArrayLike, shape: tuple[int | None, ...], what: str) -> None:
    """Refuse an array of another shape.

    Args:
        shape: wanted; None where any length will do.
    """
    found = np.shape(array)
    if len(found) != len(shape) or any(b not in {None, a} for a, b in zip(found, shape, strict=True)):
        wanted = " × ".join("any" if length is None else str(length) for length in shape)
        given = " × ".join(map(str, found)) or "a single number"
        raise ArgumentError(f"{what}: {wanted} numbers are needed, not {given}")


def _require(values: ArrayLike, good: Callable[[Floats], Bools], what: str, wanted: str) -> None:
    """Refuse the first number that is not good."""
    numbers = np.asarray(values, dtype=np.float64)
    wrong = np.flatnonzero(~np.ravel(good(numbers)))
    if wrong.size:
        where = f"entry {int(wrong[0]) + 1} of {what}" if numbers.ndim else what
        raise ArgumentError(f"{where} is {float(np.ravel(numbers)[wrong[0]]):g}: {wanted}")
