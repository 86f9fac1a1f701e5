"""Lines from the manual of the LD5, section 4. Driver and emulator are held to the same bytes."""

IDENTITY = (b"ID\r\n", b"IDNORRA LD5,1.04,00217\r\n")
POSITION = (b"1TP\r\n", b"1TP-0012.345678\r\n")
STATUS = (b"1TS\r\n", b"1TS1,0,0,1,080\r\n")
STATUS_LOST = (b"1TS\r\n", b"1TS0,1,0,1,000\r\n")
ZERO = (b"1ZR\r\n", b"1ZR\r\n")
ZERO_REFUSED = (b"1ZR\r\n", b"?C NO BEAM\r\n")
UNKNOWN = (b"1XX\r\n", b"?A UNKNOWN COMMAND\r\n")
