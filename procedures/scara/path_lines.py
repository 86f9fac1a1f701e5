"""Several lines in one path: each is entered anew, and its states of approach begin anew."""

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]


def stretches(line: Ints) -> list[slice]:
    """Return the rows of each line, in order.

    Args:
        line: number of the line of each row, shape (n,); rows of one line stand together.
    """
    starts = [0, *(np.flatnonzero(np.diff(line)) + 1).tolist()]
    return [slice(start, end) for start, end in zip(starts, [*starts[1:], line.size], strict=True)]


def scattered(line: Ints) -> int | None:
    """Return the first row of a line that was left before; None where rows of one line stand together."""
    seen: set[int] = set()
    for rows in stretches(line):
        start = int(rows.start)
        number = int(line[start])
        if number in seen:
            return start
        seen.add(number)
    return None


def scattered_text(number: int) -> str:
    """Return what is wrong with a line that was left before, and what to do."""
    return (
        f"line {number} was left before and goes on here: let its rows stand together, or number these again"
    )
