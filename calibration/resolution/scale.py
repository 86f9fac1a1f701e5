"""Steps that are all longer or shorter than commanded by one factor, and which mistake makes them so."""

import math
from dataclasses import dataclass
from typing import Final

_MISTAKES: Final = {
    2.0: "the stated spacing is half of the real one, or each count stands for half the displacement",
    0.5: "the stated spacing is twice the real one, or each count stands for twice the displacement",
    25.4: "mm were taken for inches, or spacing or commands are in inches",
    1.0 / 25.4: "inches were taken for mm",
    1e3: "the unit of the recording is smaller than the stated one by 1000",
    1e-3: "the unit of the recording is larger than the stated one by 1000",
    math.degrees(1.0): "degrees were taken for radians, or the commands are in radians",
    math.radians(1.0): "radians were taken for degrees, or the commands are in degrees",
}
"""What makes all steps longer by a factor."""

_NEAR: Final = 0.03
"""A ratio this near to a factor gives the mistake away."""

_SAME: Final = 0.1
"""The waves of a gear make steps of a tenth of a degree longer or shorter by some per cent."""


@dataclass(frozen=True)
class Mistake:
    """What may have made all steps of a series longer.

    Attributes:
        factor: by which it makes them longer.
        text: what it is.
    """

    factor: float
    text: str


def likely_mistake(ratio: float) -> Mistake | None:
    """Return what makes the largest steps this many times as long as they were commanded; None for nothing known."""
    near = (Mistake(factor, text) for factor, text in _MISTAKES.items() if abs(ratio / factor - 1.0) <= _NEAR)
    return next(near, None)


def is_scaled(ratio: float) -> bool:
    """Return whether steps are longer or shorter than commanded by more than a joint makes those that it follows.

    Args:
        ratio: of measured to commanded, in the median.
    """
    return abs(ratio - 1.0) > _SAME


def scale_text(ratio: float) -> str:
    """Return what makes all steps this many times as long as they were commanded, and what to do."""
    known = likely_mistake(ratio)
    likely = (
        f"if the spacing of the optics is wrong, the real one is {ratio:.3g} times the stated one; else a unit is "
        "wrong, or these are moves of another run"
        if known is None
        else known.text
    )
    return f"{likely}; correct it and evaluate again"
