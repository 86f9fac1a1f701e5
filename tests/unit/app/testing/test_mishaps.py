"""What goes wrong at random on one way of a link."""

import pytest

from catseye.app.testing.mishaps import KINDS, Kind, Mishaps, Piece, Way

DATA = b"R 12.5\r\n"


def struck(kind: Kind, first: int = 0) -> Way:
    """Return a way of which one piece is struck."""
    return Mishaps(kind, "7", first=first, share=0.0).way()


def arrived(way: Way, *pieces: bytes) -> list[bytes]:
    return [piece.data for data in pieces for piece in way.passed(data)]


@pytest.mark.parametrize("kind", KINDS)
def test_pieces_before_the_first_strike_pass(kind: Kind) -> None:
    assert struck(kind, first=2).passed(DATA) == [Piece(DATA)]


@pytest.mark.parametrize("kind", KINDS)
def test_the_same_seed_strikes_the_same_way(kind: Kind) -> None:
    assert struck(kind).passed(DATA) == struck(kind).passed(DATA)


def test_a_split_piece_comes_whole_in_two() -> None:
    pieces = arrived(struck("split"), DATA)
    assert len(pieces) == 2
    assert b"".join(pieces) == DATA


def test_a_coalesced_piece_comes_with_the_next_one() -> None:
    assert arrived(struck("coalesce"), b"one", b"two", b"three") == [b"onetwo", b"three"]


def test_a_delayed_piece_comes_later() -> None:
    (piece,) = struck("delay").passed(DATA)
    assert piece.data == DATA
    assert 0.0 < piece.pause_s < 1.0


def test_a_drop_loses_bytes_in_a_row() -> None:
    (left,) = arrived(struck("drop"), DATA)
    lost = len(DATA) - len(left)
    assert any(DATA[:at] + DATA[at + lost :] == left for at in range(len(DATA)))
    assert lost > 0


def test_a_doubled_piece_comes_twice() -> None:
    assert arrived(struck("duplicate"), DATA) == [DATA + DATA]


@pytest.mark.parametrize(("kind", "mask"), [("corrupt", 0x80), ("digit", 0x01)])
def test_one_bit_of_a_piece_is_flipped(kind: Kind, mask: int) -> None:
    (came,) = arrived(struck(kind), DATA)
    assert [a ^ b for a, b in zip(came, DATA, strict=True) if a != b] == [mask]


def test_a_flipped_digit_is_another_digit() -> None:
    (came,) = arrived(struck("digit"), DATA)
    assert came.translate(None, b"0123456789") == DATA.translate(None, b"0123456789")
    assert came != DATA


def test_nothing_passes_a_stalled_way() -> None:
    assert arrived(struck("stall"), b"one", b"two") == []


def test_a_half_closed_way_ends_behind_its_piece() -> None:
    way = struck("half-close")
    assert arrived(way, b"one", b"two") == [b"one"]
    assert way.ended


@pytest.mark.parametrize("kind", ["stall", "half-close"])
def test_a_new_connection_is_sound_again(kind: Kind) -> None:
    mishaps = Mishaps(kind, "7", first=0, share=0.0)
    arrived(mishaps.way(), DATA)
    assert arrived(mishaps.way(), DATA) == [DATA]
    assert mishaps.struck == 1
