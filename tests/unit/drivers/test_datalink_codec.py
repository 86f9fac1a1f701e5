"""Records of the data link against the sheet's section 4: six numbers and a CR, in whatever notation."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.melfa.datalink import codec
from catseye.drivers.melfa.datalink.codec import Record, RecordDecoder
from catseye.drivers.roles.errors import ProtocolError
from tests.unit.drivers.outcomes import outcome_of


def test_a_request_is_six_numbers_and_a_cr() -> None:
    assert (
        codec.encode(7, codec.ADD, (10.0, -20.5, 75.123456, -0.00001))
        == b"7,1,10.0000,-20.5000,75.1235,0.0000\r"
    )
    assert codec.encode(8, codec.DRIVE) == b"8,2,0.0000,0.0000,0.0000,0.0000\r"


@pytest.mark.parametrize(
    "line",
    [
        b"7,2,10.5,-20.25,75,1.5",
        b" 7 , 2 , +10.5 , -20.25 , 75.000 , 1.5E0",
        b"7.0,2.0,1.05E+01,-2.025e1,.75E2,1.5",
        b"+7,+2,+10.500,-20.250,+75.000,+1.500",
    ],
)
def test_every_usual_notation_is_taken(line: bytes) -> None:
    assert codec.parse(line) == Record(7, 2, (10.5, -20.25, 75.0, 1.5))


@pytest.mark.parametrize(
    "line",
    [
        b"",
        b"7,2,1,2,3",
        b"7,2,1,2,3,4,5",
        b"7,2,a,2,3,4",
        b"7.5,2,1,2,3,4",
        b"7,2,nan,0,0,0",
        b"7,2,1e999,0,0,0",
    ],
)
def test_anything_else_is_refused(line: bytes) -> None:
    with pytest.raises(ProtocolError):
        codec.parse(line)


def test_a_request_holds_no_number_that_is_none() -> None:
    with pytest.raises(ValueError, match="finite"):
        codec.encode(1, codec.ADD, (math.nan,))


@given(st.data())
def test_any_split_gives_the_same_record(data: st.DataObject) -> None:
    stream = b"\n12,3,1.5,2.5,3.5,4.5\r\nrest"
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=8)))
    decoder = RecordDecoder()
    found = None
    for start, end in zip([0, *cuts], [*cuts, len(stream)], strict=True):
        if found is None:
            found = decoder.feed(stream[start:end])
    assert found == Record(12, 3, (1.5, 2.5, 3.5, 4.5))


def first_of(chunks: list[bytes]) -> Record | None:
    """Return the first record in chunks, if there is one."""
    decoder = RecordDecoder()
    return next((found for chunk in chunks if (found := decoder.feed(chunk)) is not None), None)


pieces = st.one_of(st.binary(max_size=64), st.sampled_from([b"12,3,1.5,2.5", b",3.5,4.5\r", b"1e999", b"\n"]))


@given(st.lists(pieces, max_size=40))
def test_garbage_ends_alike_however_it_is_cut(chunks: list[bytes]) -> None:
    assert outcome_of(first_of, chunks) == outcome_of(first_of, [b"".join(chunks)])
