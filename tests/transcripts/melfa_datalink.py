"""Records of the data link: six numbers and a CR both ways, by the sheet's section 4 and the program CATSDL.

Requests stand as a PC writes them; answers with numbers in the notations that `Print #` may use, which the sheet
leaves open.
"""

ADD = b"7,1,10.0000,-20.5000,75.1250,90.0000\r"
"""Request 7: a via point at 10 deg, -20.5 deg, 75.125 mm, 90 deg."""

ADDED = b"7,1,1,0,0,0\r"
"""One point is in the queue."""

FULL = b"7,-2,3120,0,0,0\r"
"""The 61st point."""

ASK_FEEDBACK = b"8,3,0.0000,0.0000,0.0000,0.0000\r"

FEEDBACK = (10.0, -20.5, 75.125, 90.0)
"""J1 deg, J2 deg, J3 mm, J4 deg; all are exact in float32."""

ANSWERS = {
    "plain": b"8,3,10,-20.5,75.125,90\r",
    "fixed": b"8,3,+10.000,-20.500,+75.125,+90.000\r",
    "exponent": b"8,3,1.0000000E+01,-2.0500000E+01,7.5125000E+01,9.0000000E+01\r",
}
"""FEEDBACK by notation."""

FORGET, FORGOTTEN = b"9,4,0,0,0,0\r", b"9,4,0,0,0,0\r"

WHO, EMULATOR = b"1,5,0,0,0,0\r", b"1,5,1,4,0,1\r"
"""Version 1, four joints, an emulator."""

SPEED, SET = b"2,6,50,20,0,0\r", b"2,6,50,20,0,0\r"

FINISH, FINISHED = b"3,7,0,0,0,0\r", b"3,7,0,0,0,0\r"

STRANGE, UNKNOWN = b"4,12,0,0,0,0\r", b"4,-1,12,0,0,0\r"

BAD = (b"1,2,3,4,5\r", b"1,2,3,4,5,6,7\r", b"1,5,x,0,0,0\r", b"\r", b"1,5,,0,0,0\r", b"1,5,1e99,0,0,0\r")
"""Not six numbers: alarm L3500, no answer."""
