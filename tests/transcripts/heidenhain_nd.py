"""Bytes of the Heidenhain ND displays.

Sources: manual pages of ND 221, 231, 281 B and 287, the open client ogawa-ros/ogameasure for the ND 287.
Commands are ESC, letter, four digits, CR; values come behind STX and end with CR LF.
"""

COMMANDS = {
    "A0000": b"\x1bA0000\r",
    "A0100": b"\x1bA0100\r",
    "A0200": b"\x1bA0200\r",
    "A0301": b"\x1bA0301\r",
    "T0104": b"\x1bT0104\r",
}

POSITION = b"\x02-000123456\r\n"
"""Answer to A0200: sign and 9 digits, no decimal point."""

DISPLAYED = b"\x02+0012.3456\r\n"
"""Answer to A0100: 10 characters with the decimal point."""

IDENTITY = b"\x02ND 287    \r\n349797-01 \r\n1.0       \r\n"
"""Answer to A0000: three lines of ten characters."""

INDICATORS = b"\x0212000000000000\r\n"
"""Answer to A0900: REF on, datum 1 blinks."""

ACKNOWLEDGED = b"\x06"
REFUSED = b"\x15"
