"""Packets of the emulated server: commands cut out of any stream, results as the driver's own codec reads them."""

import struct
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.leica.codec import ReplyDecoder, encode
from catseye.drivers.leica.measurement import ResultDecoder
from catseye.simulators.leica import packets
from catseye.simulators.leica.packets import Command, CommandCutter, PointValues

cuts = st.lists(st.integers(0, 400), max_size=8)
numbers = st.integers(-(2**31), 2**31 - 1)
lengths = st.floats(-1e5, 1e5)


def fed(cutter: CommandCutter, data: bytes, pieces: list[int]) -> list[Command]:
    places = sorted({min(cut, len(data)) for cut in pieces} | {0, len(data)})
    return [one for start, end in pairwise(places) for one in cutter.feed(data[start:end])]


@given(st.lists(st.tuples(numbers, st.lists(lengths, max_size=6)), min_size=1, max_size=5), cuts)
def test_commands_are_found_however_they_are_cut(
    wanted: list[tuple[int, list[float]]], pieces: list[int]
) -> None:
    data = b"".join(encode(number, f"{len(values)}d", *values) for number, values in wanted)
    found = fed(CommandCutter(), data, pieces)
    assert [(one.number, one.parameters) for one in found] == [
        (number, struct.pack(f"<{len(values)}d", *values)) for number, values in wanted
    ]


@given(st.binary(max_size=3000), cuts)
def test_any_bytes_are_cut_into_commands_of_bounded_length(data: bytes, pieces: list[int]) -> None:
    for one in fed(CommandCutter(), data, pieces):
        assert len(one.parameters) <= packets.LONGEST_BYTES


@given(numbers, st.integers(0, 100), st.binary(max_size=80))
def test_the_driver_reads_replies(command: int, status: int, data: bytes) -> None:
    reply = ReplyDecoder(command).feed(packets.reply(command, status, data))
    assert reply is not None
    assert (reply.status, reply.data) == (status, data)


@given(
    st.tuples(lengths, lengths, lengths),
    st.lists(st.floats(0.0, 10.0), min_size=6, max_size=6),
    st.booleans(),
)
def test_the_driver_reads_results(
    place: tuple[float, float, float], deviations: list[float], extended: bool
) -> None:
    scatter, expected = np.square(deviations[:3]), np.square(deviations[3:])
    point = PointValues(place, np.diag(scatter), np.diag(expected))
    said = packets.reply(49, 0) + packets.single(0, point, (20.0, 1013.0, 50.0), extended=extended)
    result = ResultDecoder().feed(said)
    assert result is not None
    assert result.place_mm == place
    np.testing.assert_allclose(result.scatter_mm, deviations[:3], atol=1e-7)
    np.testing.assert_allclose(result.a_priori_mm, deviations[3:], atol=1e-7)
    assert result.covariance_mm2 == ((0.0, 0.0, 0.0) if extended else None)


def test_the_driver_reads_both_covariances() -> None:
    scatter = np.array([[4.0, 1.0, -2.0], [1.0, 9.0, 3.0], [-2.0, 3.0, 16.0]])
    expected = np.array([[5.0, 0.5, 0.25], [0.5, 6.0, -1.0], [0.25, -1.0, 7.0]])
    point = PointValues((1.0, 2.0, 3.0), scatter, expected)
    said = packets.reply(49, 0) + packets.single(0, point, (20.0, 1013.0, 50.0), extended=True)
    result = ResultDecoder().feed(said)
    assert result is not None
    assert result.covariance_mm2 == (1.5, -1.75, 2.0)
    assert result.u_mm == pytest.approx((3.0, 15.0**0.5, 23.0**0.5))
