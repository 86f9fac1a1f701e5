"""Data link and real-time control over real sockets, beside the R-protocol of the same controller."""

import asyncio
import struct

import pytest

from catseye.simulators.config import EmulatedDevice, EmulationConfig
from catseye.simulators.emulated_bench import EmulatedBench
from catseye.simulators.errors import EmulatorError
from tests.patience import HANG_S
from tests.transcripts import melfa_datalink, melfa_mxt
from tests.unit.simulators.benches import P1


def config(*devices: EmulatedDevice) -> EmulationConfig:
    """Return a bench whose arm stands at the joints of the transcript."""
    return EmulationConfig(reflectors=(P1,), start_joints=melfa_mxt.JOINTS, devices=devices)


class Datagrams(asyncio.DatagramProtocol):
    """A PC's socket."""

    def __init__(self) -> None:
        self.came: asyncio.Queue[bytes] = asyncio.Queue()

    def datagram_received(self, data: bytes, addr: object) -> None:  # noqa: ARG002  # asyncio's signature
        self.came.put_nowait(data)


def address(bench: EmulatedBench, protocol: str) -> tuple[str, int]:
    """Return where a protocol is spoken."""
    (served,) = [endpoint for endpoint in bench.endpoints if endpoint.protocol == protocol]
    host, _, port = served.endpoint.rpartition("//")[2].rpartition(":")
    return host, int(port)


async def test_real_time_control_over_udp() -> None:
    async with EmulatedBench(config(EmulatedDevice("robot", "melfa-mxt", "udp://127.0.0.1:0"))) as bench:
        loop = asyncio.get_running_loop()
        transport, pc = await loop.create_datagram_endpoint(
            Datagrams, remote_addr=address(bench, "melfa-mxt")
        )
        try:
            transport.sendto(melfa_mxt.WHERE)
            assert await asyncio.wait_for(pc.came.get(), HANG_S) == melfa_mxt.AT_JOINTS
            bench.controller.switch_servo_on()
            bench.bench.advance(2.0)
            transport.sendto(melfa_mxt.SET_POINT)
            answer = await asyncio.wait_for(pc.came.get(), HANG_S)
            assert struct.unpack_from("<2HI", answer, 0)[:2] == (1, 2)
            transport.sendto(melfa_mxt.END)
            assert (await asyncio.wait_for(pc.came.get(), HANG_S))[:2] == b"\xff\x00"
        finally:
            transport.close()
            # The socket is closed in the next turn of the loop.
            await asyncio.sleep(0)


async def test_the_data_link_over_tcp() -> None:
    device = EmulatedDevice("robot", "melfa-datalink", options={"number_format": "fixed"})
    async with EmulatedBench(config(device)) as bench:
        reader, writer = await asyncio.open_connection(*address(bench, "melfa-datalink"))
        try:
            writer.write(melfa_datalink.WHO + melfa_datalink.ASK_FEEDBACK)
            assert await asyncio.wait_for(reader.readuntil(b"\r"), HANG_S) == melfa_datalink.EMULATOR
            assert (
                await asyncio.wait_for(reader.readuntil(b"\r"), HANG_S)
                == b"8,3,+10.000,-20.000,+75.500,+90.000\r"
            )
        finally:
            writer.close()
            await writer.wait_closed()


@pytest.mark.parametrize(
    ("protocol", "options"),
    [
        ("melfa-mxt", {"mxt_mode": "cylinder"}),
        ("melfa-mxt", {"mxt_cycle_ms": 0.0}),
        ("melfa-mxt", {"mxt_filter_ms": "ten"}),
        ("melfa-datalink", {"number_format": "roman"}),
        ("melfa-datalink", {"program": "A B"}),
    ],
)
def test_wrong_options_are_reported(protocol: str, options: dict[str, str | float]) -> None:
    with pytest.raises(EmulatorError, match=r"robot: .*(mxt_|number_format|program)"):
        EmulatedBench(config(EmulatedDevice("robot", protocol, options=dict(options))))
