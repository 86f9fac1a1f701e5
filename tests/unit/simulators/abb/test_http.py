"""Requests as the emulated server reads them, RAPID texts and WebSocket frames: by hand, and against nonsense."""

import contextlib
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.simulators.abb.http import BadRequestError, Request, RequestBuffer
from catseye.simulators.abb.rapid import Value, ValueTextError, parsed, single, value_text
from catseye.simulators.abb.websocket import FrameReader, handshake, text_frame

POST = b"POST /rw/rapid/execution?action=stop&json=1 HTTP/1.1\r\nHost: h\r\nContent-Length: 13\r\n\r\nstopmode=stop"
GET = b"GET /fileservice/%24HOME/a%20b HTTP/1.0\r\nHost: h\r\n\r\n"


def requests_of(*pieces: bytes) -> list[Request]:
    buffer, found = RequestBuffer(), []
    for piece in pieces:
        buffer.feed(piece)
        while (request := buffer.take()) is not None:
            found.append(request)
    return found


@given(st.lists(st.integers(0, len(POST + GET)), max_size=8))
def test_where_requests_are_cut_does_not_matter(cuts: list[int]) -> None:
    data = POST + GET
    places = sorted({0, *cuts, len(data)})
    first, second = requests_of(*(data[a:b] for a, b in pairwise(places)))
    assert (first.method, first.path, first.query["action"]) == ("POST", "rw/rapid/execution", "stop")
    assert (first.form, first.last) == ({"stopmode": ["stop"]}, False)
    assert (second.path, second.last) == ("fileservice/$HOME/a b", True)


@given(st.binary(max_size=200))
def test_nonsense_is_a_bad_request_or_waits(data: bytes) -> None:
    with contextlib.suppress(BadRequestError):
        assert all(request.method for request in requests_of(data, b"\r\n\r\n"))


@pytest.mark.parametrize(
    ("data", "status"),
    [
        (b"hello\r\n\r\n", 400),
        (b"GET / HTTP/2.0\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nno header\r\n\r\n", 400),
        (b"POST / HTTP/1.1\r\nContent-Length: -1\r\n\r\n", 400),
        (b"POST / HTTP/1.1\r\nContent-Length: 99999999\r\n\r\n", 413),
        (b"POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n", 411),
        (17_000 * b"x", 413),
    ],
)
def test_what_is_no_request_is_answered_so(data: bytes, status: int) -> None:
    with pytest.raises(BadRequestError) as error:
        requests_of(data)
    assert error.value.status == status


GOAL: Value = [[0.0] * 6, [9e9] * 6]


@pytest.mark.parametrize(
    ("text", "like", "value"),
    [
        ("30", 0.0, 30.0),
        (" -1.5E-05 ", 0.0, single(-1.5e-5)),
        ("TRUE", False, True),
        ('"a ""b"""', "", 'a "b"'),
        (
            "[[1,2,3,4,5,6],[9E9,9E9,9E9,9E9,9E9,9E+09]]",
            GOAL,
            [[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [single(9e9)] * 6],
        ),
    ],
)
def test_values_are_read_and_written_as_rapid_does(text: str, like: Value, value: Value) -> None:
    assert parsed(text, like) == value
    assert parsed(value_text(value), like) == value


@pytest.mark.parametrize(
    "text", ["", "x", "1 2", "[1]", "TRUE", '"1"', "[[1,2],[3]]", "[", "]", "1,", 300 * "["]
)
def test_what_is_no_num_is_refused(text: str) -> None:
    with pytest.raises(ValueTextError):
        parsed(text, 0.0)


@given(st.floats(-1e6, 1e6, width=32))
def test_nums_keep_their_32_bits(value: float) -> None:
    assert parsed(value_text(value), 0.0) == value


@pytest.mark.parametrize("text", ["3.5E38", "-1E100", "1E999"])
def test_a_number_beyond_32_bits_is_no_num(text: str) -> None:
    with pytest.raises(ValueTextError):
        parsed(text, 0.0)


@given(st.text(max_size=40))
def test_no_text_breaks_a_value(text: str) -> None:
    try:
        value = parsed(text, GOAL)
    except ValueTextError:
        return
    assert type(value) is type(GOAL)


def test_the_handshake_is_that_of_the_standard() -> None:
    # RFC 6455, section 1.3.
    headers = {"upgrade": "websocket", "sec-websocket-key": "dGhlIHNhbXBsZSBub25jZQ=="}
    answer = handshake(Request("GET", "/poll/1", headers))
    assert answer is not None
    assert ("Sec-WebSocket-Accept", "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=") in answer.headers
    assert handshake(Request("GET", "/poll/1", {})) is None


def test_frames_are_those_of_the_standard() -> None:
    # RFC 6455, section 5.7: an unmasked text, a masked ping.
    assert text_frame("Hello") == bytes.fromhex("810548656c6c6f")
    masked_ping = bytes.fromhex("898537fa213d7f9f4d5158")
    assert FrameReader().feed(masked_ping) == bytes.fromhex("8a0548656c6c6f")


def test_an_unmasked_frame_ends_the_connection() -> None:
    reader = FrameReader()
    reader.feed(bytes.fromhex("810548656c6c6f"))
    assert reader.ended
