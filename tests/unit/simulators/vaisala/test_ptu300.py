"""The emulated PTU300 against the manual's examples."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.simulators.vaisala.ptu300 import Ptu300, Ptu300Session
from catseye.simulators.world.air import AirSample
from catseye.simulators.world.air_probe import AirFault, AirProbe
from tests.transcripts import vaisala_ptu300 as transcript
from tests.transcripts.vaisala_ptu300 import DEFAULT_LINE, FORMATS, READINGS
from tests.unit.simulators.benches import quiet_bench


class FixedProbe(AirProbe):
    """Measures what a test has set."""

    def __init__(self, pressure_hpa: float, temperature_c: float, humidity_percent: float) -> None:
        super().__init__(quiet_bench())
        self._air = AirSample(temperature_c, pressure_hpa, humidity_percent)

    def sample(self) -> AirSample | None:
        return None if self.fault.missing else self._air


def sensor(probe: AirProbe | None = None) -> Ptu300:
    return Ptu300(probe or FixedProbe(1013.2, 31.1, 38.3), quiet_bench())


def say(session: Ptu300Session, *lines: str) -> str:
    session.feed("".join(f"{line}\r" for line in lines).encode())
    said = b""
    while (answer := session.answer()) is not None:
        assert isinstance(answer, bytes)
        said += answer
    return said.decode()


def opened(device: Ptu300 | None = None) -> Ptu300Session:
    return Ptu300Session(device or sensor(), lambda _text: None)


def test_the_default_line_is_the_manuals() -> None:
    assert say(opened(), "SEND") == f"{DEFAULT_LINE}\r\n"


@pytest.mark.parametrize("text", FORMATS)
def test_formats_of_the_manual(text: str) -> None:
    *air, units = READINGS[text]
    pressure, temperature, humidity = (float(value) for value in air)
    session = opened(sensor(FixedProbe(pressure, temperature, humidity)))
    said = say(session, "unit m" if units == "metric" else "unit n", f"form {text}", "send")
    *_, accepted, line = said.splitlines()
    assert accepted == "OK"
    assert re.sub(r"\s+", " ", line).strip() == FORMATS[text]


def test_the_format_is_escaped_and_reset_by_a_slash() -> None:
    session = opened()
    said = say(session, 'FORM "x" #r #n', "FORM ?", "SEND", "FORM /", "SEND")
    assert said == f'OK\r\nOutput format  :"x" \\r \\n\r\nx\r\nOK\r\n{DEFAULT_LINE}\r\n'


def test_checksums_are_of_what_was_sent_so_far() -> None:
    session = opened()
    assert say(session, 'FORM "AB" CS2 " " CSX', "SEND") == "OK\r\nAB83 28\r\n"
    assert say(session, 'FORM "zzz" CS4', "SEND") == "OK\r\nzzz016E\r\n"


def test_missing_values_are_asterisks() -> None:
    device = sensor()
    device.probe.fault = AirFault(missing=True)
    said = say(opened(device), "SEND", "ERRS")
    assert said == "P=******* hPa T=***** 'C RH=***** %RH\r\nFAIL\r\n"


def test_units_of_the_pressure() -> None:
    session = opened()
    assert say(session, "UNIT P kPa").strip().endswith("kPa")
    assert say(session, "SEND").startswith("P=  101.3 kPa")
    assert say(session, "UNIT P parsec") == "Unknown unit\r\n"
    assert "Output units" in say(session, "UNIT")


def test_the_settings_list_runs_from_model_to_second_module() -> None:
    lines = say(opened(), "?").splitlines()
    assert re.fullmatch(r"PTU300 / \d+\.\d+", lines[0])
    assert lines[-1].startswith("Module 2")
    assert any(line.startswith("Serial number") for line in lines)
    assert "EMULATOR" in "\n".join(lines)


def test_one_address_is_answered_only() -> None:
    device = sensor()
    device.address = 3
    assert say(opened(device), "SEND 4") == ""
    assert say(opened(device), "SEND 3") == f"{DEFAULT_LINE}\r\n"
    assert say(opened(device), "OPEN 3", "CLOSE").splitlines() == [
        "PTU300: 1 line opened for operator commands",
        "line closed",
    ]


def test_continuous_output_comes_in_bench_time() -> None:
    device = sensor()
    session = opened(device)
    say(session, "INTV 2 s", "R")
    assert session.next_output_s() == device.bench.time_s
    assert session.output().decode() == f"{DEFAULT_LINE}\r\n"
    assert session.output() == b""
    device.bench.advance(7.0)
    assert session.output()
    assert session.next_output_s() == pytest.approx(device.bench.time_s + 1.0)
    say(session, "S")
    assert session.next_output_s() is None


def test_echo_and_prompt_come_on_demand() -> None:
    session = opened()
    say(session, "ECHO ON")
    assert say(session, "SNUM") == "SNUM\r\nSerial number  : EMU00001\r\n>"


@pytest.mark.parametrize("text", ["FORM nonsense", 'FORM "open', "FORM U3", "FORM " + "P " * 150, "WHAT"])
def test_what_it_does_not_understand_it_says(text: str) -> None:
    session = opened()
    assert re.match(r"Format error|Unknown command", say(session, text))
    assert say(session, "SEND") == f"{DEFAULT_LINE}\r\n"


@given(junk=st.binary(max_size=800))
def test_random_bytes_leave_it_working(junk: bytes) -> None:
    session = opened()
    session.feed(junk)
    say(session, "")
    assert say(session, "ECHO OFF", "FORM /", "UNIT M", "UNIT P hPa", "SEND").endswith(f"{DEFAULT_LINE}\r\n")


@pytest.mark.parametrize(
    ("form", "line"),
    [
        ("ERR", "0000"),
        ("OK", "OK"),
        ("STAT", "N 0    "),
        ("A3H", "*"),
        ("DATE", "2026-01-01"),
        ("TIME", "00:00:00"),
        ('4.1 P1 "/" P2 "/" P3h U4', "1013.2/******/******hPa "),
    ],
)
def test_modifiers_of_table_30(form: str, line: str) -> None:
    assert say(opened(), f"FORM {form} #r #n", "SEND") == f"OK\r\n{line}\r\n"


def test_flags_of_a_missing_value() -> None:
    probe = FixedProbe(1013.2, 31.1, 38.3)
    probe.fault = AirFault(missing=True)
    session = opened(sensor(probe))
    assert say(session, 'FORM ERR "/" OK #r #n', "SEND") == "OK\r\n1111/  \r\n"


def test_the_clock_follows_the_bench() -> None:
    device = sensor()
    device.bench.advance(3661.0)
    assert say(opened(device), "FORM TIME #r #n", "SEND").endswith("01:01:01\r\n")


def test_msl_equipment_finds_its_words() -> None:
    session = opened()
    assert say(session, "S") == ""
    first, *others = say(session, "?").splitlines()
    assert first.split(" / ")[0] == "PTU300"
    keys = [line.split(": ")[0].strip() for line in others]
    assert "Serial number" in keys
    assert keys[-1] == "Module 2"
    for command, answer in transcript.MSL_ANSWERS.items():
        assert say(session, command) == f"{answer}\r\n"
    assert say(session, f"FORM {transcript.MSL_FORMAT}") == "OK\r\n"
    shown = say(session, "FORM ?").strip().removeprefix("Output format  :").replace("\\", "#")
    assert shown == transcript.MSL_FORMAT
    assert re.fullmatch(r"1013\.200 \*{8}  31\.100  38\.300\r\n", say(session, "SEND"))


def test_the_line_of_another_address_stays_closed() -> None:
    assert say(opened(), "OPEN 5") == ""
    assert "opened" in say(opened(), "OPEN 0")
