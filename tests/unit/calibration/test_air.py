"""The index of air against the published table, independent code bases and published sensitivities."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.calibration.air import (
    Formula,
    outside_nist_range,
    refractive_index,
    vapour_pressure_pa,
)

# NIST Engineering Metrology Toolbox, table 1 (450 ppm): t °C, RH %, p kPa, vacuum wavelength nm, Ciddor, Edlén.
NIST_TABLE = [
    (20, 0, 101.325, 633, 1.000271800, 1.000271799),
    (20, 0, 60, 633, 1.000160924, 1.000160920),
    (20, 0, 120, 633, 1.000321916, 1.000321918),
    (50, 0, 100, 633, 1.000243285, 1.000243270),
    (5, 0, 100, 633, 1.000282756, 1.000282750),
    (-40, 0, 100, 633, 1.000337580, 1.000337471),
    (50, 100, 120, 633, 1.000287924, 1.000287864),
    (40, 75, 120, 633, 1.000299418, 1.000299406),
    (20, 100, 100, 633, 1.000267394, 1.000267394),
    (40, 100, 110, 1700, 1.000270247, 1.000270237),
    (20, 0, 101.325, 1700, 1.000268479, 1.000268483),
    (40, 100, 110, 300, 1.000289000, 1.000288922),
    (20, 0, 101.325, 300, 1.000286581, 1.000286579),
    (-40, 0, 120, 300, 1.000427233, 1.000427072),
]

# ref-index 1.0 and AstroAtmosphere 1.6 at 632.9908 nm: t °C, p hPa, RH %, CO2 ppm, (n - 1) in 1e-10, Ciddor, Edlén.
TWO_CODE_BASES = [
    (20, 1013.25, 0, 450, 2717999, 2717991),
    (20, 1013.25, 50, 450, 2713729, 2713746),
    (20, 1013.25, 50, 400, 2713657, 2713746),
    (20, 1000, 50, 450, 2678173, 2678189),
    (20, 950, 50, 450, 2544004, 2544015),
    (15, 1013.25, 50, 450, 2762134, 2762141),
    (25, 1013.25, 50, 450, 2666604, 2666623),
    (18, 1020, 40, 450, 2751924, 2751937),
    (22, 990, 60, 450, 2631815, 2631832),
    (30, 1013.25, 60, 450, 2619125, 2619131),
    (10, 1013.25, 30, 450, 2812893, 2812875),
    (35, 1013.25, 80, 450, 2569811, 2569756),
    (20, 1013.25, 50, 1000, 2714518, 2713746),
]


@pytest.mark.parametrize("row", NIST_TABLE)
def test_the_table_of_the_nist_to_1e_9(row: tuple[float, ...]) -> None:
    t, rh, kpa, wavelength, ciddor, edlen = row
    assert refractive_index(wavelength, t, 10 * kpa, rh) == pytest.approx(ciddor, abs=1e-9)
    assert refractive_index(wavelength, t, 10 * kpa, rh, formula="edlen") == pytest.approx(edlen, abs=1e-9)


@pytest.mark.parametrize(("column", "formula"), [(4, "ciddor"), (5, "edlen")])
def test_two_other_code_bases_at_the_wavelength_of_the_laser(column: int, formula: Formula) -> None:
    table = np.array(TWO_CODE_BASES)
    n = refractive_index(632.9908, table[:, 0], table[:, 1], table[:, 2], table[:, 3], formula)
    np.testing.assert_allclose(1e10 * (n - 1.0), table[:, column], atol=0.6)


def test_saturation_pressure_over_water() -> None:
    found = vapour_pressure_pa([0.01, 10.0, 20.0, 25.0, 30.0, 40.0])
    np.testing.assert_allclose(found, [611.657, 1228.184, 2339.215, 3169.747, 4246.688, 7384.427], atol=6e-4)


def test_water_and_ice_meet_at_the_triple_point() -> None:
    assert vapour_pressure_pa(-1e-9) == pytest.approx(vapour_pressure_pa(0.0), rel=2e-3)
    assert vapour_pressure_pa(-20.0) == pytest.approx(
        103.24, rel=1e-3
    )  # tables of the IAPWS release over ice


def test_sensitivities_by_differences() -> None:
    def n(t: float = 20.0, p: float = 1013.25, rh: float = 50.0, co2: float = 450.0) -> float:
        return float(refractive_index(633.0, t, p, rh, co2))

    assert (n(t=20.05) - n(t=19.95)) / 0.1 == pytest.approx(-9.548e-7, rel=1e-3)
    assert (n(p=1013.75) - n(p=1012.75)) / 1.0 == pytest.approx(2.683e-7, rel=1e-3)
    assert (n(rh=51.0) - n(rh=49.0)) / 2.0 == pytest.approx(-8.50e-9, rel=2e-3)
    assert (n(co2=500.0) - n(co2=400.0)) / 100.0 == pytest.approx(1.435e-10, rel=2e-3)


@given(t=st.floats(10.0, 35.0), p=st.floats(950.0, 1050.0), rh=st.floats(0.0, 70.0))
def test_the_formulas_agree_in_a_laboratory(t: float, p: float, rh: float) -> None:
    difference = refractive_index(633.0, t, p, rh) - refractive_index(633.0, t, p, rh, formula="edlen")
    assert abs(float(difference)) < 1e-8


@pytest.mark.parametrize(
    ("state", "named"),
    [
        ((0.633, 20.0, 1013.25, 50.0), "wavelength_vacuum_nm"),
        ((633.0, 293.15, 1013.25, 50.0), "temperature_c"),
        ((633.0, 20.0, 101325.0, 50.0), "pressure_hpa"),
        ((633.0, 20.0, 1013.25, 101.0), "humidity_percent"),
        ((633.0, 20.0, 1013.25, math.nan), "humidity_percent"),
        ((633.0, 99.0, 100.0, 100.0), "vapour pressure"),
    ],
)
def test_what_no_air_has_is_refused(state: tuple[float, float, float, float], named: str) -> None:
    with pytest.raises(ValueError, match=named):
        refractive_index(*state)


def test_an_array_with_one_impossible_value_names_it() -> None:
    with pytest.raises(ValueError, match="temperature_c = 120"):
        refractive_index(633.0, [20.0, 120.0], 1013.25, 50.0)


def test_an_unknown_formula_is_refused() -> None:
    with pytest.raises(ValueError, match="ciddor"):
        refractive_index(633.0, 20.0, 1013.25, 50.0, formula="edlen66")  # type: ignore[arg-type]  # on purpose


def test_leaving_the_range_of_the_nist_is_reported() -> None:
    assert outside_nist_range(632.9908, 20.0, 1013.25) is None
    assert "temperature_c = -5" in (outside_nist_range(632.9908, -5.0, 1013.25) or "")
    assert "pressure_hpa = 550" in (outside_nist_range(632.9908, 20.0, 550.0) or "")
    assert "wavelength_vacuum_nm = 1700" in (outside_nist_range(1700.0, 20.0, 1013.25) or "")
