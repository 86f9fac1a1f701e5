"""Lines of the emulated line counter: the default commands of the sheet, answered in the emulator's own dialect.

No real instrument stands behind these bytes; a real counter's profile is completed from its manual.
"""

QUERY = b"R\r\n"
ZERO = b"Z\r\n"
STATUS = b"S\r\n"

AT_ZERO = b"+000000.000000 mm\r\n"
"""Answer to R after a zero."""

DONE = b"OK\r\n"
READY = b"10\r\n"
"""Answer to S: the laser is ready, nothing is wrong."""

BROKEN = b"15\r\n"
"""The beam is away and was lost."""

RETURNED = b"11\r\n"
"""The beam is back; the loss stays latched."""
