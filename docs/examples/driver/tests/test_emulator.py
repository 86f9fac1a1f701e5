"""The emulator and the manual's lines."""

import pytest
from norra_ld5.emulator import Display
from transcript import POSITION, STATUS, STATUS_LOST, UNKNOWN, ZERO, ZERO_REFUSED


def displays(exchange):
    """Return the request and the answer of an exchange as text."""
    return tuple(part.decode().rstrip() for part in exchange)


@pytest.mark.parametrize("exchange", [POSITION, STATUS, UNKNOWN])
def test_answers_are_the_manuals(exchange):
    display = Display()
    display.length_mm = -12.345678
    request, answer = displays(exchange)
    assert display.answer(request) == answer


def test_the_identity_says_that_it_is_an_emulator():
    assert Display().answer("ID") == "IDNORRA LD5 EMULATOR,1.04,00217"


def test_a_lost_beam_stays_lost_until_a_zero():
    display = Display()
    display.interrupt()
    assert display.answer("1TS") == displays(STATUS_LOST)[1]
    assert display.answer("1ZR") == displays(ZERO_REFUSED)[1]
    display.restore()
    assert display.answer("1TS") == "1TS1,1,0,1,080"
    assert display.answer("1ZR") == displays(ZERO)[1]
    assert display.answer("1TS") == displays(STATUS)[1]
