"""Uncertainties that a Leica tracker does not state, or that no errors can have: refused before a run is lost."""

import numpy as np
import pytest

from catseye.drivers.leica.measurement import StationaryResult
from catseye.drivers.leica.settings import LeicaSettings
from catseye.drivers.leica.uncertainty import point_of
from catseye.drivers.roles.errors import RefusedError
from catseye.drivers.roles.tracker import Place, TargetPoint
from catseye.simulators.leica import packets
from tests.unit.drivers.test_leica_tracker import rig
from tests.unit.simulators.world.serial.surveyed import exact_but

NONE: Place = (0.0, 0.0, 0.0)
STATED: Place = (0.003, 0.004, 0.012)

NOISY = exact_but(range_um=2.0, angle_um=20.0)


def point(
    a_priori_mm: Place = STATED,
    covariance_mm2: Place | None = None,
    scatter_mm: Place = NONE,
    u_mm: float | None = None,
) -> TargetPoint:
    result = StationaryResult(0, (1.0, 2.0, 3.0), scatter_mm, a_priori_mm, covariance_mm2)
    return point_of("tracker", "N1", result, LeicaSettings(u_mm=u_mm))


def is_covariance(u_mm: Place, covariance_mm2: Place) -> bool:
    """Return whether three coordinates can have it, by its eigenvalues."""
    (xy, xz, yz), (x, y, z) = covariance_mm2, np.square(u_mm)
    return bool(np.linalg.eigvalsh([[x, xy, xz], [xy, y, yz], [xz, yz, z]])[0] > 0.0)


@pytest.mark.parametrize("a_priori_mm", [NONE, (0.003, 0.0, 0.012)])
def test_a_coordinate_without_uncertainty_is_refused(a_priori_mm: Place) -> None:
    with pytest.raises(RefusedError, match=r"N1.*no uncertainty of .*state u_mm in \[tracker\.settings\]"):
        point(a_priori_mm)
    # How readings scatter does not say by how much the instrument is wrong in all of them.
    with pytest.raises(RefusedError, match="only how the readings scatter"):
        point(a_priori_mm, scatter_mm=STATED)


def test_the_cells_uncertainty_stands_in_for_what_is_missing() -> None:
    assert point(NONE, (0.0, 0.0, 0.0), u_mm=0.02) == TargetPoint((1.0, 2.0, 3.0), (0.02, 0.02, 0.02))
    assert point(STATED, u_mm=0.02).u_mm == STATED


def test_the_cells_uncertainty_counts_beside_the_scatter() -> None:
    found = point((0.004, 0.0, 0.0), scatter_mm=(0.003, 0.003, 0.005), u_mm=0.012)
    assert found.u_mm == pytest.approx((0.005, 153e-6**0.5, 0.013))
    assert found.covariance_mm2 is None


def test_covariances_of_zeros_are_not_stated() -> None:
    """Where the uncertainties differ, the beam would have to lie along an axis to the last bit."""
    assert point(covariance_mm2=(0.0, 0.0, 0.0)).covariance_mm2 is None
    assert point(covariance_mm2=(0.0, 1e-6, 0.0)).covariance_mm2 == (0.0, 1e-6, 0.0)


@pytest.mark.parametrize(
    "covariance_mm2",
    [
        (1.3e-5, 0.0, 0.0),
        (0.0, 0.0, -4.9e-5),
        # Each pair alone would be possible.
        (1.0e-5, 3.0e-5, -4.0e-5),
        (1.0e-5, 3.0e-5, 4.0e-5),
        (-1.0e-5, 3.0e-5, -4.0e-5),
        (1.2e-5, 3.6e-5, 4.8e-5),
    ],
)
def test_covariances_are_taken_where_coordinates_can_have_them(covariance_mm2: Place) -> None:
    if is_covariance(STATED, covariance_mm2):
        assert point(covariance_mm2=covariance_mm2).covariance_mm2 == covariance_mm2
        return
    with pytest.raises(
        RefusedError, match=r"no errors can have.*covariances = false in \[tracker\.settings\]"
    ):
        point(covariance_mm2=covariance_mm2)


async def test_a_tracker_without_statistics_is_refused_at_once() -> None:
    async with rig(u_mm=None) as one:
        with pytest.raises(RefusedError, match="state u_mm"):
            await one.point("nest1")
    async with rig(u_mm=0.02) as one:
        assert (await one.point("nest1")).u_mm == (0.02, 0.02, 0.02)


async def test_impossible_covariances_of_a_server_need_one_setting(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig(survey=NOISY) as one:
        u_mm = (await one.point("nest1", 1.0)).u_mm
        assert u_mm is not None
    # As of a server that states correlations.
    monkeypatch.setattr(packets, "_covariances", lambda _covariance: (0.9, -0.5, 0.8))
    async with rig(survey=NOISY) as one:
        with pytest.raises(RefusedError, match="covariances = false"):
            await one.point("nest1", 1.0)
    async with rig(survey=NOISY, covariances=False) as one:
        found = await one.point("nest1", 1.0)
        assert found.covariance_mm2 is None
        assert found.u_mm == pytest.approx(u_mm, rel=0.01)
