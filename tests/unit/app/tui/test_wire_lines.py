"""Raw traffic as rows: every byte once, in its place."""

from hypothesis import given
from hypothesis import strategies as st

from catseye.app.protocol.bench import WireLine
from catseye.app.tui.wire_lines import ShownLine, bytes_a_row, rows_of, saved_line, shown_line


def came(data: str, size: int | None = None) -> ShownLine:
    """Return hex bytes of the interferometer as they are shown."""
    t = "2026-11-21T09:00:01.234567+00:00"
    return shown_line(WireLine(t=t, device="interferometer", dir="rx", hex=data, bytes=size))


def test_a_line_as_the_engine_sends_it() -> None:
    line = came("2b310d0a", 300)
    assert (line.time, line.device, line.dir) == ("09:00:01.234", "interferometer", "rx")
    assert (line.data, line.left_out, line.text) == (b"+1\r\n", 296, "+1..")
    assert saved_line(line) == "09:00:01.234 interferometer ← 2b 31 0d 0a |+1..| +296 bytes"


def test_a_healing_is_shown_as_text() -> None:
    why = "bytes came that nobody asked for: b'+1'"
    line = shown_line(
        WireLine(t="2026-11-21T09:00:01.234567Z", device="robot", dir="heal", hex=why.encode().hex())
    )
    rows = list(rows_of([line], 8))
    assert {row.arrow for row in rows} == {"!"}
    assert "".join(row.hex for row in rows) == why
    assert saved_line(line) == f"09:00:01.234 robot ! {why}"


@given(st.binary(max_size=256), st.sampled_from([4, 12, 32]))
def test_rows_hold_every_byte_in_order(data: bytes, per_row: int) -> None:
    rows = list(rows_of([came(data.hex())], per_row))
    assert bytes.fromhex("".join(row.hex for row in rows)) == data
    assert len(rows) == max(1, -(-len(data) // per_row))
    assert len({len(row.head) for row in rows}) == 1
    assert "".join(row.text[1 : row.text.rindex("│")] for row in rows) == came(data.hex()).text


def test_rows_are_as_wide_as_the_screen() -> None:
    for width in (60, 80, 100, 120, 200):
        row = next(rows_of([came("41" * 64)], bytes_a_row(width)))
        assert len(row.plain) <= width


def test_a_filter_looks_at_text_and_hex() -> None:
    line = came(b"1;1;OPENcatseye".hex())
    assert line.fits("", "opencat")
    assert line.fits("interferometer", "31 3b")
    assert not line.fits("robot", "")
    assert not line.fits("", "close")
