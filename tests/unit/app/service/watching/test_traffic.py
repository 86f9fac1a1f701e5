"""What goes over the wires: shortened, bounded, counted, and only while somebody listens."""

from catseye.app.service.watching.traffic import MOST_LINES, SHOWN_BYTES, Traffic
from tests.unit.app.engine.fakes import ManualClock


def test_nothing_is_kept_while_nobody_listens() -> None:
    traffic = Traffic(ManualClock())
    traffic.record("robot", "tx", b"1;1;STATE\r")
    assert traffic.take() is None


def test_lines_are_taken_once_and_long_ones_truncated() -> None:
    traffic = Traffic(ManualClock())
    traffic.listening = True
    traffic.record("robot", "tx", b"\x00\xff")
    traffic.record("umd", "rx", bytes(SHOWN_BYTES))
    traffic.record("umd", "rx", bytes(SHOWN_BYTES + 1))
    time_utc = "2026-01-02T03:04:05+00:00"
    line = {"t": time_utc, "device": "umd", "dir": "rx", "hex": "00" * SHOWN_BYTES}
    wire = traffic.take()
    assert wire is not None
    fields = wire.json_object()
    assert {name: fields[name] for name in ("lines", "missed")} == {
        "lines": [
            {"t": time_utc, "device": "robot", "dir": "tx", "hex": "00ff"},
            line,
            {**line, "bytes": SHOWN_BYTES + 1},
        ],
        "missed": 0,
    }
    assert traffic.take() is None


def test_excess_lines_are_counted_and_the_newest_kept() -> None:
    traffic = Traffic(ManualClock())
    traffic.listening = True
    for number in range(MOST_LINES + 50):
        traffic.record("umd", "rx", number.to_bytes(2))
    taken = traffic.take()
    assert taken is not None
    assert [line.hex for line in taken.lines] == [
        number.to_bytes(2).hex() for number in range(50, MOST_LINES + 50)
    ]
    assert taken.missed == 50
    traffic.record("umd", "rx", b"x")
    again = traffic.take()
    assert again is not None
    assert again.missed == 0
