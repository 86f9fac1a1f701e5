"""Registers, coils and inputs of one device over Modbus TCP and RTU."""

import asyncio
from collections.abc import Awaitable, Callable
from functools import partial
from typing import Protocol, TypeVar

from catseye.drivers.links.endpoint import SerialEndpoint, TcpEndpoint, open_transport
from catseye.drivers.links.link import RequestLink
from catseye.drivers.links.serial_line import LineSettings
from catseye.drivers.modbus import codec
from catseye.drivers.roles.device import Identity, Sink
from catseye.drivers.roles.errors import LinkTimeoutError, ProtocolError, RefusedError, WrongDeviceError

_EXCEPTIONS = {
    1: "illegal function: set function to 3 or 4 as the device's manual says",
    2: "illegal data address: check map, the addresses and address_base",
    3: "illegal data value: check kind and the addresses",
    4: "device failure: see the device's manual",
    6: "device busy: give it longer pauses",
    11: "gateway target does not answer: check device_id and the wiring behind the gateway",
}
_LAST_NUMBER = 0xFFFF

_SILENT_CHARACTERS = 3.5
_SHORT_CHARACTERS_BAUD = 19200
_SHORTEST_GAP_S = 0.00175

T = TypeVar("T")


class ModbusDevice(Protocol):
    """What every driver over Modbus asks of its client."""

    async def open(self) -> None:
        """Connect."""
        ...

    async def close(self) -> None:
        """Disconnect."""
        ...

    async def identify(self) -> dict[int, str]:
        """Return the objects of function 43/14."""
        ...


async def connected(device: ModbusDevice, look: Callable[[], Awaitable[object]], model: str) -> Identity:
    """Open the link, ask who is there and for a first value, which a stranger cannot give.

    Args:
        look: asks for the value.
        model: what to call a device that does not name itself.

    Raises:
        DeviceError: unreachable, or whatever `look` finds; the link is closed then.
    """
    await device.open()
    try:
        names = await _names_of(device)
        await look()
    except BaseException:
        await device.close()
        raise
    return Identity(
        model=" ".join(filter(None, (names.get(0, ""), names.get(1, "")))) or model,
        firmware=names.get(2, ""),
        serial=names.get(0x80, ""),
        simulated="EMULATOR" in names.get(0, "").upper(),
    )


async def _names_of(device: ModbusDevice) -> dict[int, str]:
    try:
        return await device.identify()
    except (RefusedError, LinkTimeoutError):
        # Function 43/14 is optional; a device without it may also keep silent.
        return {}


class RegisterClient:
    """Reads and writes registers, coils and inputs of one device.

    Over TCP every answer carries the number of its request, so a late one is never mistaken. RTU has no numbers:
    after a silence the port is closed, opened again, and what still comes within another time-out is left out.

    Args:
        target: socket, or serial line for RTU.
        device_id: unit identifier.
        timeout_s: for connecting, real s.
        answer_timeout_s: for an answer, real s; `timeout_s` by default.
    """

    def __init__(
        self,
        target: TcpEndpoint | SerialEndpoint,
        *,
        device_id: int = 1,
        name: str = "air sensor",
        timeout_s: float = 3.0,
        answer_timeout_s: float | None = None,
        sink: Sink | None = None,
    ) -> None:
        self._endpoint = str(target)
        self._is_line = isinstance(target, SerialEndpoint)
        self._decoder = codec.RtuDecoder if self._is_line else codec.TcpDecoder
        self._device_id = device_id
        self._answer_timeout_s = answer_timeout_s or timeout_s
        transport = open_transport(self._endpoint, connect_timeout_s=timeout_s, sink=sink)
        gap_s = _gap_s(target.settings) if isinstance(target, SerialEndpoint) else 0.0
        self._link = RequestLink(
            transport, name=name, greet=self._let_late_answer_pass, harmless=b"", gap_s=gap_s
        )
        self._number = 0
        self._answered = self._garbled = False
        self._late_until_s = 0.0

    @property
    def endpoint(self) -> str:
        """Where it leads."""
        return self._endpoint

    async def open(self) -> None:
        """Connect.

        Raises:
            LinkError: unreachable.
        """
        await self._link.open()

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        await self._link.close()

    async def read(self, function: int, address: int, count: int) -> list[int]:
        """Return registers, on a new connection if the old one was lost; asked again when the answer is.

        Args:
            function: 3 for holding, 4 for input registers.
            address: as sent.

        Raises:
            RefusedError: the sensor answers with an exception.
            LinkError: lost or silent.
            ProtocolError: garbage, or another number of registers came.
        """
        what = f"{count} registers from 0x{address:04X} by function {function}"
        request = codec.read_request(function, address, count)
        parse = partial(codec.parse_registers, count)
        return await self._link.repeated(partial(self._ask, what, request, parse))

    async def read_bits(self, function: int, address: int, count: int) -> list[bool]:
        """Return coils or inputs, on a new connection if the old one was lost.

        Args:
            function: 1 for coils, 2 for discrete inputs.
            address: as sent.

        Raises:
            RefusedError: the device answers with an exception.
            LinkError: lost or silent.
            ProtocolError: garbage or too few bits came.
        """
        what = f"{count} bits from 0x{address:04X} by function {function}"
        request = codec.read_request(function, address, count)
        return await self._ask(what, request, partial(codec.parse_bits, count))

    async def write_bits(self, address: int, bits: list[bool]) -> None:
        """Set coils by function 15. A lost answer is an error: whether they were set is then unknown.

        Args:
            address: of the first one, as sent.

        Raises:
            RefusedError: the device answers with an exception.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        what = f"writing {len(bits)} coils at 0x{address:04X}"
        request = codec.write_coils_request(address, bits)
        await self._ask(what, request, partial(codec.check_written, request))

    async def identify(self) -> dict[int, str]:
        """Return the objects of function 43/14: 0 vendor, 1 product, 2 revision, 0x80 serial; garbage is asked again.

        Raises:
            RefusedError: the sensor does not know the function.
            LinkError: lost or silent.
            ProtocolError: garbage came twice.
            WrongDeviceError: garbage came twice, and never an answer.
        """
        ask = partial(self._ask, "the identification", codec.identify_request(), codec.parse_objects)
        try:
            return await ask()
        except ProtocolError:
            # Silence is not asked again: not every device knows the function.
            return await ask()

    async def _ask(self, what: str, request: bytes, parse: Callable[[bytes], T]) -> T:
        """Return what the answer to one request says; others wait for their turn."""
        self._number = self._number % _LAST_NUMBER + 1
        frame = self._decoder.frame(self._number, self._device_id, request)
        decoder = partial(self._decoder, self._number, self._device_id, request[0])
        try:
            answer = await self._link.request(frame, decoder, self._answer_timeout_s)
        except (LinkTimeoutError, ProtocolError) as exc:
            raise self._explained(what, exc) from None
        finally:
            self._late_until_s = asyncio.get_running_loop().time() + self._answer_timeout_s
        self._answered = True
        if number := codec.exception_of(answer):
            meaning = _EXCEPTIONS.get(number, "see the device's manual")
            raise RefusedError(f"{self._link.where} refused {what}: exception {number}, {meaning}", number)
        try:
            return parse(answer)
        except ProtocolError as exc:
            self._link.distrust(f"{what} had an answer that does not fit")
            raise ProtocolError(
                f"{self._link.where}: {exc} for {what}; last bytes {self._link.last_bytes!r}: check that this is the "
                "Modbus device meant"
            ) from None

    def _explained(self, what: str, cause: LinkTimeoutError | ProtocolError) -> Exception:
        """Return the error of an answer that did not come: of silence, of a disturbed line or of a stranger."""
        came = self._link.last_bytes
        if not came:
            return LinkTimeoutError(
                f"{self._link.where}: no answer to {what} within {self._answer_timeout_s:g} s, no byte came: check "
                "device_id and that the device is not busy with other clients"
            )
        # Noise while a line is opened makes nobody a stranger; who never answers but sends garbage twice is one.
        if self._answered or not self._garbled:
            self._garbled = True
            return ProtocolError(
                f"{self._link.where}: garbage in place of an answer to {what}: {came!r}: check the line; {cause}"
            )
        suspects = "baud, parity and stopbits of the endpoint" if self._is_line else "host and port"
        return WrongDeviceError(
            f"{self._link.where}: no Modbus answer to {what}, but the bytes {came!r}: check {suspects} in the cell "
            f"file; {cause}"
        )

    async def _let_late_answer_pass(self) -> None:
        """Leave out an answer without a number before the next question is asked on a line opened again."""
        if self._is_line:
            await self._link.discard(self._late_until_s)


def _gap_s(line: LineSettings) -> float:
    """Return the silence that divides two frames, s (MODBUS over Serial Line V1.02, 2.5.1.1)."""
    if line.baud > _SHORT_CHARACTERS_BAUD:
        return _SHORTEST_GAP_S
    return _SILENT_CHARACTERS * line.character_s
