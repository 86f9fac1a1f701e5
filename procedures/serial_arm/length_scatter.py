"""The scatter of a few errors of length."""

from catseye.calibration.core.types import Floats


def scatter_of(errors_mm: Floats) -> float | None:
    """Return the standard deviation of a sample, n − 1 in the denominator: few lengths are measured; None of one."""
    return float(errors_mm.std(ddof=1)) if len(errors_mm) > 1 else None
