"""MXT datagrams against offsets written down by hand from the sheet, section 2."""

import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.melfa.mxt import codec
from catseye.drivers.melfa.mxt.codec import Command, Kind
from catseye.drivers.roles.errors import ProtocolError

TARGET = (10.0, -20.0, 75.5, 181.25)


def field(layout: str, data: bytes, offset: int) -> tuple[float, ...]:
    """Return the numbers at an offset."""
    numbers: tuple[float, ...] = struct.unpack_from(layout, data, offset)
    return numbers


def test_a_set_point_lies_where_the_sheet_has_it() -> None:
    data = codec.encode(Command.MOVE, 0x01020304, TARGET)
    assert len(data) == 196
    assert field("<4H", data, 0) == (1, 2, 2, 0)
    j1, j2, j3, j4 = field("<4f", data, 8)
    assert (j1, j2, j4) == pytest.approx([math.radians(a) for a in (10.0, -20.0, 181.25)], rel=1e-7)
    # The trap: J3 of a SCARA is in mm, not in rad and not in m.
    assert j3 == 75.5
    assert field("<4f", data, 24) == (0.0, 0.0, 0.0, 0.0)
    assert field("<H", data, 58) == (0,)
    assert field("<I", data, 60) == (0x01020304,)
    assert [field("<H", data, offset)[0] for offset in (64, 108, 152)] == [5, 8, 11]


def test_asking_and_ending_carry_no_set_point() -> None:
    for command, number in ((Command.NONE, 0), (Command.END, 255)):
        data = codec.encode(command, 3)
        assert field("<4H", data, 0) == (number, 0, 2, 0)
        assert data[8:48] == bytes(40)


def answer() -> bytes:
    """Return a controller's datagram: command, filtered command, feedback and current of four axes."""
    data = bytearray(196)
    struct.pack_into("<4H", data, 0, 1, 2, 2, 0)
    struct.pack_into("<4f", data, 8, 0.5, -0.25, 12.5, 3.0)
    struct.pack_into("<H", data, 58, 4)
    struct.pack_into("<I", data, 60, 99)
    for offset, kind, axes in (
        (64, 5, (0.4, -0.2, 12.0, 2.9)),
        (108, 8, (0.39, -0.19, 11.5, 2.8)),
        (152, 11, (5, 4, -3, 2)),
    ):
        struct.pack_into("<H", data, offset, kind)
        struct.pack_into("<4i" if kind == 11 else "<4f", data, offset + 4, *axes)
    return bytes(data)


def test_an_answer_is_read_where_the_sheet_has_it() -> None:
    reply = codec.decode(answer())
    assert (reply.command, reply.t_count, reply.c_count) == (1, 4, 99)
    assert reply.joints(Kind.JOINT_COMMAND) == pytest.approx(
        (math.degrees(0.5), math.degrees(-0.25), 12.5, math.degrees(3.0)), rel=1e-6
    )
    feedback = reply.joints(Kind.JOINT_FEEDBACK)
    assert feedback == pytest.approx(
        (math.degrees(0.39), math.degrees(-0.19), 11.5, math.degrees(2.8)), rel=1e-6
    )
    assert reply.axes[Kind.CURRENT_FEEDBACK][:4] == (5.0, 4.0, -3.0, 2.0)


def test_data_of_another_kind_is_not_taken_for_joints() -> None:
    data = bytearray(answer())
    struct.pack_into("<H", data, 4, 1)
    assert codec.decode(bytes(data)).joints(Kind.JOINT_COMMAND) is None


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_numbers_that_are_none_go_neither_way(value: float) -> None:
    with pytest.raises(ValueError, match="finite"):
        codec.encode(Command.MOVE, 1, (value, 0.0, 0.0, 0.0))
    data = bytearray(answer())
    struct.pack_into("<f", data, 112, value)
    with pytest.raises(ProtocolError, match="numbers that are none"):
        codec.decode(bytes(data))


@given(st.binary(max_size=400))
def test_garbage_is_refused_and_nothing_else_happens(data: bytes) -> None:
    if len(data) != 196:
        with pytest.raises(ProtocolError, match="196 bytes"):
            codec.decode(data)


@given(st.binary(min_size=196, max_size=196))
def test_any_datagram_of_the_right_length_is_read_or_refused(data: bytes) -> None:
    try:
        reply = codec.decode(data)
    except ProtocolError:
        return
    assert all(math.isfinite(number) for axes in reply.axes.values() for number in axes)
