"""Refractive index of moist air: Ciddor (1996) and modified Edlén, with the constants of the NIST toolbox.

Input is the vacuum wavelength. All functions are pure and take numbers or arrays that broadcast.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.vapour_pressure import vapour_pressure_pa

Formula = Literal["ciddor", "edlen"]

HE_NE_VACUUM_NM = 632.9908
"""Vacuum wavelength of an unstabilised helium-neon laser (mise en pratique: ±1.5e-6, k = 1), nm."""

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


@dataclass(frozen=True)
class AirUncertainty:
    """Standard uncertainties (k = 1) of what the index follows from.

    Attributes:
        temperature_k: of the temperature, K.
        pressure_hpa: of the pressure, hPa.
        humidity_percent: of the relative humidity, %.
        co2_ppm: of the carbon dioxide content, ppm.
        formula: of the formula itself, as a part of 1.
    """

    temperature_k: float
    pressure_hpa: float
    humidity_percent: float
    co2_ppm: float = 50.0
    formula: float = 2e-8


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
        ValueError: an input that no air has; the text names it.
    """
    given = (wavelength_vacuum_nm, temperature_c, pressure_hpa, humidity_percent, co2_ppm)
    arrays = [np.asarray(value, dtype=np.float64) for value in given]
    for (name, limits), values in zip(_PHYSICAL.items(), arrays, strict=True):
        _require(name, values, limits)
    wavelength, temperature, pressure, humidity, co2 = arrays
    square = (1000.0 / wavelength) ** 2
    vapour_pa = humidity / 100.0 * vapour_pressure_pa(temperature)
    if not np.all(vapour_pa < 100.0 * pressure):
        raise ValueError(
            "the vapour pressure exceeds the pressure of the air: check the units of the pressure"
        )
    if formula == "ciddor":
        return _ciddor(square, temperature, 100.0 * pressure, vapour_pa, co2)
    if formula == "edlen":
        return _edlen(square, temperature, 100.0 * pressure, vapour_pa)
    raise ValueError(f"formula {formula!r} is unknown: use 'ciddor' or 'edlen'")


def outside_nist_range(wavelength_vacuum_nm: float, temperature_c: float, pressure_hpa: float) -> str | None:
    """Return in what way the range for which the NIST states its uncertainties is left, None inside of it.

    Args:
        wavelength_vacuum_nm: vacuum wavelength, nm.
        temperature_c: temperature, °C.
        pressure_hpa: pressure, hPa.
    """
    for (name, (low, high, unit)), value in zip(
        _NIST.items(), (wavelength_vacuum_nm, temperature_c, pressure_hpa), strict=True
    ):
        if not low <= value <= high:
            return f"{name} = {value:g} {unit} lies outside of {low:g}...{high:g} {unit}"
    return None


def index_uncertainty(
    u: AirUncertainty,
    wavelength_vacuum_nm: float,
    temperature_c: float,
    pressure_hpa: float,
    humidity_percent: float,
    co2_ppm: float = 450.0,
) -> float:
    """Return the standard uncertainty of the index by Ciddor's sensitivities at one state of the air."""
    state = np.array([temperature_c, pressure_hpa, humidity_percent, co2_ppm])
    steps = np.array([0.01, 0.1, 0.1, 1.0])
    # Humidity is bounded on both sides: the difference is taken inwards of the bounds.
    state[2] = min(max(state[2], steps[2]), 100.0 - steps[2])
    above, below = (state + sign * np.diag(steps) for sign in (1.0, -1.0))
    high, low = (refractive_index(wavelength_vacuum_nm, *rows.T) for rows in (above, below))
    sensitivities = (high - low) / (2.0 * steps)
    parts = sensitivities * (u.temperature_k, u.pressure_hpa, u.humidity_percent, u.co2_ppm)
    return float(np.hypot(np.linalg.norm(parts), u.formula))


def _require(name: str, values: Floats, limits: tuple[float, float, str]) -> None:
    low, high, unit = limits
    # Written so that a number that is none fails as well.
    inside: Bools = (values >= low) & (values <= high)
    if not inside.all():
        wrong = float(values[~inside].flat[0]) if values.ndim else float(values)
        raise ValueError(f"{name} = {wrong:g}: air has {low:g}...{high:g} {unit}; check sensor and units")


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
