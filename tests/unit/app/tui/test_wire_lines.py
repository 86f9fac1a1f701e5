"""Raw traffic as rows: every byte once, in its place."""

from hypothesis import given
from hypothesis import strategies as st

from catseye.app.tui.wire_lines import bytes_a_row, rows_of, saved_line, wire_line

TOLD = {"t": "2026-11-21T09:00:01.234567+00:00", "device": "interferometer", "dir": "rx", "hex": "2b310d0a"}


def test_a_line_as_it_is_told() -> None:
    line = wire_line({**TOLD, "bytes": 300})
    assert (line.time, line.device, line.sent) == ("09:00:01.234", "interferometer", False)
    assert (line.data, line.left_out, line.text) == (b"+1\r\n", 296, "+1..")
    assert saved_line(line) == "09:00:01.234 interferometer ← 2b 31 0d 0a |+1..| +296 bytes"


@given(st.binary(max_size=256), st.sampled_from([4, 12, 32]))
def test_rows_hold_every_byte_in_order(data: bytes, per_row: int) -> None:
    rows = list(rows_of([wire_line({**TOLD, "hex": data.hex()})], per_row))
    assert bytes.fromhex("".join(row.hex for row in rows)) == data
    assert len(rows) == max(1, -(-len(data) // per_row))
    assert len({len(row.head) for row in rows}) == 1
    assert (
        "".join(row.text[1 : row.text.rindex("│")] for row in rows)
        == wire_line({**TOLD, "hex": data.hex()}).text
    )


def test_rows_are_as_wide_as_the_screen() -> None:
    for width in (60, 80, 100, 120, 200):
        row = next(rows_of([wire_line({**TOLD, "hex": "41" * 64})], bytes_a_row(width)))
        assert len(row.plain) <= width


def test_a_filter_looks_at_text_and_hex() -> None:
    line = wire_line({**TOLD, "hex": b"1;1;OPENcatseye".hex()})
    assert line.fits("", "opencat")
    assert line.fits("interferometer", "31 3b")
    assert not line.fits("robot", "")
    assert not line.fits("", "close")
