"""Messages of KUKAVARPROXY against the sheet `kuka_abb_robodk`, section A1: its vectors, and frames made by hand."""

import struct
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.kuka.codec import ERRORS, Item, Kind, Reply, ReplyDecoder, encode_request
from catseye.drivers.roles.errors import ProtocolError

READ_MEASURED = bytes.fromhex("00 01 00 11 00 00 0E 24 41 58 49 53 5F 41 43 54 5F 4D 45 41 53")
WRITE_OVERRIDE = bytes.fromhex("00 02 00 0E 01 00 07 24 4F 56 5F 50 52 4F 00 02 35 30")
CHARGE_OK = bytes.fromhex("01 00 00 10 00 00 0A 23 43 48 41 52 47 45 5F 4F 4B 00 01 01")

TEXTS = st.text(st.characters(codec="ascii", exclude_categories=["Cc"]), max_size=40)
WIDE_TEXTS = st.text(st.characters(codec="utf-16-le"), max_size=20)
TAGS = st.integers(0, 0xFFFF)


def frame(tag: int, kind: int, payload: bytes, error: int, success: int | None = None) -> bytes:
    """Put a reply together by the sheet's words."""
    done = (error == 1) if success is None else success
    body = bytes([kind]) + payload + struct.pack(">HB", error, done)
    return struct.pack(">HH", tag, len(body)) + body


def narrow(text: str) -> bytes:
    return struct.pack(">H", len(text)) + text.encode("ascii")


def wide(text: str) -> bytes:
    data = text.encode("utf-16-le")
    return struct.pack(">H", len(data) // 2) + data


def test_requests_are_those_of_the_sheet() -> None:
    assert encode_request(1, Kind.READ, ("$AXIS_ACT_MEAS",)) == READ_MEASURED
    assert encode_request(2, Kind.WRITE, ("$OV_PRO", "50")) == WRITE_OVERRIDE


def test_the_sheets_reply_is_read() -> None:
    reply = ReplyDecoder(0x0100, Kind.READ).feed(CHARGE_OK)
    assert reply == Reply((Item(1, "#CHARGE_OK"),), 1)


def test_utf16_texts_count_their_characters() -> None:
    request = encode_request(7, Kind.READ_WIDE, ("$TOOL",))
    assert request == bytes.fromhex("00 07 00 0D 04 00 05 24 00 54 00 4F 00 4F 00 4C 00")


def test_several_variables_go_into_one_message() -> None:
    request = encode_request(9, Kind.WRITE_MANY, ("A", "1", "B", "2"))
    assert request[4:6] == b"\x07\x02"
    assert request[6:] == wide("A") + wide("1") + wide("B") + wide("2")
    payload = b"\x02\x01" + wide("1") + b"\x03" + wide("")
    assert ReplyDecoder(9, Kind.WRITE_MANY).feed(frame(9, 7, payload, 0)) == Reply(
        (Item(1, "1"), Item(3, "")), 0
    )


def test_the_success_byte_of_an_old_proxy_decides() -> None:
    # It repeats what it did not write, and ends with the length of its success byte: 00 01 00.
    reply = ReplyDecoder(3, Kind.WRITE).feed(bytes.fromhex("00 03 00 08 01 00 02 39 39 00 01 00"))
    assert reply == Reply((Item(0, "99"),), 0)


@pytest.mark.parametrize("error", [0, *range(2, 11)])
def test_every_error_of_the_sheet_is_read(error: int) -> None:
    reply = ReplyDecoder(3, Kind.READ).feed(frame(3, 0, narrow(""), error))
    assert reply is not None
    assert reply.error == error
    assert ERRORS[error]


@given(TAGS, TEXTS, st.lists(st.integers(0, 60), max_size=6))
def test_any_split_gives_the_same_reply(tag: int, text: str, cuts: list[int]) -> None:
    data = frame(tag, 0, narrow(text), 1)
    decoder = ReplyDecoder(tag, Kind.READ)
    edges = sorted({0, len(data), *(min(cut, len(data)) for cut in cuts)})
    replies = [decoder.feed(data[a:b]) for a, b in pairwise(edges)]
    assert replies[-1] == Reply((Item(1, text),), 1)
    assert replies[:-1] == [None] * (len(edges) - 2)


@given(TAGS, st.lists(st.tuples(st.sampled_from([1, 2, 3, 6]), WIDE_TEXTS), max_size=5))
def test_many_values_come_back_in_their_order(tag: int, values: list[tuple[int, str]]) -> None:
    payload = bytes([len(values)]) + b"".join(bytes([code]) + wide(text) for code, text in values)
    error = 1 if all(code == 1 for code, _ in values) else 0
    reply = ReplyDecoder(tag, Kind.READ_MANY).feed(frame(tag, 6, payload, error))
    assert reply == Reply(tuple(Item(code, text) for code, text in values), error)


@given(st.binary(max_size=200), st.sampled_from(Kind))
def test_garbage_raises_protocol_errors_and_nothing_else(data: bytes, kind: Kind) -> None:
    decoder = ReplyDecoder(1, kind)
    try:
        decoder.feed(data)
    except ProtocolError:
        return
    with pytest.raises(ProtocolError):
        decoder.end()


@pytest.mark.parametrize(
    ("data", "what"),
    [
        (frame(2, 0, narrow("1"), 1), "tag"),
        (frame(1, 1, narrow("1"), 1), "type"),
        (frame(1, 0, narrow("1"), 0, success=1), "contradict"),
        (frame(1, 0, narrow("1"), 1, success=7), "contradict"),
        (frame(1, 0, narrow("1") + b"x", 1), "follow"),
        (frame(1, 0, b"\x00\x09ab", 1), "9 characters"),
        (frame(1, 0, b"", 1), "length"),
        (b"\x00\x01\x00\x03\x00\x00\x01", "short"),
    ],
)
def test_a_malformed_reply_is_named(data: bytes, what: str) -> None:
    with pytest.raises(ProtocolError, match=what):
        ReplyDecoder(1, Kind.READ).feed(data)


def test_a_reply_that_announces_too_many_values_is_named() -> None:
    with pytest.raises(ProtocolError, match="announces 2"):
        ReplyDecoder(1, Kind.READ_MANY).feed(frame(1, 6, b"\x02\x01" + wide("1"), 1))


def test_what_follows_a_reply_is_kept() -> None:
    decoder = ReplyDecoder(0x0100, Kind.READ)
    assert decoder.feed(CHARGE_OK + b"more") is not None
    assert decoder.rest == b"more"


@pytest.mark.parametrize(
    ("tag", "texts"), [(-1, ("A",)), (0x10000, ("A",)), (1, ("A" * 40_000,)), (1, tuple("A" * 300))]
)
def test_what_fits_into_no_message_is_refused(tag: int, texts: tuple[str, ...]) -> None:
    with pytest.raises(ValueError, match=r"tag|characters|variables"):
        encode_request(tag, Kind.READ_MANY, texts)
