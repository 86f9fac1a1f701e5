"""Datagrams of real-time control, put together by hand from the sheet's offsets (melfa, section 2).

The layout agrees with the public headers `strdef.h` of tork-a/melfa_robot (commit 6186bda) and `rt_exc_def.hpp` of
Mitsubishi-Electric-Asia/melfa_ros2_driver (commit 8a52cd2), both Apache-2.0; the bytes are no copy of a capture. In
JOINT data the axes are in rad, J3 of a SCARA in mm. Numbers are IEEE-754 float32, little-endian:

====================  ===========
10 deg, 0.17453292 rad  ``C2 B8 32 3E``
-20 deg, -0.34906585    ``C2 B8 B2 BE``
75.5 (mm)               ``00 00 97 42``
90 deg, 1.5707964       ``DB 0F C9 3F``
====================  ===========
"""

_NOTHING = "00 " * 40

_IO = "00 00 " * 5
"""Offsets 48 to 57: SendIOType, RecvIOType, BitTop, BitMask, IoData."""

_MONITORS = f"05 00 00 00 {_NOTHING} 08 00 00 00 {_NOTHING} 0B 00 00 00 {_NOTHING}"
"""From offset 64: RecvType1 filtered command, RecvType2 encoder feedback, RecvType3 current feedback."""

_JOINTS = f"C2 B8 32 3E C2 B8 B2 BE 00 00 97 42 DB 0F C9 3F {'00 ' * 24}"

JOINTS = (10.0, -20.0, 75.5, 90.0)
"""What the joint data stand for, J1 deg, J2 deg, J3 mm, J4 deg."""

WHERE = bytes.fromhex(f"00 00 00 00 02 00 00 00 {_NOTHING} {_IO} 00 00 01 00 00 00 {_MONITORS}")
"""Command 0, no data, RecvType 2, CCount 1: where does the arm stand."""

SET_POINT = bytes.fromhex(f"01 00 02 00 02 00 00 00 {_JOINTS} {_IO} 00 00 04 03 02 01 {_MONITORS}")
"""Command 1, SendType 2, JOINTS, CCount 0x01020304."""

END = bytes.fromhex(f"FF 00 00 00 02 00 00 00 {_NOTHING} {_IO} 00 00 03 00 00 00 {_MONITORS}")
"""Command 255, CCount 3."""

AT_JOINTS = bytes.fromhex(
    f"00 00 00 00 02 00 00 00 {_JOINTS} {_IO} 00 00 01 00 00 00"
    f"05 00 00 00 {_JOINTS} 08 00 00 00 {_JOINTS}"
    f"0B 00 00 00 00 00 00 00 00 00 00 00 14 00 00 00 {'00 ' * 28}"
)
"""Answer to WHERE of an arm that stands at JOINTS: command, filtered command and feedback agree.

The current feedback, 0, 0, 20 and 0 % of rated (J3 carries its weight), is the emulator's assumption.
"""
