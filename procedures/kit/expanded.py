"""How an uncertainty is told to people: expanded. Data and files hold standard uncertainties."""

from typing import Final

EXPANDED: Final = 2.0
"""Coverage factor of expanded uncertainties; 95 in 100 errors lie within so many standard uncertainties."""


def expanded_text(value: float, u: float, decimals: int, *, signed: bool = False) -> str:
    """Return a value with its expanded uncertainty U (k = 2), as screens show it.

    Args:
        u: standard uncertainty, in the unit of the value.
    """
    sign = "+" if signed else ""
    return f"{value:{sign}.{decimals}f} ± {EXPANDED * u:.{decimals}f}"
