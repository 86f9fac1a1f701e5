"""Light in moist air: refractive index after Ciddor (1996) and Edlén (modified), constants of the NIST toolbox.

Arguments may be numbers or arrays that broadcast.
"""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from catseye.calibration.core.arguments import require_one_of, require_positive
from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Bools, Floats

Formula = Literal["ciddor", "edlen"]

HE_NE_VACUUM_NM = 632.9908
"""Vacuum wavelength of any unstabilised helium-neon laser (mise en pratique), nm."""

HE_NE_RELATIVE_U = 1.5e-6
"""Its relative standard uncertainty (mise en pratique)."""

_PHYSICAL = {
    "wavelength_vacuum_nm": (200.0, 3000.0, "nm"),
    "temperature_c": (-80.0, 100.0, "°C"),
    "pressure_hpa": (1.0, 2000.0, "hPa"),
    "humidity_percent": (0.0, 100.0, "%RH"),
    "co2_ppm": (0.0, 50_000.0, "ppm"),
}
_NIST = {
    "wavelength_vacuum_nm": (350.0, 1600.0, "nm"),
    "temperature_c": (0.0, 40.0, "°C"),
    "pressure_hpa": (600.0, 1200.0, "hPa"),
}
_ZERO_C_K = 273.15
_GAS_CONSTANT = 8.314472

_K1, _K2, _K3, _K4, _K5 = 1167.05214528, -724213.167032, -17.0738469401, 12020.8247025, -3232555.03223
_K6, _K7, _K8, _K9, _K10 = 14.9151086135, -4823.26573616, 405113.405421, -0.238555575678, 650.175348448
_TRIPLE_POINT_K = 273.16
_TRIPLE_POINT_PA = 611.657


def refractive_index(
    wavelength_vacuum_nm: ArrayLike,
    temperature_c: ArrayLike,
    pressure_hpa: ArrayLike,
    humidity_percent: ArrayLike,
    co2_ppm: ArrayLike = 450.0,
    formula: Formula = "ciddor",
) -> Floats:
    """Return the refractive index of moist air.

    Args:
        wavelength_vacuum_nm: vacuum wavelength of the light, nm.
        temperature_c: temperature of the air, °C.
        pressure_hpa: pressure of the air, hPa.
        humidity_percent: relative humidity, %.
        co2_ppm: carbon dioxide, ppm; the Edlén formula has 450 built in and does not look at it.
        formula: `ciddor` or `edlen` (the modified equation of the NIST).

    Raises:
        ArgumentError: an input that no air has, or an unknown formula; the text names it.
    """
    require_one_of(Formula, formula, "formula")
    given = (wavelength_vacuum_nm, temperature_c, pressure_hpa, humidity_percent, co2_ppm)
    arrays = [np.asarray(value, dtype=np.float64) for value in given]
    for (name, limits), values in zip(_PHYSICAL.items(), arrays, strict=True):
        _require(name, values, limits)
    wavelength, temperature, pressure, humidity, co2 = arrays
    square = (1000.0 / wavelength) ** 2
    vapour_pa = humidity / 100.0 * vapour_pressure_pa(temperature)
    if not np.all(vapour_pa < 100.0 * pressure):
        raise ArgumentError(
            "the vapour pressure exceeds the pressure of the air: check the units of the pressure"
        )
    if formula == "ciddor":
        return _ciddor(square, temperature, 100.0 * pressure, vapour_pa, co2)
    return _edlen(square, temperature, 100.0 * pressure, vapour_pa)


def outside_nist_range(wavelength_vacuum_nm: float, temperature_c: float, pressure_hpa: float) -> str | None:
    """Return in what way the range for which the NIST states its uncertainties is left, None inside of it."""
    for (name, (low, high, unit)), value in zip(
        _NIST.items(), (wavelength_vacuum_nm, temperature_c, pressure_hpa), strict=True
    ):
        if not low <= value <= high:
            return f"{name} = {value:g} {unit} lies outside of {low:g}...{high:g} {unit}"
    return None


def vapour_pressure_pa(temperature_c: ArrayLike) -> Floats:
    """Return the saturation pressure of water vapour (IAPWS), Pa: over ice below 0 °C, over water from there on."""
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


def compensated_mm(vacuum_mm: float, n_now: float, n_zero: float, dead_path_mm: float) -> float:
    """Return the displacement since the zero.

    The instrument counts n·(D + L) − n₀·D in vacuum wavelengths. Dividing by n alone would leave the change of
    the air along the dead path D in the displacement L.

    Args:
        vacuum_mm: displacement as counted, in vacuum wavelengths, mm.
        n_now: refractive index of the air now.
        n_zero: the same at the zero.
        dead_path_mm: length of the beam at the zero, mm.

    Raises:
        ArgumentError: a refractive index is not positive.
    """
    require_positive(n_now, "n_now")
    require_positive(n_zero, "n_zero")
    return vacuum_mm / n_now - dead_path_mm * (n_now - n_zero) / n_now


def _require(name: str, values: Floats, limits: tuple[float, float, str]) -> None:
    low, high, unit = limits
    # Written so that a number that is none fails as well.
    inside: Bools = (values >= low) & (values <= high)
    if not inside.all():
        wrong = float(values[~inside].flat[0]) if values.ndim else float(values)
        raise ArgumentError(f"{name} = {wrong:g}: air has {low:g}...{high:g} {unit}; check sensor and units")


def _ciddor(square: Floats, t: Floats, p: Floats, vapour_pa: Floats, co2: Floats) -> Floats:
    """Return Ciddor's index; square: of the wave number in 1/µm; t in °C; pressures in Pa; co2 in ppm."""
    kelvin = t + _ZERO_C_K
    fraction = (1.00062 + 3.14e-8 * p + 5.6e-7 * t**2) * vapour_pa / p
    dry_mass = 0.0289635 + 1.2011e-8 * (co2 - 400.0)
    dry_standard = 1e-8 * (5792105.0 / (238.0185 - square) + 167917.0 / (57.362 - square))
    dry_standard = dry_standard * (1.0 + 5.34e-7 * (co2 - 450.0))
    wet_standard = 1.022e-8 * (295.235 + square * (2.6422 + square * (-0.032380 + square * 0.004028)))
    virial = 1.58123e-6 + t * (-2.9331e-8 + t * 1.1043e-10)
    virial = virial + (5.707e-6 - 2.051e-8 * t) * fraction + (1.9898e-4 - 2.376e-6 * t) * fraction**2
    ratio = p / kelvin
    compressibility = 1.0 - ratio * virial + ratio**2 * (1.83e-11 - 0.765e-8 * fraction**2)
    moles = p / (compressibility * _GAS_CONSTANT * kelvin)
    dry_density_standard = 101325.0 * dry_mass / (0.9995922115 * _GAS_CONSTANT * 288.15)
    dry = (1.0 - fraction) * moles * dry_mass / dry_density_standard
    wet = fraction * moles * 0.018015 / 0.00985938
    return np.asarray(1.0 + dry * dry_standard + wet * wet_standard, dtype=np.float64)


def _edlen(square: Floats, t: Floats, p: Floats, vapour_pa: Floats) -> Floats:
    """Return the modified Edlén index; square: of the wave number in 1/µm; t in °C; pressures in Pa."""
    standard = 1e-8 * (8342.54 + 2406147.0 / (130.0 - square) + 15998.0 / (38.9 - square))
    density = (1.0 + 1e-8 * (0.601 - 0.00972 * t) * p) / (1.0 + 0.003661 * t)
    dry = 1.0 + p * standard * density / 96095.43
    wet = 1e-10 * (292.75 / (t + _ZERO_C_K)) * (3.7345 - 0.0401 * square) * vapour_pa
    return np.asarray(dry - wet, dtype=np.float64)
