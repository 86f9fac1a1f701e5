"""What a line typed to a raw link stands for."""

import pytest

from catseye.app.protocol.raw_text import LineEnd, encoded


@pytest.mark.parametrize(
    ("line", "end", "data"),
    [
        ("R", "crlf", b"R\r\n"),
        ("R", "cr", b"R\r"),
        ("R", "lf", b"R\n"),
        (r"1;1;STATE\r", "none", b"1;1;STATE\r"),
        (r"\e[A\x00\xFF\t\\n", "none", b"\x1b[A\x00\xff\t\\n"),
        ("", "cr", b"\r"),
        ("µ", "none", b"\xb5"),
    ],
)
def test_text_with_escapes(line: str, end: LineEnd, data: bytes) -> None:
    assert encoded(line, end, as_hex=False) == data


@pytest.mark.parametrize(
    ("line", "fault"),
    [(r"\q", "no escape"), ("a\\", "no escape"), (r"\x1", "no escape"), ("Ω", "no single byte")],
)
def test_text_that_stands_for_no_bytes(line: str, fault: str) -> None:
    with pytest.raises(ValueError, match=fault):
        encoded(line, "cr", as_hex=False)


def test_hex_bytes() -> None:
    assert encoded("31 3b0D ff", "none", as_hex=True) == b"1;\r\xff"
    assert encoded("", "cr", as_hex=True) == b"\r"
    with pytest.raises(ValueError, match="no row of hex bytes such as"):
        encoded("31 3", "none", as_hex=True)
