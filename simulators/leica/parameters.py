"""What an emScon server keeps for its clients: blocks of parameters that one command sets and another reads."""

import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from catseye.simulators.leica.coordinates import COUNTS, KINDS

OK, NOT_IMPLEMENTED, WRONG_PARAMETER, OUT_OF_RANGE = 0, 2, 3, 12
NO_CAMERA: Final = 67

UNITS, TRANSFORMATION, REFRACTION, MODE, COORDINATES = 5, 14, 22, 24, 26
STATIONARY, CONTINUOUS_TIME, CONTINUOUS_DISTANCE, REFLECTOR = 28, 30, 32, 40
SEARCH, SETTINGS, STATISTIC = 43, 47, 80

REFRACTION_RANGE: Final = (1.000150, 1.000331)
UNSOLICITED, REFLECTOR_POSITIONS = 4, 5
"""Places within the settings."""

STATIONARY_MODE, TIME_MODE, DISTANCE_MODE = 0, 1, 2

REFLECTORS: Final = (("CCR-1.5in", 1, 0.01905), ("CCR-0.5in", 1, 0.00635), ("RRR-1.5in", 5, 0.01905))
"""Name, type, surface offset in m."""

Values = tuple[float, ...]
Check = Callable[[Values], int]


def _within(low: float, high: float) -> Check:
    return lambda values: OK if all(low <= value <= high for value in values) else OUT_OF_RANGE


def _units(values: Values) -> int:
    fits = all(0 <= value < count for value, count in zip(values, COUNTS, strict=True))
    return OK if fits else WRONG_PARAMETER


def _mode(values: Values) -> int:
    if values[0] in {STATIONARY_MODE, TIME_MODE, DISTANCE_MODE}:
        return OK
    return NO_CAMERA if 6 <= values[0] <= 11 else NOT_IMPLEMENTED if 3 <= values[0] <= 5 else WRONG_PARAMETER


@dataclass(frozen=True)
class Block:
    """A block of parameters.

    Attributes:
        read_by: the command that reads it.
        layout: of its values, as in the module struct.
        first: its values at first.
        news: code of the change of state that its change is.
        check: returns the status of values that a client sets.
    """

    read_by: int
    layout: str
    first: Values
    news: int
    check: Check = lambda _values: OK

    def packed(self, values: Values) -> bytes:
        """Return values as bytes."""
        return struct.pack(f"<{self.layout}", *values)


BLOCKS: Final[dict[int, Block]] = {
    3: Block(4, "i", (1,), 9, _within(0, 3)),
    UNITS: Block(6, "5i", (0, 0, 0, 0, 0), 6, _units),
    12: Block(13, "6d", (0.0,) * 6, 15),
    TRANSFORMATION: Block(15, "7d", (*(0.0,) * 6, 1.0), 16),
    16: Block(17, "6d", (0.0,) * 6, 13),
    18: Block(19, "4d", (0.0,) * 4, 14),
    REFRACTION: Block(23, "2d", (1.00027, 1.00027), 3, _within(*REFRACTION_RANGE)),
    MODE: Block(25, "i", (STATIONARY_MODE,), 17, _mode),
    COORDINATES: Block(27, "i", (7,), 12, _within(KINDS[0], KINDS[-1])),
    STATIONARY: Block(
        29, "2i", (2000, 0), 18, lambda values: OK if 1 <= values[0] <= 100_000 else OUT_OF_RANGE
    ),
    CONTINUOUS_TIME: Block(
        31, "4i", (500, 0, 0, 0), 19, lambda values: OK if values[0] >= 1 and values[1] >= 0 else OUT_OF_RANGE
    ),
    CONTINUOUS_DISTANCE: Block(
        33,
        "d3i",
        (0.01, 0, 0, 0),
        20,
        lambda values: OK if values[0] > 0.0 and values[1] >= 0 else OUT_OF_RANGE,
    ),
    34: Block(35, "diid", (0.01, 0, 0, 0.0), 23),
    36: Block(37, "diid", (0.01, 0, 0, 0.0), 22),
    38: Block(39, "3d3i", (0.0, 0.0, 0.0, 0, 0, 0), 21),
    REFLECTOR: Block(
        41, "i", (1,), 7, lambda values: OK if 1 <= values[0] <= len(REFLECTORS) else WRONG_PARAMETER
    ),
    SEARCH: Block(44, "di", (0.05, 5000), 4, lambda values: OK if min(values) > 0.0 else OUT_OF_RANGE),
    45: Block(46, "dii", (0.0001, 1000, 3), 5),
    SETTINGS: Block(48, "9i", (2, 0, 0, 1, 1, 0, 0, 1, 0), 8),
    79: Block(85, "i", (1,), 11, _within(1, 1)),
    STATISTIC: Block(81, "2i", (0, 0), 24, _within(0, 1)),
    83: Block(84, "3i", (128, 128, 128), 10),
    92: Block(93, "2i", (0, 0), 8),
    96: Block(97, "i", (1,), 29, _within(0, 3)),
}
"""By the command that sets them."""

READ_BY: Final = {block.read_by: number for number, block in BLOCKS.items()}


class Parameters:
    """The values of all blocks."""

    def __init__(self) -> None:
        self.restore()

    def restore(self) -> None:
        """Return to the first values."""
        self._values = {number: block.first for number, block in BLOCKS.items()}

    def __getitem__(self, number: int) -> Values:
        return self._values[number]

    def keep(self, number: int, values: Values) -> None:
        """Change a block without a client."""
        self._values[number] = values

    def write(self, number: int, data: bytes) -> int:
        """Set a block as a client wants it; return the status."""
        block = BLOCKS[number]
        if len(data) != struct.calcsize(f"<{block.layout}"):
            return WRONG_PARAMETER
        values = struct.unpack(f"<{block.layout}", data)
        status = block.check(values)
        if status == OK:
            self._values[number] = values
        return status

    def packed(self, number: int) -> bytes:
        """Return a block as bytes."""
        return BLOCKS[number].packed(self._values[number])
