"""The codec and the manual's lines."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from norra_ld5 import codec
from transcript import IDENTITY, POSITION, STATUS, STATUS_LOST, ZERO

from catseye.drivers.roles.errors import ProtocolError

COMMANDS = {codec.IDENTITY: IDENTITY, codec.POSITION: POSITION, codec.STATUS: STATUS, codec.ZERO: ZERO}


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_and_answers_are_the_manuals(command):
    sent, answered = COMMANDS[command]
    assert codec.encode(command) == sent
    line = codec.AnswerDecoder().feed(answered)
    assert line == answered.decode().rstrip()
    assert codec.value_of(command, line) == line[len(command) :]


def test_values_of_the_manual():
    assert codec.parse_position_mm("-0012.345678") == -12.345678
    assert codec.parse_status("1,0,0,1,080") == codec.Status(True, False, False, True, 80)
    lost = STATUS_LOST[1].decode().strip().removeprefix("1TS")
    assert codec.parse_status(lost) == codec.Status(False, True, False, True, 0)


@given(cuts=st.lists(st.integers(0, len(POSITION[1])), max_size=6))
def test_any_split_of_the_stream_gives_the_same_answer(cuts):
    data, decoder = POSITION[1], codec.AnswerDecoder()
    edges = [0, *sorted(cuts), len(data)]
    answers = [decoder.feed(data[a:b]) for a, b in pairwise(edges)]
    assert next(answer for answer in answers if answer is not None) == "1TP-0012.345678"


@given(chunks=st.lists(st.binary(max_size=400), max_size=8))
def test_garbage_raises_nothing_but_protocol_errors(chunks):
    decoder = codec.AnswerDecoder()
    try:
        for chunk in chunks:
            line = decoder.feed(chunk)
            if line is not None:
                codec.parse_position_mm(codec.value_of(codec.POSITION, line))
    except ProtocolError:
        return
