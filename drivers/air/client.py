"""The only module that touches pymodbus: registers over Modbus TCP and RTU."""

import asyncio
import logging
from collections.abc import Awaitable, Callable
from typing import TypeVar

from pymodbus import FramerType
from pymodbus.client import AsyncModbusSerialClient, AsyncModbusTcpClient
from pymodbus.exceptions import ModbusException
from pymodbus.pdu import ModbusPDU
from pymodbus.pdu.mei_message import ReadDeviceInformationResponse

from drivers.endpoint import SerialEndpoint, TcpEndpoint
from drivers.errors import (
    LinkError,
    LinkTimeoutError,
    ProtocolError,
    RefusedError,
    UnreachableError,
    WrongDeviceError,
)
from drivers.healing import Losses, repeated
from drivers.record import Sink
from drivers.serial_line import is_pseudo_terminal

# The library reports through its logger what is raised here anyway; a program without log handlers would print it.
logging.getLogger("pymodbus").addHandler(logging.NullHandler())

_EXCEPTIONS = {
    1: "illegal function: set function to 3 or 4 as the device's manual says",
    2: "illegal data address: check map, the addresses and address_base",
    3: "illegal data value: check kind and the addresses",
    4: "device failure: see the device's manual",
    6: "device busy: give it longer pauses",
    11: "gateway target does not answer: check device_id and the wiring behind the gateway",
}
_SHOWN_BYTES = 80

T = TypeVar("T")


async def _cancellable(call: Awaitable[T]) -> T:
    """Await the library, which up to Python 3.11 drops a cancellation that comes together with its result."""
    task = asyncio.ensure_future(call)
    try:
        await asyncio.wait({task})
    except asyncio.CancelledError:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        raise
    return task.result()


_Client = AsyncModbusTcpClient | AsyncModbusSerialClient


class RegisterClient:
    """Reads and writes registers, coils and inputs of one device.

    Over TCP every answer carries the number of its request, so a late one is never mistaken. RTU has no numbers:
    after a silence the port is closed, opened again, and a time-out is waited for what may still come.

    Args:
        target: socket, or serial line for RTU.
        device_id: unit identifier.
        name: what to call the device in texts.
        timeout_s: for connecting, real s.
        answer_timeout_s: for an answer, real s; `timeout_s` by default.
        sink: is shown all bytes.
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
        self._target = target
        self._name = name
        self._device_id = device_id
        self._timeout_s = timeout_s
        self._answer_timeout_s = answer_timeout_s or timeout_s
        self._sink = sink
        self._client: _Client | None = None
        self._received = b""
        self._lock = asyncio.Lock()
        self._in_doubt = False
        self._answered = False
        self._losses = Losses()

    @property
    def endpoint(self) -> str:
        """Where it leads."""
        return str(self._target)

    async def open(self) -> None:
        """Connect; an open link is kept.

        Raises:
            LinkError: unreachable.
        """
        if self._client and self._client.connected and not self._in_doubt:
            return
        await self.close()
        client = self._new_client()
        if not await self._connects(client):
            advice = (
                "the device path, and that no other program holds the port"
                if isinstance(self._target, SerialEndpoint)
                else "that it is switched on, address and port (502 is usual), and how many clients it serves at once"
            )
            raise UnreachableError(
                f"{self._name} at {self.endpoint}: cannot connect within {self._timeout_s:g} s: check {advice}"
            )
        self._client = client
        if self._in_doubt and isinstance(self._target, SerialEndpoint):
            # An answer without a number must have passed before the next question is asked.
            await asyncio.sleep(self._answer_timeout_s)
        self._in_doubt = False

    async def _connects(self, client: _Client) -> bool:
        try:
            return await _cancellable(client.connect())
        except asyncio.CancelledError:
            # It may have come just then.
            client.close()
            raise

    def _new_client(self) -> _Client:
        target = self._target
        if isinstance(target, TcpEndpoint):
            return AsyncModbusTcpClient(
                target.host,
                port=target.port,
                timeout=self._timeout_s,
                retries=0,
                reconnect_delay=0,
                trace_packet=self._trace,
            )
        # A pseudo-terminal has no parity and refuses it when the library sets up the port a second time.
        emulated = is_pseudo_terminal(target.device)
        return AsyncModbusSerialClient(
            target.device,
            framer=FramerType.RTU,
            baudrate=target.baud,
            bytesize=target.bits,
            parity="N" if emulated else target.parity,
            stopbits=2 if target.stopbits == "2" else 1,
            timeout=self._timeout_s,
            retries=0,
            reconnect_delay=0,
            trace_packet=self._trace,
        )

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        if self._client:
            self._client.close()
            self._client = None
            # The socket is closed in the loop's next turn.
            await asyncio.sleep(0)

    async def read(self, function: int, address: int, count: int) -> list[int]:
        """Return registers, on a new connection if the old one was lost; asked again when the answer is.

        Args:
            function: 3 for holding, 4 for input registers.
            address: as sent.
            count: how many.

        Raises:
            RefusedError: the sensor answers with an exception.
            LinkError: lost or silent.
            ProtocolError: another number of registers came.
        """
        what = f"{count} registers from 0x{address:04X} by function {function}"

        def call(client: _Client) -> Awaitable[ModbusPDU]:
            read = client.read_holding_registers if function == 3 else client.read_input_registers
            return read(address, count=count, device_id=self._device_id)

        answer = await repeated(
            lambda: self._ask(what, call), self._losses, f"{self._name} at {self.endpoint}"
        )
        if len(answer.registers) != count:
            raise ProtocolError(
                f"{self._name} at {self.endpoint}: {len(answer.registers)} registers came for {what}; "
                f"last bytes {self._received!r}: check that this is the Modbus device meant"
            )
        return list(answer.registers)

    async def read_bits(self, function: int, address: int, count: int) -> list[bool]:
        """Return coils or inputs, on a new connection if the old one was lost.

        Args:
            function: 1 for coils, 2 for discrete inputs.
            address: as sent.
            count: how many.

        Raises:
            RefusedError: the device answers with an exception.
            LinkError: lost or silent.
            ProtocolError: too few bits came.
        """
        what = f"{count} bits from 0x{address:04X} by function {function}"

        def call(client: _Client) -> Awaitable[ModbusPDU]:
            read = client.read_coils if function == 1 else client.read_discrete_inputs
            return read(address, count=count, device_id=self._device_id)

        answer = await self._ask(what, call)
        if len(answer.bits) < count:
            raise ProtocolError(f"{self._name} at {self.endpoint}: {len(answer.bits)} bits came for {what}")
        return list(answer.bits[:count])

    async def write_bits(self, address: int, bits: list[bool]) -> None:
        """Set coils by function 15. A lost answer is an error: whether they were set is then unknown.

        Args:
            address: of the first one, as sent.
            bits: what to set.

        Raises:
            RefusedError: the device answers with an exception.
            LinkError: lost or silent.
        """
        what = f"writing {len(bits)} coils at 0x{address:04X}"
        await self._ask(what, lambda client: client.write_coils(address, bits, device_id=self._device_id))

    async def identify(self) -> dict[int, str]:
        """Return the objects of function 43/14: 0 vendor, 1 product, 2 revision, 0x80 serial.

        Raises:
            RefusedError: the sensor does not know the function.
            LinkError: lost or silent.
        """
        answer = await self._ask(
            "the identification", lambda client: client.read_device_information(device_id=self._device_id)
        )
        information = answer.information if isinstance(answer, ReadDeviceInformationResponse) else {}
        return {
            key: value.decode("latin-1") for key, value in information.items() if isinstance(value, bytes)
        }

    async def _ask(self, what: str, call: Callable[[_Client], Awaitable[ModbusPDU]]) -> ModbusPDU:
        """Return the answer to one request; others wait for their turn."""
        async with self._lock:
            client = await self._connected()
            # Until the answer is there; whoever is cancelled meanwhile leaves an answer behind.
            self._in_doubt = True
            try:
                async with asyncio.timeout(self._answer_timeout_s):
                    answer = await _cancellable(call(client))
            except (ModbusException, TimeoutError) as exc:
                self._losses.lost()
                raise await self._lost(what, exc) from None
            self._in_doubt = False
            self._answered = True
            self._losses.answered()
        self._check(what, answer)
        return answer

    async def _connected(self) -> _Client:
        await self.open()
        if not self._client:
            raise LinkError(f"{self._name} at {self.endpoint}: not connected: connect first")
        return self._client

    def _check(self, what: str, answer: ModbusPDU) -> None:
        if answer.isError():
            code = answer.exception_code
            meaning = _EXCEPTIONS.get(code, "see the device's manual")
            raise RefusedError(
                f"{self._name} at {self.endpoint} refused {what}: exception {code}, {meaning}", code
            )

    async def _lost(
        self, what: str, cause: ModbusException | TimeoutError
    ) -> LinkError | ProtocolError | WrongDeviceError:
        """Close the link, so that the next request opens it anew, and return the error."""
        await self.close()
        if self._received and self._answered:
            return ProtocolError(
                f"{self._name} at {self.endpoint}: garbage in place of an answer to {what}: {self._received!r}: "
                f"check the line; {cause}"
            )
        if self._received:
            return WrongDeviceError(
                f"{self._name} at {self.endpoint}: no Modbus answer to {what}, but the bytes {self._received!r}: "
                f"check {self._suspects} in the cell file; {cause}"
            )
        return LinkTimeoutError(
            f"{self._name} at {self.endpoint}: no answer to {what} within {self._answer_timeout_s:g} s, no byte "
            f"came: check device_id and that the device is not busy with other clients; {cause}"
        )

    @property
    def _suspects(self) -> str:
        serial = isinstance(self._target, SerialEndpoint)
        return "baud, parity and stopbits of the endpoint" if serial else "host and port"

    def _trace(self, sending: bool, data: bytes) -> bytes:
        """Show bytes to the sink. The library hands over what has piled up, not what has just come."""
        if sending:
            self._received = b""
            new = data
        else:
            more = data.startswith(self._received) and len(data) > len(self._received)
            new = data[len(self._received) :] if more else data
            self._received = data[-_SHOWN_BYTES:] if len(data) > _SHOWN_BYTES else data
        if self._sink:
            self._sink("tx" if sending else "rx", new)
        return data
