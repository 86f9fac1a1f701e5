"""Requests and answers of the driver's side: the codec against texts written out by hand, and against nonsense."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.abb.http import Answer, AnswerDecoder, Request
from catseye.drivers.roles.errors import ProtocolError

COUNTED = b'HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nSet-Cookie: a=1\r\nContent-Length: 7\r\n\r\n{"a":1}'
CHUNKED = (
    b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n"
    b'4;note=1\r\n{"a"\r\n3\r\n:1}\r\n0\r\nTrailer: x\r\n\r\n'
)
EMPTY = b"HTTP/1.1 204 No Content\r\nConnection: close\r\n\r\n"
CONTINUED = b"HTTP/1.1 100 Continue\r\n\r\n" + EMPTY


def decoded(data: bytes) -> tuple[Answer | None, bytes]:
    decoder = AnswerDecoder()
    return decoder.feed(data), decoder.rest


def decoded_in_pieces(data: bytes, cuts: list[int]) -> tuple[Answer | None, bytes]:
    """Feed pieces until the answer is complete; what was not fed yet counts as the rest."""
    places = sorted({cut % (len(data) + 1) for cut in cuts} | {0, len(data)})
    decoder = AnswerDecoder()
    for start, end in pairwise(places):
        if (answer := decoder.feed(data[start:end])) is not None:
            return answer, decoder.rest + data[end:]
    return None, decoder.rest


def test_a_request_is_what_the_sheet_says() -> None:
    request = Request(
        "POST", "rw/rapid/execution", (("action", "stop"), ("json", "1")), (("stopmode", "stop"),)
    )
    assert request.encoded("10.0.0.1:80", {"Cookie": "a=1"}) == (
        b"POST /rw/rapid/execution?action=stop&json=1 HTTP/1.1\r\nHost: 10.0.0.1:80\r\nAccept: application/json\r\n"
        b"Content-Type: application/x-www-form-urlencoded\r\nContent-Length: 13\r\nCookie: a=1\r\n\r\nstopmode=stop"
    )


def test_a_question_has_no_body() -> None:
    request = Request("GET", "ctrl/$RAMDISK")
    assert (
        request.encoded("h", {})
        == b"GET /ctrl/$RAMDISK HTTP/1.1\r\nHost: h\r\nAccept: application/json\r\n\r\n"
    )


@pytest.mark.parametrize("data", [COUNTED, CHUNKED])
def test_bodies_of_both_kinds_are_read(data: bytes) -> None:
    answer, rest = decoded(data + b"HTTP")
    assert answer is not None
    assert (answer.status, answer.body, rest) == (200, b'{"a":1}', b"HTTP")


def test_headers_are_found_by_small_names() -> None:
    answer, _ = decoded(COUNTED)
    assert answer is not None
    assert answer.values("set-cookie") == ["a=1"]
    assert not answer.last


@pytest.mark.parametrize("data", [EMPTY, CONTINUED])
def test_an_answer_without_body_ends_with_its_head(data: bytes) -> None:
    answer, rest = decoded(data)
    assert answer is not None
    assert (answer.status, answer.body, answer.last, rest) == (204, b"", True, b"")


@given(st.sampled_from([COUNTED, CHUNKED, EMPTY, CONTINUED]), st.lists(st.integers(0, 500), max_size=8))
def test_where_the_stream_is_cut_does_not_matter(data: bytes, cuts: list[int]) -> None:
    assert decoded_in_pieces(data + b"rest", cuts) == decoded(data + b"rest")


@given(st.binary(max_size=200), st.sampled_from([b"", b"HTTP/1.1 ", COUNTED[:40], CHUNKED[:47]]))
def test_nonsense_is_a_protocol_error_or_waits(data: bytes, before: bytes) -> None:
    try:
        answer, _ = decoded(before + data)
    except ProtocolError:
        return
    assert answer is None or 200 <= answer.status < 600


@given(st.integers(200, 599).filter(lambda status: status not in {204, 304}), st.binary(max_size=300))
def test_a_body_is_read_back_whole(status: int, body: bytes) -> None:
    head = f"HTTP/1.1 {status} Any\r\nContent-Length: {len(body)}\r\n\r\n".encode()
    assert decoded(head + body)[0] == Answer(status, (("content-length", str(len(body))),), body)


@pytest.mark.parametrize(
    "data",
    [
        b"SSH-2.0-OpenSSH\r\n",
        b"HTTP/1.1 2000 OK\r\n\r\n",
        b"HTTP/1.1 200 OK\r\n\r\n",
        b"HTTP/1.1 200 OK\r\nContent-Length: -1\r\n\r\n",
        b"HTTP/1.1 200 OK\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\n",
        b"HTTP/1.1 200 OK\r\nContent-Length: 99999999\r\n\r\n",
        b"HTTP/1.1 200 OK\r\nTransfer-Encoding: gzip\r\n\r\n",
        b"HTTP/1.1 200 OK\r\nno header\r\n\r\n",
        b"HTTP/1.1 101 Switching Protocols\r\n\r\n",
        b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nxyz\r\n",
        b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n1\r\nabc\r\n",
        b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nfffff\r\n",
        b"HTTP/1.1 200 OK\r\nX: " + 17_000 * b"x",
    ],
)
def test_what_no_answer_may_hold_is_refused(data: bytes) -> None:
    with pytest.raises(ProtocolError):
        decoded(data)


def test_silence_ends_no_answer() -> None:
    decoder = AnswerDecoder()
    decoder.feed(COUNTED[:-1])
    assert not decoder.may_end
    with pytest.raises(ProtocolError, match="ended"):
        decoder.end()
