"""Modbus frames: those of the library that many use, those of the sheet, any cut, garbage."""

from collections.abc import Callable, Sequence
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymodbus.framer import FramerBase, FramerRTU, FramerSocket
from pymodbus.pdu import DecodePDU, ExceptionResponse, ModbusPDU
from pymodbus.pdu.bit_message import (
    ReadCoilsRequest,
    ReadCoilsResponse,
    WriteMultipleCoilsRequest,
    WriteMultipleCoilsResponse,
)
from pymodbus.pdu.mei_message import ReadDeviceInformationRequest, ReadDeviceInformationResponse
from pymodbus.pdu.register_message import ReadHoldingRegistersRequest, ReadHoldingRegistersResponse

from catseye.drivers.modbus import codec
from catseye.drivers.roles.errors import ProtocolError
from tests.unit.drivers.outcomes import outcome_of

UNIT, NUMBER = 17, 258
FRAMES = [(codec.TcpDecoder, FramerSocket), (codec.RtuDecoder, FramerRTU)]
each_frame = pytest.mark.parametrize(("decoder", "framer"), FRAMES, ids=["tcp", "rtu"])

Decoder = type[codec.TcpDecoder] | type[codec.RtuDecoder]

WORDS = [0x7AE1, 0x41F4, 0]
BITS = [True, False, False, True, True, False, False, False, False, True]
NAMES = {0: b"Vaisala", 1: b"PTU300", 2: b"5.16"}

REQUESTS: list[tuple[bytes, ModbusPDU]] = [
    (codec.read_request(3, 0x2C, 3), ReadHoldingRegistersRequest(address=0x2C, count=3)),
    (codec.read_request(1, 7, 10), ReadCoilsRequest(address=7, count=10)),
    (codec.write_coils_request(7, BITS), WriteMultipleCoilsRequest(address=7, bits=BITS)),
    (codec.identify_request(), ReadDeviceInformationRequest()),
]

# Made anew each time: the library counts the objects of an identification again with each encoding.
ANSWERS: list[tuple[int, Callable[[], ModbusPDU]]] = [
    (3, lambda: ReadHoldingRegistersResponse(registers=WORDS)),
    (1, lambda: ReadCoilsResponse(bits=BITS)),
    (15, lambda: WriteMultipleCoilsResponse(address=7, count=10)),
    (43, lambda: ReadDeviceInformationResponse(information=NAMES)),
    (3, lambda: ExceptionResponse(3, 2)),
]


def said(pdu: ModbusPDU) -> bytes:
    """Return a message without its frame."""
    return bytes([pdu.function_code]) + pdu.encode()


def framed(framer: type[FramerBase], pdu: ModbusPDU) -> bytes:
    """Return a message as the library sends it."""
    pdu.dev_id, pdu.transaction_id = UNIT, NUMBER
    return framer(DecodePDU(is_server=False)).buildFrame(pdu)


def fed(decoder: Decoder, function: int, chunks: Sequence[bytes]) -> bytes | None:
    """Return what a decoder makes of chunks; the last one completes the answer."""
    made = decoder(NUMBER, UNIT, function)
    answers = [made.feed(chunk) for chunk in chunks]
    assert answers[:-1] == [None] * (len(chunks) - 1)
    return answers[-1]


def first_of(decoder: Decoder, chunks: Sequence[bytes]) -> bytes | None:
    """Return the first answer in chunks, if there is one."""
    made = decoder(NUMBER, UNIT, 3)
    return next((answer for chunk in chunks if (answer := made.feed(chunk)) is not None), None)


@each_frame
@pytest.mark.parametrize(("request_bytes", "pdu"), REQUESTS)
def test_requests_are_those_of_the_library(
    decoder: Decoder, framer: type[FramerBase], request_bytes: bytes, pdu: ModbusPDU
) -> None:
    assert decoder.frame(NUMBER, UNIT, request_bytes) == framed(framer, pdu)


@each_frame
@pytest.mark.parametrize(("function", "make"), ANSWERS)
def test_answers_of_the_library_are_understood_byte_by_byte(
    decoder: Decoder, framer: type[FramerBase], function: int, make: Callable[[], ModbusPDU]
) -> None:
    data = framed(framer, make())
    answer = fed(decoder, function, [data[at : at + 1] for at in range(len(data))])
    assert answer == said(make())


def test_what_answers_say() -> None:
    registers, bits, written, names, refused = (said(make()) for _, make in ANSWERS)
    assert codec.parse_registers(len(WORDS), registers) == WORDS
    assert codec.parse_bits(len(BITS), bits) == BITS
    codec.check_written(codec.write_coils_request(7, BITS), written)
    assert codec.parse_objects(names) == {0: "Vaisala", 1: "PTU300", 2: "5.16"}
    assert [codec.exception_of(answer) for answer in (registers, refused)] == [0, 2]


@pytest.mark.parametrize("answer", ["03", "03 02 00", "03 03 00 00 00", "03 04 00 00", "03 02 00 00"])
def test_registers_of_a_wrong_length_are_refused(answer: str) -> None:
    with pytest.raises(ProtocolError):
        codec.parse_registers(2, bytes.fromhex(answer))


def test_too_few_bits_are_refused() -> None:
    with pytest.raises(ProtocolError, match="8 bits came"):
        codec.parse_bits(9, bytes.fromhex("01 01 FF"))


@pytest.mark.parametrize("answer", ["2B 0E 01 01 00 00 01 00 07 41", "2B 0E 01", "2B 0E 01 01 00 00 00 00"])
def test_an_identification_of_a_wrong_length_is_refused(answer: str) -> None:
    with pytest.raises(ProtocolError):
        codec.parse_objects(bytes.fromhex(answer))


def test_a_confirmation_of_other_coils_is_refused() -> None:
    with pytest.raises(ProtocolError):
        codec.check_written(codec.write_coils_request(7, BITS), bytes.fromhex("0F 0008 000A"))


@each_frame
def test_bytes_behind_an_answer_are_left(decoder: Decoder, framer: type[FramerBase]) -> None:
    made = decoder(NUMBER, UNIT, 3)
    assert made.feed(framed(framer, ANSWERS[0][1]()) + b"more")
    assert made.rest == b"more"


def test_noise_before_an_rtu_answer_is_left_out() -> None:
    assert fed(codec.RtuDecoder, 3, [b"\x00\xff", framed(FramerRTU, ANSWERS[0][1]())])


def test_an_rtu_answer_with_a_flipped_bit_is_refused() -> None:
    data = bytearray(framed(FramerRTU, ANSWERS[0][1]()))
    data[4] ^= 0x10
    with pytest.raises(ProtocolError, match="check sum"):
        fed(codec.RtuDecoder, 3, [bytes(data)])


answers_with_noise = st.builds(
    lambda before, framer, behind: before + framed(framer, ANSWERS[0][1]()) + behind,
    st.binary(max_size=3),
    st.sampled_from([FramerSocket, FramerRTU]),
    st.binary(max_size=3),
)


@each_frame
@given(
    data=st.one_of(st.binary(max_size=600), answers_with_noise),
    cuts=st.lists(st.integers(0, 600), max_size=4),
)
def test_any_bytes_are_an_answer_or_a_protocol_error(
    decoder: Decoder, framer: type[FramerBase], data: bytes, cuts: list[int]
) -> None:
    del framer
    pieces = [data[a:b] for a, b in pairwise([0, *sorted(min(cut, len(data)) for cut in cuts), len(data)])]
    whole, cut = (outcome_of(first_of, decoder, chunks) for chunks in ([data], pieces))
    assert cut == whole
