"""The emulated block of inputs and outputs over Modbus frames."""

import pytest

from catseye.simulators.config import EmulatedDevice, Option
from catseye.simulators.errors import EmulatorError
from catseye.simulators.modbus.emulators import io_block
from catseye.simulators.modbus.remote_io import COUNT, RemoteIo
from catseye.simulators.modbus.tcp import respond
from catseye.simulators.world.door import Door


def block(door: Door, **options: Option) -> RemoteIo:
    return io_block(door, EmulatedDevice("io", "modbus-io", options=options), [False] * COUNT)


def said(device: RemoteIo, request: str) -> str:
    return respond(device, bytes.fromhex(request)).hex(" ")


def test_the_doors_contact_is_a_discrete_input() -> None:
    door = Door()
    device = block(door, door_input=3)
    assert said(device, "02 0000 0008") == "02 01 08"
    door.closed = False
    assert said(device, "02 0003 0001") == "02 01 00"
    assert said(device, "01 0000 0008") == "01 01 00"


def test_coils_are_set_one_by_one_and_together() -> None:
    device = block(Door())
    assert said(device, "05 0001 ff00") == "05 00 01 ff 00"
    assert said(device, "0f 0002 0002 01 03") == "0f 00 02 00 02"
    assert said(device, "01 0000 0010") == "01 02 0e 00"
    assert device.coils[:4] == [False, True, True, True]


def test_a_contact_of_the_other_sense_among_the_coils() -> None:
    device = block(Door(), door_kind="coil", door_input=8, address_base=1, door_closed=False)
    assert said(device, "01 0007 0001") == "01 01 00"
    device.door.closed = False
    assert said(device, "01 0007 0001") == "01 01 01"


@pytest.mark.parametrize(
    "request_text", ["01 0010 0001", "02 000f 0002", "05 0010 ff00", "03 0000 0001", "06 0000 0001"]
)
def test_what_it_does_not_have_it_refuses(request_text: str) -> None:
    reply = said(block(Door()), request_text)
    assert reply == f"{int(request_text[:2], 16) | 0x80:02x} 02"


def test_a_contact_beyond_its_inputs_is_refused() -> None:
    with pytest.raises(EmulatorError, match="16 inputs"):
        block(Door(), door_input=16)
