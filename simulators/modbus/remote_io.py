"""A block of remote inputs and outputs: 16 coils, 16 discrete inputs, a door's contact at one of them."""

from dataclasses import dataclass, field

from catseye.simulators.modbus.exceptions import ILLEGAL_ADDRESS, ModbusError
from catseye.simulators.modbus.tcp import Registers
from catseye.simulators.world.door import Door

COUNT = 16


@dataclass
class RemoteIo(Registers):
    """Coils and inputs.

    Attributes:
        door: what the contact watches.
        coils: outputs, one for each address.
        door_address: of the contact, as transmitted.
        door_is_coil: the contact stands among the coils.
        closed_reads: what it reads while the door is closed.
        identity: identification objects.
    """

    door: Door
    coils: list[bool]
    door_address: int = 0
    door_is_coil: bool = False
    closed_reads: bool = True
    identity: dict[int, str] = field(
        default_factory=lambda: {0: "EMULATOR of catseye", 1: "remote inputs and outputs", 2: "1.0"}
    )

    def read_bits(self, address: int, count: int) -> list[bool]:
        """Return the outputs; the door stands among them where the block reads it as a coil."""
        _require(address, count)
        shown = list(self.coils)
        if self.door_is_coil:
            shown[self.door_address] = self._contact
        return shown[address : address + count]

    def read_inputs(self, address: int, count: int) -> list[bool]:
        """Return the inputs, the door's contact among them."""
        _require(address, count)
        shown = [False] * COUNT
        if not self.door_is_coil:
            shown[self.door_address] = self._contact
        return shown[address : address + count]

    def write_bits(self, address: int, bits: list[bool]) -> None:
        """Set coils."""
        _require(address, len(bits))
        self.coils[address : address + len(bits)] = bits

    @property
    def _contact(self) -> bool:
        return self.door.closed is self.closed_reads


def _require(address: int, count: int) -> None:
    if address + count > COUNT:
        raise ModbusError(ILLEGAL_ADDRESS)
