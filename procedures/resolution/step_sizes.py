"""Sizes of the steps of a series: what the resolution paper and ISO 230 prescribe."""

from itertools import count, islice, takewhile
from typing import Final

FIRST_DEG: Final = 0.1
FIRST_MM: Final = 1.0
RATIO: Final = 1.072267
"""From one step to the next (resolution paper, section 3.4)."""

STEPS: Final = 109
"""From 0.1 down to about 5e-5 deg."""

ISO_STEPS: Final = 10
"""In each of three sequences (ISO 230-2, as the resolution paper, section 3.3, has it)."""

_DIGIT: Final = 1e-9

CYCLES: Final = 5
CYCLE_STEPS: Final = 10
PRELIMINARY: Final = 5
"""Of a backlash test (resolution paper, section 3.5): cycles, steps each way, steps that centre it."""


def decaying(first: float, steps: int, resolution: float | None, ratio: float = RATIO) -> tuple[float, ...]:
    """Return step sizes that decay exponentially.

    A controller that rounds where a step ends can only tell multiples of its resolution apart: the sizes are those
    multiples that lie nearest to the series, each once, so that a step stays smaller than the one before it.

    Args:
        first: size of the first one, deg or mm.
        steps: how many at most.
        resolution: smallest step that the controller can command; the series ends there. None: it resolves all.
        ratio: of a step to the next one.
    """
    sizes = (first / ratio**number for number in count())
    if resolution is None:
        return tuple(islice(sizes, steps))
    # The first size may miss the resolution by a last digit.
    least = resolution * (1.0 - _DIGIT)
    multiples = dict.fromkeys(
        round(size / resolution) for size in takewhile(lambda size: size >= least, sizes)
    )
    return tuple(number * resolution for number in islice(multiples, steps))


def there_and_back(size: float, senses: tuple[int, ...], steps: int) -> tuple[tuple[int, float], ...]:
    """Return sequences of equal steps, each step as the number of its sequence, from 1, and its signed size.

    Args:
        senses: 1 or -1 for each sequence.
        steps: in each.
    """
    return tuple((number, sense * size) for number, sense in enumerate(senses, 1) for _ in range(steps))
