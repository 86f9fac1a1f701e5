"""How parameters of a serial arm are written."""

from typing import Final

from catseye.app.results.numbers import THREE_DIGITS, Format, fixed

_FORMS: Final[dict[str, Format]] = {"mm": fixed(4), "deg": fixed(5)}


def parameter_format(unit: str) -> Format:
    """Return the format of a parameter by its unit."""
    return _FORMS.get(unit, THREE_DIGITS)
