"""Bytes of the Heidenhain ND displays.

Sources: manual pages of ND 221, 231, 281 B and 287, the open client ogawa-ros/ogameasure for the ND 287. Of A0100
the manual of the ND 281 B (page 61) says that dialogs and errors on the display are sent too, of the error text that
it is for a displayed error only. The fields of the status bar are those that ogameasure 0.5.8 lists for A0800.
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

SHOWN_ERROR = b"\x02SIGNAL    \r\n"
"""Answer to A0100 with an error on the display; the text is the emulator's."""

STATUS_BAR = b"\x0200000011\r\n"
"""Answer of an ND 287 to A0800: actual value, X1, no scale, no compensation, no stopwatch, mm, datum 1, page 1."""

ACKNOWLEDGED = b"\x06"
REFUSED = b"\x15"
