"""What our emulated devices would say if they were other ones, where the suite's own words do not reach."""

import struct
from typing import Any

from catseye.app.testing.candidate import Candidate
from catseye.simulators.lasertex.frames import frame
from catseye.simulators.leica.information import SERIAL
from catseye.simulators.umd.display import MARK

_FRAME_BYTES = 16


def _unmarked_hpi(data: bytes) -> bytes:
    """Take the mark out of the acknowledgements, whose checksum it changes."""
    pieces = (data[at : at + _FRAME_BYTES] for at in range(0, len(data), _FRAME_BYTES))
    return b"".join(frame(int.from_bytes(p[1:3], "big"), b"") if b"EMULATOR" in p else p for p in pieces)


def _unmarked_umd(data: bytes) -> bytes:
    return data.replace(str(MARK).encode(), b"0")


def _another_melfa(data: bytes, serial: str) -> bytes:
    return data.replace(f"maker;1;{serial};8".encode(), b"maker;1;2;8")


def _another_leica(data: bytes, serial: str) -> bytes:
    assert serial == str(SERIAL)
    return data.replace(struct.pack("<i", SERIAL), struct.pack("<i", SERIAL + 1))


OTHERS: dict[str, dict[str, Any]] = {
    "lasertex-hpi": {"unmarked": _unmarked_hpi},
    "umd": {"unmarked": _unmarked_umd},
    "leica-emscon": {"exchanged": _another_leica},
    **{name: {"exchanged": _another_melfa} for name in ("melfa-r3", "melfa-datalink", "melfa-mxt")},
}
"""Fields of `Candidate` by driver."""

WITHOUT_SERIAL = frozenset(
    {
        "abb-rws",
        "attocube-ids",
        "bench-tracker",
        "heidenhain-nd",
        "lasertex-hpi",
        "line-counter",
        "modbus-air",
        "modbus-io",
        "t2sa",
        "umd",
    }
)
"""Drivers whose instruments give no serial number on the link."""


def inapplicable(candidate: Candidate) -> set[str]:
    """Return the checks of which only the device itself shows that they do not apply."""
    return {"another_serial_number_is_noticed"} if candidate.name in WITHOUT_SERIAL else set()
