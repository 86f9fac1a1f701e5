"""Requests to KUKAVARPROXY as public clients pack them, with the answers that they understand.

Each is retyped from what a client's source says of its fields, for an arm whose override is 100 %, in this order.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Exchange:
    """One request with its answer.

    Attributes:
        source: repository and file.
        request: as sent.
        answer: as the client's checks want it.
    """

    source: str
    request: bytes
    answer: bytes


_OPENKUKA = (
    "OpenKuka/KukavarClient, src/OpenKuka.KukavarClient/Protocol/KVReadQuery.cs and KVAnswer.cs (a06bfa19)"
)
_GO = "selimserbes/go-openshowvar, pkg/openshowvar/go_openshowvar.go (01622088): the tag is always 0"
_JAVA = "aauc-mechlab/JOpenShowVar, networking/Request.java and Callback.java (09b8903b): tags stay below 256"
_PYTHON = "kyjanond/kukavarproxy-msg-format, python/kukavarproxy.py (147f5fa9)"
_KRC4 = "skilledAutomation/KUKAVARPROXY_KRC4, py_kukavarproxy4_client.py (c4509bc4)"

READ_OVERRIDE = bytes.fromhex("00 00 07 24 4F 56 5F 50 52 4F")
"""Type 0, seven characters, $OV_PRO."""

EXCHANGES = (
    Exchange(
        _OPENKUKA,
        bytes.fromhex("0000 0007 00 0004 50494E47"),
        bytes.fromhex("0000 000A 00 0004 504F4E47 000101"),
    ),
    Exchange(
        _OPENKUKA, b"\x00\x0f\x00\x0a" + READ_OVERRIDE, bytes.fromhex("000F 0009 00 0003 313030 000101")
    ),
    Exchange(_GO, b"\x00\x00\x00\x0a" + READ_OVERRIDE, bytes.fromhex("0000 0009 00 0003 313030 000101")),
    Exchange(
        _GO,
        bytes.fromhex("0000 000E 01 0007 244F565F50524F 0002 3530"),
        bytes.fromhex("0000 0008 01 0002 3530 000101"),
    ),
    Exchange(_JAVA, b"\x00\x2a\x00\x0a" + READ_OVERRIDE, bytes.fromhex("002A 0008 00 0002 3530 000101")),
    Exchange(
        _PYTHON,
        bytes.fromhex("0000 000B 00 0008 244D4F44455F4F50"),
        bytes.fromhex("0000 0009 00 0003 234558 000101"),
    ),
    Exchange(_KRC4, b"\x00\x01\x00\x0a" + READ_OVERRIDE, bytes.fromhex("0001 0008 00 0002 3530 000101")),
    # A failed read: no value, and a result that is not 1.
    Exchange(_KRC4, bytes.fromhex("0002 0008 00 0005 244E4F4E45"), bytes.fromhex("0002 0006 00 0000 000000")),
)

READ_ARRAY = Exchange(_KRC4, bytes.fromhex("0003 000E 02 000B 24524F42545241464F5B5D"), b"")
"""Only old proxies know type 2; this client takes fewer than five bytes behind the length for a failure."""

SEARCH = Exchange(_KRC4, bytes.fromhex("0004 0001 04"), b"")
"""In this proxy, which is neither KUKAVARPROXY nor C3 Bridge, types 4 and 5 find robots and set an address."""
