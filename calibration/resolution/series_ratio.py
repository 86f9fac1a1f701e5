"""By what ratio the steps of a decreasing series really fall: another one than commanded is that of another run.

A joint makes of every step the same share, and the same angle or length too much or too little (ADR 34): what is
measured is a straight line over what is commanded. Steps that fall by another ratio are a power of the command.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.flags import Flag
from catseye.calibration.resolution.steps import Steps

_LENGTHS: Final = (22, 30, 38, 46, 54, 62)
"""Steps from the largest on that are looked at: the more of them, the clearer a power; the small ones scatter."""

_FEWEST: Final = 3
"""Lengths that have to show a power."""

_FEWEST_STEPS: Final = 8
"""Steps of a series that falls so fast that all others are hardly made."""

_POWERS: Final[Floats] = np.arange(-80.0, 251.0) / 100.0
_CLEAR: Final = 6.5
"""Standard deviations of a power that is none of chance: joints of emulated arms have reached 5."""

_LARGE: Final = 30.0
"""Standard uncertainties of a step above which its noise does not matter."""

_MADE: Final = 0.2
"""Steps that are made to less than this share are none of a series."""

_FLAGGED: Final = 0.02
_DOUBTED: Final = 0.06
"""Laws of friction come near to it: errors linear in the logarithm of the step, or by the power of contacts."""

_REFUSED: Final = 0.1
"""Power that no law of a joint makes the same over all its larger steps: a tenth too much after 14 of them."""

_AS_FAR: Final = 0.75
"""A power is hardly made from its own step on; where that comes this much sooner, the joint stops following."""

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
    if command.size < _LENGTHS[_FEWEST - 1]:
        return 0.0
    hardly = np.flatnonzero(~(measured > _MADE * command))
    made = int(hardly[0]) if hardly.size else command.size
    power = _common_power(command, measured, _lengths(made))
    if made >= min(_LENGTHS[-1], command.size) or power <= 0.0:
        return power
    return power if command[made] <= command[0] * _MADE ** (_AS_FAR / power) else 0.0


def _lengths(made: int) -> list[int]:
    """Return over how many steps from the largest on a power is looked at.

    Args:
        made: steps before the first one that is hardly made: few of them where a series falls much faster.
    """
    if made >= _LENGTHS[_FEWEST - 1]:
        return [length for length in _LENGTHS if length <= made]
    fewest = max(_FEWEST_STEPS, made * _LENGTHS[0] // _LENGTHS[-1])
    if made < fewest:
        return []
    spread = np.linspace(fewest, made, len(_LENGTHS)).round().astype(int)
    return sorted(set(spread.tolist()))


def _common_power(command: Floats, measured: Floats, lengths: Sequence[int]) -> float:
    """Return the power that so many steps, from the largest on, share; 0 where they share none."""
    powers = [_power(command[:length], measured[:length]) for length in lengths]
    clear = [power for power in powers if power.clear]
    if len(clear) < _FEWEST:
        return 0.0
    usual = float(np.median([power.value for power in clear]))
    return usual if all(power.agrees(usual) for power in clear) else 0.0


def ratio_flags(found: Steps, *, confirmed: bool = False) -> list[Flag]:
    """Return a flag for steps of a decreasing series that fall by another ratio than commanded, none for others.

    Args:
        confirmed: the controller confirmed the moves: whatever the steps do, they are those of this recording.

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
    if abs(power) >= _REFUSED and not confirmed:
        raise MovesError(
            f"{said}: these are moves of another run; take those of this recording", found.moves.first
        )
    asked = (
        "the controller confirmed the moves, so it is the joint that follows otherwise; look at its friction"
        if confirmed
        else "are they moves of another run, or is it the friction of the joint? Check the file of the moves"
    )
    text = f"{said}: {asked}"
    return [Flag("scale" if abs(power) >= _DOUBTED else "ratio", text)]


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
