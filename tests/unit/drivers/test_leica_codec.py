"""Packets of emScon as the driver reads and writes them (sheet `trackers_ballbar`, section 1)."""

import struct
from functools import partial
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.leica import codec
from catseye.drivers.leica.commands import status_text
from catseye.drivers.leica.measurement import ResultDecoder, StationaryResult
from catseye.drivers.links.link import Decoder
from catseye.drivers.roles.errors import ProtocolError
from tests.unit.drivers.outcomes import outcome_of

START = 49
POINT = (1500.25, -321.5, 88.125)
SCATTER, A_PRIORI = (0.003, 0.004, 0.012), (0.004, 0.003, 0.005)


def reply(command: int, status: int = 0, data: bytes = b"") -> bytes:
    return struct.pack("<iiii", 16 + len(data), 0, command, status) + data


def single(status: int = 0, mode: int = 0) -> bytes:
    """Return a result of 156 bytes: values, deviations, their total, pointing errors, a-priori ones, air."""
    values = (*POINT, *SCATTER, 0.013, 7.0, 8.0, 9.0, *A_PRIORI, 0.007, 20.0, 1013.0, 50.0)
    return struct.pack("<iiiii17d", 156, 2, status, mode, 0, *values)


def extended() -> bytes:
    """Return the same as a result of 204 bytes, with covariances of either kind."""
    head = (*POINT, *SCATTER, 0.013, 0.1, 0.2, 0.3, 7.0, 8.0, 9.0)
    values = (*head, *A_PRIORI, 0.007, 0.1, 0.2, 0.3, 20.0, 1013.0, 50.0)
    return struct.pack("<iiiii23d", 204, 9, 0, 0, 0, *values)


CHANGED = struct.pack("<iii", 12, 8, 26)
POSITION = struct.pack("<iii3d", 36, 7, 0, 1.0, 2.0, 3.0)
FOREIGN_ERROR = struct.pack("<iiii", 16, 1, 54, 37)
MULTI = struct.pack("<iiiiii3d", 84, 3, 0, 1, 1, 0, 20.0, 1013.0, 50.0) + struct.pack(
    "<iii3d", 0, 1, 2, *POINT
)
NOISE = (CHANGED, POSITION, FOREIGN_ERROR, MULTI)


def test_a_status_request_is_that_of_the_sheet() -> None:
    assert codec.encode(1) == bytes.fromhex("0C 00 00 00 00 00 00 00 01 00 00 00")


def test_sizes_of_commands_are_those_of_the_sheet() -> None:
    assert len(codec.encode(5, "5i", 1, 1, 0, 1, 0)) == 32
    assert len(codec.encode(20, "3d", 20.0, 1013.0, 50.0)) == 36
    assert len(codec.encode(28, "2i", 4000, 1)) == 20
    assert len(codec.encode(43, "di", 25.0, 10_000)) == 24
    assert len(codec.encode(47, "9i", *range(9))) == 48
    assert len(codec.encode(55, "3di", 1.0, 2.0, 3.0, 1)) == 40


def fed(decoder: Decoder[object], data: bytes, cuts: list[int]) -> object:
    """Feed bytes in pieces; return what comes first."""
    places = sorted({min(cut, len(data)) for cut in cuts} | {0, len(data)})
    for start, end in pairwise(places):
        if (found := decoder.feed(data[start:end])) is not None:
            return found
    return None


noise = st.lists(st.sampled_from(NOISE), max_size=4).map(b"".join)
cuts = st.lists(st.integers(0, 600), max_size=8)


@given(noise, cuts, st.binary(max_size=40))
def test_a_reply_is_found_among_packets_that_nobody_asked_for(
    before: bytes, pieces: list[int], data: bytes
) -> None:
    found = fed(codec.ReplyDecoder(21), before + reply(21, 0, data), pieces)
    assert found == codec.Reply(0, data)


@given(noise, noise, cuts, st.sampled_from([single(), extended()]))
def test_a_result_follows_the_reply(before: bytes, between: bytes, pieces: list[int], result: bytes) -> None:
    found = fed(ResultDecoder(), before + reply(START) + between + result, pieces)
    covariance = (0.2, 0.4, 0.6) if len(result) == 204 else None
    assert found == StationaryResult(0, POINT, SCATTER, A_PRIORI, covariance)


def test_scatter_and_expectation_make_the_uncertainty() -> None:
    found = ResultDecoder().feed(reply(START) + single())
    assert found is not None
    assert found.u_mm == pytest.approx((0.005, 0.005, 0.013))


def test_a_result_before_the_reply_is_an_old_one() -> None:
    decoder = ResultDecoder()
    assert decoder.feed(single() + reply(START)) is None
    assert decoder.feed(single()) is not None


@pytest.mark.parametrize("last", [reply(START, 39), struct.pack("<iiii", 16, 1, START, 39)])
def test_a_refused_measurement_has_no_result(last: bytes) -> None:
    assert ResultDecoder().feed(last) == StationaryResult(39)


@pytest.mark.parametrize("command", [START, 64])
def test_an_error_ends_a_measurement(command: int) -> None:
    said = reply(START) + struct.pack("<iiii", 16, 1, command, 10009)
    assert ResultDecoder().feed(said) == StationaryResult(10009)


def test_a_result_of_another_mode_is_refused() -> None:
    with pytest.raises(ProtocolError, match="mode 1"):
        ResultDecoder().feed(reply(START) + single(mode=1))


def test_values_that_are_no_numbers_are_refused() -> None:
    broken = single()[:20] + struct.pack("<d", float("nan")) + single()[28:]
    with pytest.raises(ProtocolError, match="values"):
        ResultDecoder().feed(reply(START) + broken)


def test_replies_come_one_by_one() -> None:
    one, two = (reply(42, 0, struct.pack("<iii", 2, number, 1)) for number in (1, 2))
    decoder = codec.RepliesDecoder(42)
    assert decoder.feed(one + CHANGED) is None
    found = decoder.feed(two)
    assert found is not None
    assert [reply.values("ii") for reply in found] == [(2, 1), (2, 2)]


def test_the_reply_to_another_command_is_refused() -> None:
    with pytest.raises(ProtocolError, match="command 6 is answered instead of 21"):
        codec.ReplyDecoder(21).feed(reply(6))


def test_what_follows_unasked_is_left_out() -> None:
    decoder = codec.ReplyDecoder(2)
    decoder.feed(reply(2) + CHANGED + POSITION + reply(6))
    assert decoder.rest == reply(6)


@pytest.mark.parametrize(
    ("size", "kind"),
    [
        (11, 0),
        (15, 0),
        (4097, 0),
        (-1, 0),
        (157, 2),
        (156, 9),
        (47, 3),
        (85, 3),
        (1 << 30, 3),
        (16, 12),
        (13, 8),
    ],
)
def test_sizes_that_no_packet_has_are_refused(size: int, kind: int) -> None:
    with pytest.raises(ProtocolError):
        codec.cut(struct.pack("<ii", size, kind) + bytes(40))


replies = (reply(1, 0, b"data"), reply(42, 0, b"\1\0\0\0"), reply(START), single(), extended())
packets = st.sampled_from((*NOISE, *replies))


@given(st.lists(st.one_of(st.binary(max_size=40), packets), max_size=8).map(b"".join), cuts)
def test_any_bytes_end_alike_however_they_are_cut(data: bytes, pieces: list[int]) -> None:
    for make in (partial(codec.ReplyDecoder, 1), partial(codec.RepliesDecoder, 42), ResultDecoder):
        assert outcome_of(fed, make(), data, pieces) == outcome_of(fed, make(), data, [])


def test_a_short_reply_has_no_values() -> None:
    with pytest.raises(ProtocolError, match="a reply of 0 bytes"):
        codec.Reply(0, b"").values("i")


def test_a_name_ends_at_its_zero() -> None:
    assert codec.name_of("CCR-1.5in\0rest".encode("utf-16-le").ljust(64, b"\0")) == "CCR-1.5in"


@pytest.mark.parametrize(
    ("status", "text"),
    [(39, "not initialised"), (5, "parameter 2"), (11, "parameter 1"), (14, "parameter 2"), (77, "no known")],
)
def test_a_status_is_said_in_words(status: int, text: str) -> None:
    assert text in status_text(status)
    assert str(status) in status_text(status)
