"""The driver of remote inputs and outputs over scripted coils."""

import pytest
from pydantic import ValidationError

from catseye.drivers.io.modbus_io import IoSettings, ModbusIo
from catseye.drivers.roles.errors import LinkError, LinkTimeoutError, RefusedError
from tests.unit.drivers.modbus_peers import RtuDevice
from tests.unit.drivers.peers import StepClock
from tests.unit.drivers.virtual_time import run


class Block:
    """Coils and inputs in memory."""

    def __init__(self) -> None:
        self.bits = {1: [False] * 8, 2: [False] * 8}
        self.names: dict[int, str] = {0: "Maker", 1: "block", 2: "2.0"}
        self.reads: list[tuple[int, int, int]] = []
        self.open_count = 0

    async def open(self) -> None:
        self.open_count += 1

    async def close(self) -> None:
        self.open_count = 0

    async def read_bits(self, function: int, address: int, count: int) -> list[bool]:
        self.reads.append((function, address, count))
        if address + count > 8:
            raise RefusedError("exception 2", 2)
        return self.bits[function][address : address + count]

    async def write_bits(self, address: int, bits: list[bool]) -> None:
        self.bits[1][address : address + len(bits)] = bits

    async def identify(self) -> dict[int, str]:
        if not self.names:
            raise RefusedError("exception 1", 1)
        return self.names


async def test_the_door_is_one_input() -> None:
    block = Block()
    io = ModbusIo(block, IoSettings(door_input=3))
    assert not await io.door_closed()
    block.bits[2][3] = True
    assert await io.door_closed()
    assert block.reads == [(2, 3, 1)] * 2


async def test_an_inverted_door_contact_may_be_a_coil() -> None:
    block = Block()
    io = ModbusIo(
        block,
        IoSettings(
            door_input=5,
            door_kind="coil",
            door_closed=False,
            address_base=1,
            green_coil=1,
            amber_coil=2,
            red_coil=3,
        ),
    )
    assert await io.door_closed()
    assert block.reads == [(1, 4, 1)]


async def test_one_lamp_is_lit() -> None:
    block = Block()
    io = ModbusIo(block, IoSettings(green_coil=4, amber_coil=None, red_coil=6))
    for light, lit in (("green", [4]), ("red", [6]), ("amber", []), ("off", [])):
        await io.show(light)  # type: ignore[arg-type]  # the loop's words are the driver's
        assert [n for n, bit in enumerate(block.bits[1]) if bit] == lit


async def test_connecting_returns_the_identity() -> None:
    block = Block()
    identity = await ModbusIo(block, IoSettings()).connect()
    assert (identity.model, identity.firmware, identity.simulated) == ("Maker block", "2.0", False)
    block.names = {}
    assert (await ModbusIo(block, IoSettings()).connect()).model == "Modbus remote I/O"


async def test_a_block_without_the_doors_contact_is_let_go() -> None:
    block = Block()
    with pytest.raises(RefusedError):
        await ModbusIo(block, IoSettings(door_input=9)).connect()
    assert block.open_count == 0


@pytest.mark.parametrize(
    "settings", [{"green_coil": 2}, {"address_base": 1}, {"door": 1}, {"door_input": -1}, {"door_closed": 1}]
)
def test_wrong_settings_are_refused(settings: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        IoSettings.model_validate(settings)


def test_a_datagram_endpoint_is_refused() -> None:
    with pytest.raises(LinkError, match="datagrams"):
        ModbusIo.at("udp://127.0.0.1:502", StepClock())


def test_the_answer_timeout_is_limited_to_allow_a_retry() -> None:
    assert IoSettings().answer_timeout_s == 0.1
    with pytest.raises(ValidationError, match=r"less than or equal to 0\.1"):
        IoSettings(answer_timeout_s=0.2)


def test_a_line_leaves_time_for_a_late_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    async def asked() -> None:
        async with RtuDevice(lambda _: [], monkeypatch):
            io = ModbusIo.at("serial:///dev/line", StepClock())
            with pytest.raises(LinkTimeoutError, match=r"within 0\.07 s"):
                await io.connect()

    run(asked())
