"""Requests that make no sense: each is answered as the proxy answers errors, at once, and the next one as ever."""

import struct
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from catseye.simulators.kuka.frames import ErrorCode
from tests.unit.simulators.kuka.client import Client, narrow, wide

MOST_CPU_S = 1.0
"""Of one answer; what takes the square of the length of a request takes more than ten times as long."""

LONG = 65_000

READABLE = ("$AXIS_ACT", "$TORQUE_AXIS_ACT", "$MODEL_NAME", "$LOAD", "$POS_ACT")
WRITABLE = ("$OV_PRO", "$TOOL", "$LOAD", "$BASE.X", "CATS_INC", "CATS_X", "CATS_MAX_MM", "CATS_MAX_DEG")
ORDERS = ("CATS_CMD", "CATS_AXIS", "CATS_FOR", "CATS_SEQ", "CATS_GOAL", "CATS_STOP", "CATS_BEAT")

names = st.builds(
    "{}{}".format,
    st.sampled_from((*READABLE, *WRITABLE, *ORDERS, "$NOBODY", "PING", "")),
    st.sampled_from(("", "[]", "[1]", "[0]", "[" + "9" * 5000 + "]", ".A1", ".CM.X", "[", ".", "..", " "))
    | st.text(st.characters(max_codepoint=255), max_size=8),
)
texts = (
    st.sampled_from(
        ("1e999", "-1e999", "1e39", "3.4e38", "0", "-1", "2", "3", "4", "TRUE", "#EX", "{}", "{A1 1e999}")
    )
    | st.sampled_from(
        ("{X 1e999}", "{CM {X 1,,Y 2}}", "{CM {X 1}", "{M 1}}", "{,}", "{:}", "{A1 }", "9" * 5000)
    )
    | st.text(st.sampled_from("{}, :.eE+-019AXM#$"), max_size=20)
    | st.text(st.characters(max_codepoint=255), max_size=12)
)


def byte_texts(*said: str) -> bytes:
    return b"".join(struct.pack(">H", len(text)) + text.encode("latin-1") for text in said)


def wide_texts(*said: str) -> bytes:
    return b"".join(map(wide, said))


payloads = st.one_of(
    st.tuples(st.just(0), st.builds(byte_texts, names)),
    st.tuples(st.just(1), st.builds(byte_texts, names, texts)),
    st.tuples(st.just(4), st.builds(wide_texts, names)),
    st.tuples(st.just(5), st.builds(wide_texts, names, texts)),
    st.tuples(st.sampled_from(range(256)), st.binary(max_size=30)),
)


def answered(client: Client, kind: int, payload: bytes) -> str:
    """Ask, and return what a question that makes sense is answered with afterwards."""
    began_s = time.thread_time()
    _, error, success = client.say(kind, payload)
    assert time.thread_time() - began_s < MOST_CPU_S
    assert success == (error == ErrorCode.SUCCESS)
    # What was written is looked at by the program in its next cycle.
    client.bench.advance(0.05)
    return client.read("PING")


@given(asked=st.lists(payloads, min_size=1, max_size=12))
@settings(max_examples=60, deadline=None)
def test_whatever_is_asked_is_answered(asked: list[tuple[int, bytes]]) -> None:
    client = Client()
    assert {answered(client, kind, payload) for kind, payload in asked} == {"PONG"}


@pytest.mark.parametrize("old", [False, True])
@pytest.mark.parametrize("name", ["$TORQUE_AXIS_ACT[" + "9" * 5000 + "]", "$AXIS_ACT[" + "1" * 5000 + "]"])
def test_an_index_of_many_digits_is_an_unknown_variable(name: str, old: bool) -> None:
    payload, error, success = Client(old=old).say(0, narrow(name))
    assert payload == narrow("")
    assert (error, success) == ((1, 1) if old else (ErrorCode.GENERAL, 0))


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("CATS_INC", "1e999"),
        ("CATS_INC", "-1E+999"),
        ("CATS_MAX_MM", "9" * 400),
        ("$BASE.X", "1e999"),
        ("$TOOL", "{X 1e999}"),
        ("$LOAD", "{CM {X 1e999}}"),
        ("CATS_GOAL", "{A1 -1e999}"),
    ],
)
def test_a_number_beyond_every_real_is_refused(name: str, text: str) -> None:
    client = Client()
    before = client.read(name)
    assert client.say(1, narrow(name) + narrow(text)) == (narrow(""), ErrorCode.GENERAL, 0)
    assert client.say(5, wide(name) + wide(text)) == (wide(""), ErrorCode.ARGUMENT, 0)
    assert client.read(name) == before


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("$A[" + " " * LONG + "x", ""),
        ("A" * LONG + "!", ""),
        ("A" + ".A" * (LONG // 2) + "!", ""),
        ("CATS_INC", "1" * LONG + "x"),
        ("$TOOL", "{" + "," * LONG + "}"),
        ("$TOOL", "{" + " " * LONG + "x"),
        ("$TOOL", "{" + "x" * LONG),
        ("$TOOL", "{" * LONG),
        ("$TOOL", "{X" + " " * LONG + "1 2}"),
        ("$TOOL", "{X 1" + ", X 1" * (LONG // 5) + ",}"),
    ],
)
def test_a_long_request_is_answered_at_once(name: str, text: str) -> None:
    client = Client()
    before = client.read("CATS_INC"), client.read("$TOOL")
    assert answered(client, 0, narrow(name)) == "PONG"
    assert answered(client, 1, narrow(name) + narrow(text)) == "PONG"
    assert (client.read("CATS_INC"), client.read("$TOOL")) == before


def test_the_longest_text_is_answered_by_an_old_proxy() -> None:
    longest = "x" * (0xFFFF - 5)
    payload, _, success = Client(old=True).say(1, narrow("") + narrow(longest))
    assert (payload, success) == (narrow(""), 0)


@pytest.mark.parametrize(("distance", "most"), [("1e30", "3e38"), ("3.4e38", "3.4e38"), ("-1e7", "1e8")])
def test_an_order_without_a_possible_goal_is_a_message(distance: str, most: str) -> None:
    client = Client()
    for name, text in (("CATS_MAX_MM", most), ("CATS_CMD", "3"), ("CATS_X", distance), ("CATS_FOR", "1")):
        client.say(1, narrow(name) + narrow(text))
    client.say(1, narrow("CATS_SEQ") + narrow("1"))
    client.bench.advance(0.1)
    assert (client.read("$STOPMESS"), client.read("$PRO_STATE")) == ("TRUE", "#P_STOP")
