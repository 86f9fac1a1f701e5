"""A client that writes its own real-time program, over sockets: bench time passes only while somebody waits."""

import asyncio
import socket
from dataclasses import replace

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.emulated_bench import EmulatedBench
from tests.patience import HANG_S
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.melfa.test_mxt import packet

REQUESTS = (
    "1;1;STOP",
    "1;1;NEW",
    "1;1;LOAD=1432",
    "1;9;ECLR",
    '1;9;EMDAT10 OPEN "ENET:127.0.0.1" AS #1\v20 MXT 1,1,0\v30 HLT\v40 END',
    "1;1;SAVE",
    "1;1;CNTLON",
    "1;1;SLOTINIT",
    "1;1;RUN1432;1",
)
"""What the Robotics Library sends, without terminators; see `test_mxt_program`."""


def led(r3: str, stream: str) -> tuple[bytes, bytes]:
    """Write and start the program, ask at once where the arm stands, and end it; return the two answers."""
    host, _, port = r3.removeprefix("tcp://").rpartition(":")
    _, _, real_time = stream.rpartition(":")
    with (
        socket.create_connection((host, int(port)), timeout=HANG_S) as line,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as datagrams,
    ):
        datagrams.settimeout(HANG_S)
        datagrams.connect((host, int(real_time)))
        for request in REQUESTS:
            line.sendall(request.encode("ascii"))
            assert line.recv(256) == b"QoK", request
        answers = []
        for command in (0, 255):
            datagrams.send(packet(command, 0))
            answers.append(datagrams.recv(1024))
        return answers[0], answers[1]


async def test_a_program_written_by_its_client_is_led_at_once() -> None:
    devices = (
        EmulatedDevice("robot", "melfa-r3"),
        EmulatedDevice("robot", "melfa-mxt", "udp://127.0.0.1:0"),
    )
    async with EmulatedBench(replace(QUIET, devices=devices)) as bench:
        r3, stream, *_ = (served.endpoint for served in bench.endpoints)
        first, last = await asyncio.to_thread(led, r3, stream)
        assert (len(first), first[0]) == (196, 0)
        assert (len(last), last[0]) == (196, 255)
        assert bench.controller.alarm == 0
