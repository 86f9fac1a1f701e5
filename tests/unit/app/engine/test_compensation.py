"""Lengths are corrected for the air once: by the instrument or by the program."""

import pytest

from catseye.app.cell.model import Air
from catseye.app.engine.compensation import Compensation
from catseye.app.errors import MeasurementRejectedError
from catseye.calibration.air import compensated_mm
from catseye.drivers.roles.air import AirSample

ROOM = AirSample(20.0, 1013.25, 50.0, 0.0)
WARMER = AirSample(25.0, 1013.25, 50.0, 0.0)
N_ROOM, N_WARMER = 1.0002713729, 1.0002666604
"""Ciddor at 632.9908 nm, computed with two independent code bases (sheet of the refractivity, table 2b)."""


def test_the_vacuum_count_becomes_the_length_that_made_it() -> None:
    dead_mm, length_mm = 650.0, 123.456
    counted_mm = N_WARMER * (dead_mm + length_mm) - N_ROOM * dead_mm
    assert compensated_mm(counted_mm, N_WARMER, N_ROOM, dead_mm) == pytest.approx(length_mm, abs=1e-10)


def test_the_program_corrects_what_nobody_has_corrected() -> None:
    compensation = Compensation("none", Air())
    compensation.zeroed(ROOM, 650.0)
    counted_mm = N_WARMER * 773.456 - N_ROOM * 650.0
    found = compensation.correct(counted_mm, WARMER)
    assert found.displacement_mm == pytest.approx(123.456, abs=1e-7)
    assert found.index == pytest.approx(N_WARMER, abs=1e-10)
    assert found.zero is not None
    assert found.zero.dead_path_mm == 650.0
    assert found.formula == "ciddor"
    # Left out, the dead path alone would be worth three micrometres here.
    assert abs(counted_mm / N_WARMER - 123.456) > 3e-3


def test_what_the_instrument_has_corrected_stays_untouched() -> None:
    compensation = Compensation("instrument", Air())
    assert compensation.zeroed(ROOM, 650.0) is None
    found = compensation.correct(123.456, AirSample(None, None, None, 0.0))
    assert (found.displacement_mm, found.index, found.zero, found.formula) == (123.456, None, None, None)


@pytest.mark.parametrize(
    ("air", "missing"),
    [
        (AirSample(20.0, None, 50.0, 0.0), "no pressure"),
        (AirSample(None, 1013.25, None, 0.0), "no temperature and no humidity"),
    ],
)
def test_without_the_air_nothing_is_measured_in_vacuum_wavelengths(air: AirSample, missing: str) -> None:
    compensation = Compensation("none", Air())
    for refused in (lambda: compensation.zeroed(air, 650.0), lambda: compensation.correct(1.0, air)):
        with pytest.raises(MeasurementRejectedError, match=missing):
            refused()


def test_air_that_cannot_be_is_refused() -> None:
    with pytest.raises(MeasurementRejectedError, match="pressure_hpa = 101325"):
        Compensation("none", Air()).correct(1.0, AirSample(20.0, 101325.0, 50.0, 0.0))


def test_one_sentence_says_who_corrects() -> None:
    assert Compensation("instrument", Air()).sentence == (
        "The instrument corrects its lengths for the air; the program adds nothing to them, neither an index nor a "
        "dead-path term."
    )
    assert Compensation("none", Air(co2_ppm=420.0)).sentence == (
        "The program corrects the lengths for the air: Ciddor, 420 ppm CO2, vacuum wavelength 632.9908 nm, "
        "dead path = planned length of the beam at each zero."
    )
    assert "modified Edlén, vacuum" in Compensation("none", Air(formula="edlen")).sentence


def test_doubts_about_the_air_are_reported() -> None:
    assert Compensation("instrument", Air()).doubt(ROOM) is None
    dry = AirSample(20.0, None, 50.0, 0.0)
    assert "gives no pressure" in (Compensation("instrument", Air()).doubt(dry) or "")
    cold = AirSample(-5.0, 1013.25, 50.0, 0.0)
    assert "temperature_c = -5" in (Compensation("none", Air()).doubt(cold) or "")
    assert Compensation("instrument", Air()).doubt(cold) is None
