"""How uncertain a measured point is: what a tracker states of it, checked before anybody relies on it.

Nothing public says when a server fills a field with a zero. Where all three covariances are zero, none is stated;
where an a-priori standard deviation is zero, only the readings speak: by how much they scatter, not by how much the
instrument is wrong in all of them.
"""

import math
from typing import Final

from catseye.drivers.leica.measurement import StationaryResult
from catseye.drivers.leica.settings import LeicaSettings
from catseye.drivers.roles.errors import RefusedError
from catseye.drivers.roles.tracker import Place, TargetPoint

_LEAST_DETERMINANT: Final = 1e-9
"""Of the correlations of three coordinates. A distance that is known 100 times better than what lies across it makes
3e-4; below this, rounding decides."""


def point_of(where: str, target: str, result: StationaryResult, settings: LeicaSettings) -> TargetPoint:
    """Return a measured point with its uncertainty.

    Args:
        where: device and endpoint, for the text.

    Raises:
        RefusedError: the tracker states no uncertainty beside the scatter of its readings, and the cell file neither,
            or one that no errors can have.
    """
    if lacking := [axis for axis, u in zip("xyz", result.a_priori_mm, strict=True) if not u > 0.0]:
        if settings.u_mm is None:
            raise RefusedError(
                f"{where}: {target} was measured, and the tracker states no uncertainty of its own of "
                f"{', '.join(lacking)}, only how the readings scatter: state u_mm in [tracker.settings] of the cell "
                "file, from the data sheet or an instrument-check, which counts beside that then",
                0,
            )
        return TargetPoint(result.place_mm, _with_own(result, settings.u_mm))
    covariance_mm2 = result.covariance_mm2
    if covariance_mm2 is None or not any(covariance_mm2):
        return TargetPoint(result.place_mm, result.u_mm)
    if not _is_possible(result.u_mm, covariance_mm2):
        stated = ", ".join(f"{value:.3g}" for value in covariance_mm2)
        raise RefusedError(
            f"{where}: {target} was measured with covariances (xy, xz, yz: {stated} mm²) that no errors can have "
            f"beside standard deviations of {', '.join(f'{u:.3g}' for u in result.u_mm)} mm: its server means "
            "something else by them; write covariances = false in [tracker.settings] of the cell file",
            0,
        )
    return TargetPoint(result.place_mm, result.u_mm, covariance_mm2)


def _with_own(result: StationaryResult, u_mm: float) -> Place:
    """Return the uncertainties with one of the instrument's own where it states none."""
    x, y, z = (
        math.hypot(scatter, own if own > 0.0 else u_mm)
        for scatter, own in zip(result.scatter_mm, result.a_priori_mm, strict=True)
    )
    return x, y, z


def _is_possible(u_mm: Place, covariance_mm2: Place) -> bool:
    """Return whether covariances belong to a positive definite matrix."""
    (x, y, z), (xy, xz, yz) = u_mm, covariance_mm2
    a, b, c = xy / (x * y), xz / (x * z), yz / (y * z)
    determinant = 1.0 + 2.0 * a * b * c - math.fsum((a * a, b * b, c * c))
    return max(abs(a), abs(b), abs(c)) < 1.0 and determinant > _LEAST_DETERMINANT
