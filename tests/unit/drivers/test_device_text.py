"""What an instrument says never commands the terminal that shows it."""

import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.melfa.texts import LogEntry, ProgramEntry
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import AlarmError, DeviceError, LinkError, ProtocolError, RefusedError
from catseye.drivers.roles.interferometer import BeamStatus, LengthReading
from catseye.drivers.roles.robot import RobotStatus
from catseye.drivers.roles.text import LONGEST, harmless, harmless_lines

HOSTILE = "\x1b]0;owned\x07\x9b31m\u202eesrever\u2028two\n\r\x00\x7f\ud800\u200b"


def test_each_command_stands_as_its_escape() -> None:
    assert harmless("a\x1b[31m\x9bb\u202ec\nd\ud800") == r"a\x1b[31m\x9bb\u202ec\nd\ud800"


def test_lines_and_tabs_stay_and_commands_do_not() -> None:
    assert (
        harmless_lines("a\tb\nc\x1b[2J\r\x9b" + "d" * LONGEST) == "a\tb\nc" + r"\x1b[2J\r\x9b" + "d" * LONGEST
    )


def test_plain_words_stay_as_they_are() -> None:
    assert harmless("RH-3FRH5515 (CR750-D) 20 °C µm ü 日本") == "RH-3FRH5515 (CR750-D) 20 °C µm ü 日本"


@given(st.text(st.characters(codec=None), max_size=2 * LONGEST))
def test_any_text_is_printable_and_bounded(text: str) -> None:
    shown = harmless(text)
    assert shown.isprintable()
    assert len(shown) <= LONGEST
    assert harmless(shown) == shown


@pytest.mark.parametrize(
    "report",
    [
        Identity(HOSTILE, HOSTILE, HOSTILE, True),
        RobotStatus(True, False, True, False, False, 10.0, 7, HOSTILE, HOSTILE),
        LengthReading(1.0, HOSTILE, 0.0),
        BeamStatus(True, False, False, True, 1.0, HOSTILE),
        ProgramEntry(HOSTILE, 1, HOSTILE, 1, 1),
        LogEntry(HOSTILE, 1, HOSTILE, HOSTILE, HOSTILE, HOSTILE, HOSTILE),
    ],
    ids=lambda report: type(report).__name__,
)
def test_values_of_instruments_are_harmless(report: object) -> None:
    texts = [value for value in vars(report).values() if isinstance(value, str)]
    assert texts
    assert all(text.isprintable() and "owned" in text for text in texts)


@pytest.mark.parametrize("kind", [DeviceError, LinkError, ProtocolError])
def test_errors_of_drivers_are_harmless(kind: type[DeviceError]) -> None:
    assert str(kind(f"it said {HOSTILE}")).isprintable()
    assert str(pickle.loads(pickle.dumps(kind(HOSTILE)))).isprintable()


@pytest.mark.parametrize("kind", [RefusedError, AlarmError])
def test_refusals_of_instruments_are_harmless(kind: type[RefusedError]) -> None:
    error = kind(f"it said {HOSTILE}", 7)
    assert str(error).isprintable()
    assert error.number == 7


def test_a_long_error_is_bounded() -> None:
    assert len(str(DeviceError("x" * 100_000))) == 2000
