"""Lengths at 20 °C against calculation by hand."""

import pytest

from catseye.calibration.standards.expansion import Material, at_reference


def test_a_steel_link_two_kelvin_too_warm() -> None:
    steel = Material(22.0, 0.2, 11.5e-6, 1.0e-6)
    length, u = at_reference(225.0, 0.0005, steel)
    assert length == pytest.approx(224.994825, abs=1e-6)
    # 2 K times 1e-6/K and 11.5e-6/K times 0.2 K, of 225 mm, beside the length's own half micrometre.
    assert u == pytest.approx((0.0005**2 + (225 * 2.0e-6) ** 2 + (225 * 2.3e-6) ** 2) ** 0.5, rel=1e-9)


def test_at_the_reference_only_the_thermometer_counts() -> None:
    length, u = at_reference(325.0, 0.0, Material(20.0, 0.1, 23.6e-6, 1.0e-6))
    assert length == 325.0
    assert u == pytest.approx(325.0 * 23.6e-7)
