"""By what ratio the steps of a decreasing series really fall: another one than commanded is that of another run.

A joint makes of every step the same share, and the same angle or length too much or too little (ADR 34): what is
measured is a straight line over what is commanded. Steps that fall by another ratio are a power of the command.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.flags import Flag
from catseye.calibration.resolution.steps import Steps

_LENGTHS: Final = (22, 30, 38, 46, 54, 62)
"""Steps from the largest on that are looked at: the more of them, the clearer a power; the small ones scatter."""

_POWERS: Final[Floats] = np.linspace(-0.8, 1.0, 181)
_CLEAR: Final = 6.5
"""Standard deviations of a power that is none of chance: joints of emulated arms have reached 5."""

_LARGE: Final = 30.0
"""Standard uncertainties of a step above which its noise does not matter."""

_MADE: Final = 0.2
"""Steps that are made to less than this share are none of a series."""

_FLAGGED: Final = 0.02
_REFUSED: Final = 0.1
"""Power that no law of a joint makes the same over all its larger steps: a tenth too much after 14 of them."""

_FEWEST: Final = 3
"""Lengths that have to show a power."""

_ALIKE: Final = 0.25
_ALIKE_AT_LEAST: Final = 0.015
_ALIKE_IN_U: Final = 4.0
"""Powers over fewer and more steps differ by less, as a share, by themselves, or in standard uncertainties."""


@dataclass(frozen=True)
class _Power:
    """Exponent of the command, less 1, that fits measured steps best, and its standard uncertainty."""

    value: float
    u: float

    @property
    def clear(self) -> bool:
        return abs(self.value) > max(_FLAGGED, _CLEAR * self.u)

    def agrees(self, other: float) -> bool:
        return abs(self.value - other) <= max(_ALIKE * abs(other), _ALIKE_AT_LEAST, _ALIKE_IN_U * self.u)


def other_power(command: Floats, measured: Floats) -> float:
    """Return the power of the command, less 1, that measured steps are; 0 where they may be those commanded.

    Only one counts that is the same over fewer and more steps, as that of another series is: the law of a joint whose
    error grows otherwise looks like another power from every length.

    Args:
        command: sizes from the largest on, shape (n,).
        measured: positive in the direction of the command, shape (n,).
    """
    made = (length for length in _LENGTHS if (measured[:length] > _MADE * command[:length]).all())
    powers = [_power(command[:length], measured[:length]) for length in made if length <= command.size]
    clear = [power for power in powers if power.clear]
    if len(clear) < _FEWEST:
        return 0.0
    usual = float(np.median([power.value for power in clear]))
    return usual if all(power.agrees(usual) for power in clear) else 0.0


def ratio_flags(found: Steps) -> list[Flag]:
    """Return a flag for steps of a decreasing series that fall by another ratio than commanded, none for others.

    Raises:
        MovesError: they differ by so much that they are those of another run.
    """
    command, measured = np.abs(found.moves.command), found.measured * found.moves.directions
    small = np.flatnonzero(~(command > _LARGE * found.noise.step))
    count = int(small[0]) if small.size else command.size
    power = other_power(command[:count], measured[:count])
    if not power:
        return []
    usual = float(np.median(command[:-1] / command[1:]))
    said = (
        f"the steps fall by {usual ** (1.0 + power):.4g} from one to the next, those commanded by {usual:.4g}"
    )
    if abs(power) >= _REFUSED:
        raise MovesError(
            f"{said}: these are moves of another run; take those of this recording", found.moves.first
        )
    text = f"{said}: these may be moves of another run; check whether they are those of this recording"
    return [Flag("scale", text)]


def _power(command: Floats, measured: Floats) -> _Power:
    """Return the power that steps are, 0 for a straight line over their commands."""
    share, size = measured / command, command / command[0]
    misfits = np.array([_misfit(share, size, power) for power in _POWERS.tolist()])
    best, straight = int(np.argmin(misfits)), _misfit(share, size, 0.0)
    variance = max(float(misfits[best]) / (size.size - 3), np.finfo(float).tiny)
    value = float(_POWERS[best])
    # What the fit gains by the power is the square of it in standard uncertainties.
    return _Power(
        value, abs(value) / math.sqrt(max((straight - misfits[best]) / variance, np.finfo(float).tiny))
    )


def _misfit(share: Floats, size: Floats, power: float) -> float:
    """Return the sum of squares that a power of the command, and a constant, leave of the shares that were made."""
    design = np.column_stack([size**power, 1.0 / size])
    rest = share - design @ np.linalg.lstsq(design, share, rcond=None)[0]
    return float(rest @ rest)
