"""Saturation pressure of water vapour over water and over ice (IAPWS)."""

import numpy as np
from numpy.typing import ArrayLike

from catseye.calibration.core.types import Floats

_K1, _K2, _K3, _K4, _K5 = 1167.05214528, -724213.167032, -17.0738469401, 12020.8247025, -3232555.03223
_K6, _K7, _K8, _K9, _K10 = 14.9151086135, -4823.26573616, 405113.405421, -0.238555575678, 650.175348448
_TRIPLE_POINT_K = 273.16
_TRIPLE_POINT_PA = 611.657


def vapour_pressure_pa(temperature_c: ArrayLike) -> Floats:
    """Return the saturation pressure, over ice below 0 °C and over water from there on, Pa.

    Args:
        temperature_c: temperature, °C.
    """
    temperature = np.asarray(temperature_c, dtype=np.float64)
    kelvin = temperature + 273.15
    return np.where(temperature < 0.0, _over_ice_pa(kelvin), _over_water_pa(kelvin))


def _over_water_pa(kelvin: Floats) -> Floats:
    omega = kelvin + _K9 / (kelvin - _K10)
    a = omega**2 + _K1 * omega + _K2
    b = _K3 * omega**2 + _K4 * omega + _K5
    c = _K6 * omega**2 + _K7 * omega + _K8
    root = 2.0 * c / (-b + np.sqrt(b**2 - 4.0 * a * c))
    return np.asarray(1e6 * root**4, dtype=np.float64)


def _over_ice_pa(kelvin: Floats) -> Floats:
    theta = kelvin / _TRIPLE_POINT_K
    exponent = -13.928169 * (1.0 - theta**-1.5) + 34.7078238 * (1.0 - theta**-1.25)
    return np.asarray(_TRIPLE_POINT_PA * np.exp(exponent), dtype=np.float64)
