"""Lines of T2SA as the driver reads them (sheet `trackers_ballbar`, section 5)."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.roles.errors import ProtocolError
from catseye.drivers.t2sa import codec
from tests.unit.drivers.outcomes import outcome_of

POINT = "Single Point Measurement P1 result 1500.25,-321.5,88.125 11/26/2026 08:15:30 AM True"
REPORT = "Object Offset Report FrameTOOL_1;X:1.5;Y:-2.25;Z:3;Rx:0.125;Ry:-90;Rz:1e-3;11/26/2026 08:15:30"


def test_a_command_is_a_line() -> None:
    assert codec.encode("?STAT") == b"?STAT\r\n"


cuts = st.lists(st.integers(0, 80), max_size=6)


@given(st.sampled_from(["ACK", "ERR"]), st.integers(0, 999), st.text(alphabet="abc 1.,:;", max_size=40), cuts)
def test_a_line_is_a_reply_however_it_is_cut(kind: str, code: int, text: str, pieces: list[int]) -> None:
    data = f"{kind}-{code:03d} {text}\r\n".encode()
    decoder, found = codec.ReplyDecoder(), None
    places = sorted({min(cut, len(data)) for cut in pieces} | {0, len(data)})
    for start, end in zip(places, [*places[1:], len(data)], strict=True):
        found = found or decoder.feed(data[start:end])
    assert found == codec.Reply(kind == "ACK", code, text.strip())


@given(st.one_of(st.binary(max_size=200), st.binary(max_size=40).map(lambda text: b"ERR-201" + text)))
def test_any_bytes_are_a_reply_or_a_protocol_error(data: bytes) -> None:
    reply = outcome_of(codec.ReplyDecoder().feed, data + b"\n")
    if isinstance(reply, codec.Reply):
        line = f"{'ACK' if reply.ok else 'ERR'}-{reply.code:03d} {reply.text}\n"
        assert codec.ReplyDecoder().feed(line.encode()) == reply


@pytest.mark.parametrize("line", [b"OK\n", b"ACK-12 x\n", b"ACK300 x\n", b"\xff\xfe\n", b"NAK-300 x\n"])
def test_other_lines_are_refused(line: bytes) -> None:
    with pytest.raises(ProtocolError, match="ACK-ddd"):
        codec.ReplyDecoder().feed(line)


def test_a_line_without_end_is_refused() -> None:
    with pytest.raises(ProtocolError, match="does not end"):
        codec.ReplyDecoder().feed(b"A" * 5000)


def test_a_point_of_the_sheet_is_read() -> None:
    assert codec.parse_point(POINT) == codec.Point("P1", (1500.25, -321.5, 88.125), good=True)


@pytest.mark.parametrize(
    "text",
    ["", POINT.replace("True", ""), POINT.replace("-321.5,", ""), POINT.replace("88.125", "x"), "ACK300"],
)
def test_what_tells_no_point_is_refused(text: str) -> None:
    with pytest.raises(ProtocolError, match="no measured point"):
        codec.parse_point(text)


def test_a_report_of_the_sheet_is_read() -> None:
    assert codec.parse_report(REPORT) == ((1.5, -2.25, 3.0), (0.125, -90.0, 0.001))


@pytest.mark.parametrize("text", ["", REPORT.replace("Ry:-90;", ""), REPORT.replace("1e-3", "nan"), POINT])
def test_what_is_no_report_is_refused(text: str) -> None:
    with pytest.raises(ProtocolError, match="no object offset report"):
        codec.parse_report(text)


def test_a_number_beyond_all_bounds_is_refused() -> None:
    with pytest.raises(ProtocolError, match="too large"):
        codec.parse_point(POINT.replace("88.125", "1e999"))


numbers = st.one_of(st.text("0123456789.+-e", max_size=8), st.floats().map(repr), st.just("1e999"))
near_points = st.builds("Single Point Measurement P result {},{},{} True".format, *[numbers] * 3)
near_reports = st.builds("Object Offset Report F;X:{};Y:{};Z:{};Rx:{};Ry:{};Rz:{}".format, *[numbers] * 6)


@given(st.one_of(st.text(max_size=200), near_points))
def test_any_text_is_a_point_that_reads_back_or_refused(text: str) -> None:
    point = outcome_of(codec.parse_point, text)
    if isinstance(point, codec.Point):
        x, y, z = point.place_mm
        again = f"Single Point Measurement {point.name} result {x!r},{y!r},{z!r} {point.good}"
        assert codec.parse_point(again) == point


@given(st.one_of(st.text(max_size=200), near_reports))
def test_any_text_is_a_finite_report_or_refused(text: str) -> None:
    report = outcome_of(codec.parse_report, text)
    if isinstance(report, tuple):
        assert all(math.isfinite(value) for part in report for value in part)


@pytest.mark.parametrize("name", ["a;b", "a:b", "", "a\r\n!LST:2"])
def test_names_cannot_smuggle_commands(name: str) -> None:
    assert not codec.is_name(name)
    assert codec.is_name("nest 1_P2")
