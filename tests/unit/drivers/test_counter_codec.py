"""Lines, numbers and bits of counters."""

import math
import re
from collections.abc import Sequence
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.counter import codec
from catseye.drivers.counter.codec import LineDecoder
from catseye.drivers.counter.profile import CounterProfile, Scale, Status, load_profile
from catseye.drivers.roles.errors import ProtocolError

DEFAULT = load_profile("default")


def with_line(**line: object) -> CounterProfile:
    return CounterProfile.model_validate(DEFAULT.model_dump() | {"line": DEFAULT.line.model_dump() | line})


def decode(chunks: Sequence[bytes], profile: CounterProfile = DEFAULT, echo: str = "") -> str | None:
    decoder = LineDecoder(profile, echo)
    for chunk in chunks:
        if line := decoder.feed(chunk):
            return line
    return None


@pytest.mark.parametrize("end", [b"\r\n", b"\r", b"\n", b"\r\n\r\n"])
def test_lines_end_in_cr_lf_or_both(end: bytes) -> None:
    """Sheet, section 9: eol_rx CR LF, accept CR, LF."""
    assert decode([b"+000012.345678 mm" + end]) == "+000012.345678 mm"


@given(
    text=st.from_regex(r"\A[+-][0-9]{6}\.[0-9]{6} mm\Z"),
    end=st.sampled_from([b"\r\n", b"\r", b"\n"]),
    cuts=st.lists(st.integers(0, 20), max_size=8),
)
def test_any_split_gives_the_same_line(text: str, end: bytes, cuts: list[int]) -> None:
    data = b"\r\n" + text.encode() + end
    edges = [0, *sorted({cut % len(data) for cut in cuts}), len(data)]
    assert decode([data[a:b] for a, b in pairwise(edges)]) == text


@given(st.lists(st.binary(max_size=30), max_size=10))
def test_garbage_raises_nothing_but_protocol_errors(chunks: list[bytes]) -> None:
    try:
        line = decode(chunks)
    except ProtocolError:
        return
    assert line is None or line.isprintable()


def test_a_line_without_end_is_refused_and_memory_is_bounded() -> None:
    decoder = LineDecoder(DEFAULT)
    assert decoder.feed(b"1" * codec.MAX_LINE_BYTES) is None
    with pytest.raises(ProtocolError, match="does not end"):
        decoder.feed(b"1")


def test_the_echo_of_a_command_is_skipped_once() -> None:
    assert decode([b"R\r\n", b"R\r\n"], echo="R") == "R"
    assert decode([b"R\r\n1.5 mm\r\n"], echo="R") == "1.5 mm"


def test_ack_and_nak_come_without_line_end() -> None:
    """Sheet, section 6: ACK 06, NAK 15 (Heidenhain)."""
    assert decode([b"\x06"]) == "ACK"
    assert decode([b"\x15"]) == "NAK"


def test_stx_is_dropped() -> None:
    """Sheet, sections 6 and 9: STX, sign and digits, CR LF."""
    assert decode([b"\x02-  12.3456\r\n"]) == "-  12.3456"


def test_bytes_behind_a_line_are_handed_back() -> None:
    decoder = LineDecoder(DEFAULT)
    assert decoder.feed(b"1.5 mm\r\n2.5 mm\r\n") == "1.5 mm"
    assert decoder.rest == b"\n2.5 mm\r\n"


def test_the_encoding_is_the_profiles() -> None:
    assert decode(["1.5 µm\r\n".encode()], with_line(encoding="utf-8")) == "1.5 µm"
    with pytest.raises(ProtocolError, match="is not a ascii text"):
        decode(["1.5 µm\r\n".encode()])
    with pytest.raises(ProtocolError, match="control characters"):
        decode([b"1\x07\r\n"])


def test_silence_never_ends_a_line() -> None:
    decoder = LineDecoder(DEFAULT)
    decoder.feed(b"1.5")
    assert not decoder.may_end
    with pytest.raises(ProtocolError):
        decoder.end()


@pytest.mark.parametrize(
    ("text", "value", "unit"),
    [
        ("+000012.345678 mm", 12.345678, "mm"),
        ("-0.5", -0.5, ""),
        ("123.4", 123.4, ""),
        ("1,25 mm", 1.25, "mm"),
        ("-  12.3456", -12.3456, ""),
        ("+1.5E-3 mm", 0.0015, "mm"),
    ],
)
def test_values_of_the_default_profile(text: str, value: float, unit: str) -> None:
    assert codec.parse_value(DEFAULT.query.reply, text) == (value, unit)


@pytest.mark.parametrize("text", ["", "E01", "mm", "1.5.5", "F012.345", "1E999"])
def test_what_is_no_value(text: str) -> None:
    with pytest.raises(ProtocolError):
        codec.parse_value(DEFAULT.query.reply, text)


@given(st.text(max_size=30))
def test_value_parser_raises_nothing_but_protocol_errors(text: str) -> None:
    try:
        value, _ = codec.parse_value(DEFAULT.query.reply, text)
    except ProtocolError:
        return
    assert math.isfinite(value)


@pytest.mark.parametrize(
    ("scale", "number", "length_mm"),
    [
        (Scale(unit="mm"), 1.5, 1.5),
        (Scale(unit="um"), 1500.0, 1.5),
        (Scale(unit="nm"), 1.5e6, 1.5),
        (Scale(unit="inch"), 1.0, 25.4),
        (Scale(unit="mm", sign=-1), 1.5, -1.5),
        # Sheet, section 1: λ/8 of 632.99 nm is 79.1 nm, a usual count.
        (Scale(unit="count", count_mm=632.99e-6 / 8), 8.0, 632.99e-6),
    ],
)
def test_scales(scale: Scale, number: float, length_mm: float) -> None:
    assert codec.length_mm(number, scale) == pytest.approx(length_mm, rel=1e-15)


@pytest.mark.parametrize("word", ["mm", "MM", ""])
def test_the_unit_that_is_shown_may_be_the_profiles(word: str) -> None:
    assert codec.check_unit(word, Scale(unit="mm")) is None  # type: ignore[func-returns-value]  # nothing is what it returns


@pytest.mark.parametrize(("word", "unit"), [("in", "mm"), ("um", "mm"), ("µm", "nm"), ("deg", "mm")])
def test_another_unit_is_refused(word: str, unit: str) -> None:
    with pytest.raises(ProtocolError, match=f"shows '{word}', the profile says unit = '{unit}'"):
        codec.check_unit(word, Scale.model_validate({"unit": unit}))


def test_both_signs_for_micro_are_understood() -> None:
    for micro in ("\u00b5m", "\u03bcm"):
        codec.check_unit(micro, Scale(unit="um"))
        with pytest.raises(ProtocolError):
            codec.check_unit(micro, Scale(unit="mm"))


@given(count=st.integers(-(2**40), 2**40), step=st.integers(-(2**23) + 1, 2**23 - 1))
def test_a_wrapped_count_goes_on(count: int, step: int) -> None:
    """Any step of less than half the range is followed, whether the counter shows signed or unsigned numbers."""
    shown = (count + step) % 2**24
    assert codec.unwrap(shown, count, 24) == count + step
    assert codec.unwrap(shown - 2**24, count, 24) == count + step


def test_status_bits_of_the_dialect() -> None:
    """Two hex digits: bit 0 lost, 1 overspeed, 2 absent, 4 laser ready."""
    assert DEFAULT.status
    assert codec.parse_bits(DEFAULT.status, "10") == {
        "beam_lost": False,
        "overspeed": False,
        "beam_absent": False,
        "laser_ready": True,
    }
    assert codec.parse_bits(DEFAULT.status, "07") == {
        "beam_lost": True,
        "overspeed": True,
        "beam_absent": True,
        "laser_ready": False,
    }


def test_status_bits_may_be_decimal_inverted_and_missing() -> None:
    status = Status.model_validate(
        {
            "command": "?Q",
            "reply": r"Q(?P<bits>\d+)",
            "radix": 10,
            "bits": {"beam_lost": 3, "laser_ready": 0},
            "inverted": ["laser_ready"],
        }
    )
    assert codec.parse_bits(status, "Q9") == {"beam_lost": True, "laser_ready": False}
    assert codec.parse_bits(status, "Q0") == {"beam_lost": False, "laser_ready": True}
    with pytest.raises(ProtocolError):
        codec.parse_bits(status, "E01")


@pytest.mark.parametrize("decoder", [codec.LineDecoder, codec.StreamDecoder])
def test_a_flood_of_empty_lines_is_skipped_at_once(
    decoder: type[codec.LineDecoder | codec.StreamDecoder], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each one looked at by itself holds the event loop, and a STOP, for long."""
    looked: list[bytes | str] = []
    search = re.search

    def counted(pattern: str, text: str) -> re.Match[str] | None:
        looked.append(text)
        return search(pattern, text)

    monkeypatch.setattr(re, "search", counted)
    assert not decoder(load_profile("default")).feed(b"\r\n" * 8192)
    assert len(looked) < 3
