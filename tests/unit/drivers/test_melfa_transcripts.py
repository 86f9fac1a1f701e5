"""The drivers of real-time control and data link against the bytes that the emulators are held to as well."""

import pytest

from catseye.drivers.melfa.datalink import codec as records
from catseye.drivers.melfa.datalink.codec import Record, RecordDecoder
from catseye.drivers.melfa.mxt import codec as datagrams
from catseye.drivers.melfa.mxt.codec import Command, Kind
from catseye.drivers.roles.errors import ProtocolError
from tests.transcripts import melfa_datalink, melfa_mxt


def test_datagrams_that_go_out() -> None:
    assert datagrams.encode(Command.NONE, 1) == melfa_mxt.WHERE
    assert datagrams.encode(Command.MOVE, 0x01020304, melfa_mxt.JOINTS) == melfa_mxt.SET_POINT
    assert datagrams.encode(Command.END, 3) == melfa_mxt.END


def test_the_datagram_that_comes() -> None:
    reply = datagrams.decode(melfa_mxt.AT_JOINTS)
    assert (reply.command, reply.t_count, reply.c_count) == (0, 0, 1)
    for kind in (Kind.JOINT_COMMAND, Kind.JOINT_FILTERED, Kind.JOINT_FEEDBACK):
        assert reply.joints(kind) == pytest.approx(melfa_mxt.JOINTS, abs=1e-5)


def test_records_that_go_out() -> None:
    assert records.encode(7, records.ADD, (10.0, -20.5, 75.125, 90.0)) == melfa_datalink.ADD
    assert records.encode(8, records.FEEDBACK) == melfa_datalink.ASK_FEEDBACK


@pytest.mark.parametrize("line", melfa_datalink.ANSWERS.values(), ids=melfa_datalink.ANSWERS)
def test_feedback_in_every_notation(line: bytes) -> None:
    record = RecordDecoder().feed(line)
    assert record == Record(8, 3, melfa_datalink.FEEDBACK)


def test_records_that_come() -> None:
    assert RecordDecoder().feed(melfa_datalink.FULL) == Record(7, records.REFUSED, (3120.0, 0.0, 0.0, 0.0))
    assert RecordDecoder().feed(melfa_datalink.UNKNOWN) == Record(4, records.UNKNOWN, (12.0, 0.0, 0.0, 0.0))
    for line in melfa_datalink.BAD[:2]:
        with pytest.raises(ProtocolError):
            RecordDecoder().feed(line)
