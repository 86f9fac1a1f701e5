"""The line counter's dialect (sheet `interferometers`, section 9)."""

import re
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.simulators.counter.line_protocol import CounterSession
from catseye.simulators.world.bench import Bench
from catseye.simulators.world.instrument import Instrument
from catseye.simulators.world.scara.arm import scara_bench
from tests.unit.simulators.benches import QUIET, aimed, go, perfect_arm, quiet_bench, without_j4_play

VALUE = re.compile(r"^(?P<ch>[A-Z0-9]*)\s*(?P<val>[+-]?\s*\d+(?:[.,]\d+)?(?:[Ee][+-]?\d+)?)\s*(?P<unit>\S*)")


def talk(session: CounterSession, data: bytes) -> list[str]:
    session.feed(data)
    said: list[str] = []
    while (answer := session.answer()) is not None:
        assert isinstance(answer, bytes)
        said += answer.decode().split("\r\n")[:-1]
    return said


@pytest.fixture
def bench() -> Bench:
    bench = quiet_bench()
    go(bench, aimed(20.0, 30.0))
    return bench


@pytest.fixture
def counter(bench: Bench) -> CounterSession:
    return CounterSession(Instrument(bench), lambda _line: None)


def test_it_says_that_it_is_an_emulator(counter: CounterSession) -> None:
    assert talk(counter, b"I\r\n") == ["CATSEYE LINE COUNTER EMULATOR 1.0"]


def test_zero_reads_zero_and_a_move_is_counted(bench: Bench, counter: CounterSession) -> None:
    assert talk(counter, b"Z\r\n") == ["OK"]
    assert talk(counter, b"R\r\n") == ["+000000.000000 mm"]
    before_mm = bench.true_state().length_mm
    go(bench, aimed(20.01, 30.01))
    (line,) = talk(counter, b"R\r\n")
    found = VALUE.match(line)
    assert found is not None
    assert found["ch"] == ""
    assert found["unit"] == "mm"
    assert float(found["val"]) == pytest.approx(bench.true_state().length_mm - before_mm, abs=1e-6)
    assert re.fullmatch(r"[+-]\d{6}\.\d{6} mm", line)


def test_status_bits(bench: Bench, counter: CounterSession) -> None:
    talk(counter, b"Z\r\n")
    # Bit 4: laser ready.
    assert talk(counter, b"S\r\n") == ["10"]
    bench.beam.block(1.0)
    assert talk(counter, b"S\r\n") == ["15"]
    assert talk(counter, b"L\r\nZ\r\n") == ["000", "E03"]
    bench.advance(1.1)
    # The beam is back, the break stays latched; C does not clear it.
    assert talk(counter, b"S\r\nC\r\nS\r\n") == ["11", "OK", "11"]
    assert talk(counter, b"Z\r\nS\r\n") == ["OK", "10"]


def test_the_signal_is_a_percentage(counter: CounterSession) -> None:
    (line,) = talk(counter, b"L\r\n")
    assert re.fullmatch(r"\d{3}", line)
    assert 97 <= int(line) <= 100


def test_velocity_is_answered(bench: Bench, counter: CounterSession) -> None:
    bench.advance(0.1)
    assert talk(counter, b"V\r\n") == ["+000000.000000 mm/s"]


@pytest.mark.parametrize("end", [b"\r", b"\n", b"\r\n"])
def test_any_terminator_ends_a_line(counter: CounterSession, end: bytes) -> None:
    assert talk(counter, b"I" + end + b"L" + end)[0].endswith("EMULATOR 1.0")


@pytest.mark.parametrize("line", [b"X", b"r", b"RR", b"B0", b"B60001", b"B", b"\xff\x00"])
def test_what_is_not_understood_is_an_error(counter: CounterSession, line: bytes) -> None:
    assert talk(counter, line + b"\r\n") == ["E01"]


def test_an_overlong_line_is_an_error_once(counter: CounterSession) -> None:
    assert talk(counter, b"R" * 65 + b"\r\nI\r\n")[0] == "E02"
    assert talk(counter, b"R" * 5000) == []
    assert talk(counter, b"\r\n") == ["E02"]


def test_the_echo_repeats_the_request(counter: CounterSession) -> None:
    assert talk(counter, b"E1\r\nC\r\nE0\r\nC\r\n") == ["OK", "C", "OK", "E0", "OK", "OK"]


def test_continuous_output_follows_bench_time(bench: Bench, counter: CounterSession) -> None:
    assert counter.next_output_s() is None
    assert talk(counter, b"B100\r\n") == ["OK"]
    due_s = counter.next_output_s()
    assert due_s == pytest.approx(bench.time_s + 0.1)
    assert counter.output() == b""
    bench.advance(0.1)
    assert VALUE.match(counter.output().decode())
    assert counter.next_output_s() == pytest.approx(bench.time_s + 0.1)
    assert talk(counter, b"S\r\n")[0][1] in "89ABCDEF"
    # After a long pause the missed values are left out.
    bench.advance(10.03)
    assert counter.output() != b""
    assert counter.output() == b""
    assert talk(counter, b"H\r\n") == ["OK"]
    assert counter.next_output_s() is None


STREAM = b"I\r\nE1\r\nC\nX\r\n\r\nE0\rH\r\n" + b"Q" * 80 + b"\r\nC\r\n"


@given(st.lists(st.integers(0, len(STREAM)), max_size=8))
def test_any_cut_of_a_stream_gives_the_same_answers(cuts: list[int]) -> None:
    config = without_j4_play(QUIET)
    bench = scara_bench(perfect_arm(), config)
    whole = talk(CounterSession(Instrument(bench), lambda _line: None), STREAM)
    session = CounterSession(Instrument(bench), lambda _line: None)
    places = [0, *sorted(cuts), len(STREAM)]
    parts = [STREAM[a:b] for a, b in pairwise(places)]
    assert [line for part in parts for line in talk(session, part)] == whole
    assert whole[-2:] == ["E02", "OK"]


@given(st.binary(max_size=300))
def test_random_bytes_never_raise(data: bytes) -> None:
    session = CounterSession(
        Instrument(scara_bench(perfect_arm(), without_j4_play(QUIET))), lambda _line: None
    )
    talk(session, data)
    assert talk(session, b"\r\nH\r\n")[-1] == "OK"
