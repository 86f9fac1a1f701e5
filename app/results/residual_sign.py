"""The sign of residuals on pages and screens: measured minus predicted."""

from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from catseye.calibration.core.types import Floats

_Residual = TypeVar("_Residual", float, "Floats")


def measured_minus_predicted(residual: _Residual) -> _Residual:
    """Return residuals as a reader sees them; solvers, result files and `--json` state predicted minus measured."""
    return -residual
