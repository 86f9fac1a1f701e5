"""The servers on real loopback sockets: what only a socket shows."""

import asyncio
import json
import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace

import pytest

from catseye.drivers.counter.counter import LineCounter
from catseye.drivers.roles.clock import SystemClock
from catseye.simulators.config import EmulatedDevice, EmulationConfig
from catseye.simulators.emulated_bench import EmulatedBench, ServedEndpoint
from catseye.simulators.errors import EmulatorError
from tests.patience import HANG_S
from tests.unit.simulators.benches import QUIET, aimed

CONFIG = replace(QUIET, speed=1000.0, start_joints=aimed(20.0, 30.0))
RETURNED = replace(CONFIG, acceptance_mm=100.0)
"""The beam returns wherever the drawn reflectors stand."""


class Line:
    """A client's connection."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader = reader
        self.writer = writer

    async def ask(self, request: bytes) -> bytes:
        """Send a request; return what comes in one read, like the simple clients of the field."""
        self.writer.write(request)
        return await asyncio.wait_for(self.reader.read(4096), HANG_S)

    async def ended(self) -> bool:
        """Return whether the other side ended the connection, with or without a reset."""
        try:
            return await asyncio.wait_for(self.reader.read(1), HANG_S) == b""
        except ConnectionError:
            return True

    async def silent(self) -> bool:
        """Return whether nothing comes within a moment."""
        try:
            await asyncio.wait_for(self.reader.read(1), 0.03)
        except TimeoutError:
            return True
        return False


@asynccontextmanager
async def client(bench: EmulatedBench, device: str) -> AsyncIterator[Line]:
    (served,) = [endpoint for endpoint in bench.endpoints if endpoint.device == device]
    host, _, port = served.endpoint.removeprefix("tcp://").rpartition(":")
    line = Line(*await asyncio.open_connection(host, int(port)))
    try:
        yield line
    finally:
        line.writer.close()
        await asyncio.wait([asyncio.ensure_future(_closed(line.writer))])


async def _closed(writer: asyncio.StreamWriter) -> None:
    try:
        await writer.wait_closed()
    except ConnectionError:
        # The bench may have dropped the connection; that is what some tests are about.
        return


async def ready(robot: Line, bench: EmulatedBench) -> None:
    assert await robot.ask(b"1;1;CNTLON\r") == b"QoK"
    assert await robot.ask(b"1;1;SRVON\r") == b"QoK"
    bench.bench.advance(1.0)


async def under_way(robot: Line) -> None:
    """Ask until the arm moves."""
    while not (await robot.ask(b"1;1;DSTATE\r")).endswith(b";1"):
        pass


async def test_every_device_answers_on_a_free_port() -> None:
    async with EmulatedBench(CONFIG) as bench:
        assert [(e.device, e.protocol) for e in bench.endpoints] == [
            ("robot", "melfa-r3"),
            ("interferometer", "line-counter"),
            ("environment", "modbus-air"),
            ("control", "catseye-control"),
        ]
        assert all(re.fullmatch(r"tcp://127\.0\.0\.1:[1-9]\d*", e.endpoint) for e in bench.endpoints)
        async with (
            client(bench, "robot") as robot,
            client(bench, "interferometer") as counter,
            client(bench, "environment") as air,
            client(bench, "control") as control,
        ):
            assert b"EMULATOR" in await robot.ask(b"1;1;OPEN=TEST\r")
            assert b"EMULATOR" in await counter.ask(b"I\r\n")
            assert b"EMULATOR" in await air.ask(bytes.fromhex("0001 0000 0005 01 2b 0e 01 00"))
            assert b"EMULATOR" in await control.ask(b'{"op": "identify"}\n')


async def test_a_bare_segment_is_answered_after_a_pause() -> None:
    async with EmulatedBench(CONFIG) as bench, client(bench, "robot") as robot:
        assert await robot.ask(b"1;1;STOP") == b"QoK"


async def test_a_waiting_motion_answers_at_its_end() -> None:
    async with EmulatedBench(CONFIG) as bench, client(bench, "robot") as robot:
        await ready(robot, bench)
        assert await robot.ask(b"1;1;EXEC2=MOV (60,30,0,0)\r") == b"QoK"
        assert bench.bench.joints[0] == 60.0


async def test_a_stop_on_a_second_connection_overtakes_a_waiting_motion() -> None:
    slow = replace(CONFIG, speed=1.0)
    async with (
        EmulatedBench(slow) as bench,
        client(bench, "robot") as robot,
        client(bench, "robot") as stopper,
    ):
        await ready(robot, bench)
        assert await robot.ask(b"1;1;OVRD=1\r") == b"QoK1"
        waiting = asyncio.create_task(robot.ask(b"1;1;EXEC2=MOV (160,30,0,0)\r"))
        await under_way(stopper)
        assert await stopper.ask(b"1;1;STOP\r") == b"QoK"
        assert await waiting == b"QeR561000000"
        assert bench.bench.joints[0] < 160.0


async def test_a_client_that_leaves_during_a_motion_leaves_nothing_behind() -> None:
    slow = replace(CONFIG, speed=1.0)
    async with EmulatedBench(slow) as bench:
        async with client(bench, "robot") as robot:
            await ready(robot, bench)
            robot.writer.write(b"1;1;EXEC2=MOV (160,30,0,0)\r")
            async with client(bench, "robot") as other:
                await under_way(other)
        async with client(bench, "robot") as other:
            # The right went with the connection; the motion goes on.
            assert await other.ask(b"1;1;EXECMOV (0,0,0,0)\r") == b"QeR602000000"
            assert bench.bench.moving


async def test_a_stalled_device_answers_late() -> None:
    async with (
        EmulatedBench(CONFIG) as bench,
        client(bench, "control") as control,
        client(bench, "interferometer") as counter,
    ):
        stalled_s = bench.bench.time_s
        request = {"op": "fault", "name": "stall", "device": "interferometer", "duration_s": 60.0}
        assert json.loads(await control.ask(json.dumps(request).encode() + b"\n"))["ok"]
        assert (await counter.ask(b"I\r\n")).startswith(b"CATSEYE")
        assert bench.bench.time_s - stalled_s >= 59.0


async def test_a_mute_device_works_and_says_nothing() -> None:
    async with (
        EmulatedBench(CONFIG) as bench,
        client(bench, "control") as control,
        client(bench, "robot") as robot,
    ):
        await control.ask(b'{"op": "fault", "name": "mute", "device": "robot"}\n')
        robot.writer.write(b"1;1;STOPON\r")
        assert await robot.silent()
        assert bench.controller.stop_latched
        await control.ask(b'{"op": "fault", "name": "clear_faults"}\n')
        assert await robot.ask(b"1;1;STPSIG\r") == b"QoK2;0"


async def test_a_dropped_device_welcomes_new_connections() -> None:
    async with EmulatedBench(CONFIG) as bench, client(bench, "control") as control:
        async with client(bench, "environment") as air:
            await control.ask(b'{"op": "fault", "name": "drop", "device": "environment"}\n')
            assert await air.ended()
        async with client(bench, "environment") as again:
            assert await again.ask(bytes.fromhex("0001 0000 0006 01 03 0200 0001")) != b""


async def test_without_power_nobody_gets_in_and_the_state_is_lost() -> None:
    async with EmulatedBench(RETURNED) as bench, client(bench, "control") as control:
        async with client(bench, "interferometer") as counter:
            assert (await counter.ask(b"Z\r\n")).startswith(b"OK")
            assert (await counter.ask(b"B5000\r\n")).startswith(b"OK")
            request = {"op": "fault", "name": "cut_power", "device": "interferometer", "duration_s": 1e9}
            assert json.loads(await control.ask(json.dumps(request).encode() + b"\n"))["ok"]
            assert await counter.ended()
        async with client(bench, "interferometer") as refused:
            assert await refused.ended()
        await control.ask(b'{"op": "fault", "name": "clear_faults"}\n')
        async with client(bench, "interferometer") as again:
            assert (await again.ask(b"I\r\n")).startswith(b"CATSEYE")
            # The continuous output was of the time before.
            assert await again.silent()


async def test_a_driver_trusts_no_count_from_before_a_power_cut() -> None:
    async with EmulatedBench(RETURNED) as bench, client(bench, "control") as control:
        endpoint = next(each.endpoint for each in bench.endpoints if each.device == "interferometer")
        counter = LineCounter.at(endpoint, SystemClock(), profile="default")
        await counter.connect()
        await counter.zero()
        request = {"op": "fault", "name": "cut_power", "device": "interferometer", "duration_s": 100.0}
        await control.ask(json.dumps(request).encode() + b"\n")
        await counter.read()
        assert (await counter.status()).beam_lost
        await counter.zero()
        assert not (await counter.status()).beam_lost
        await counter.close()


async def test_continuous_output_comes_unasked() -> None:
    async with EmulatedBench(CONFIG) as bench, client(bench, "interferometer") as counter:
        assert (await counter.ask(b"B5000\r\n")).startswith(b"OK")
        lines = [await asyncio.wait_for(counter.reader.readline(), HANG_S) for _ in range(3)]
        assert all(line.endswith(b" mm\r\n") for line in lines)


async def test_a_flood_during_a_waiting_motion_is_answered_afterwards() -> None:
    async with EmulatedBench(CONFIG) as bench, client(bench, "robot") as robot:
        await ready(robot, bench)
        robot.writer.write(b"1;1;EXEC2=MOV (60,30,0,0)\r" + b"1;1;OVRD\r" * 20_000)
        got = b""
        while len(got) < 3 + 6 * 20_000:
            got += await asyncio.wait_for(robot.reader.read(65_536), HANG_S)
        assert got == b"QoK" + b"QoK100" * 20_000


@pytest.mark.parametrize(("host", "is_open"), [("127.0.0.1", False), ("localhost", False), ("0.0.0.0", True)])
async def test_endpoints_open_to_the_network_are_known(host: str, is_open: bool) -> None:
    devices = (EmulatedDevice("environment", "modbus-air", f"tcp://{host}:0"),)
    async with EmulatedBench(replace(CONFIG, devices=devices)) as bench:
        assert bench.open_to_the_network == ([bench.endpoints[0].endpoint] if is_open else [])


async def test_a_port_in_use_is_named_with_its_remedy() -> None:
    async with EmulatedBench(CONFIG) as bench:
        taken = bench.endpoints[0].endpoint
        second = EmulatedBench(
            replace(CONFIG, devices=(EmulatedDevice("interferometer", "line-counter", taken),))
        )
        with pytest.raises(
            EmulatorError, match=rf"interferometer: cannot listen on {taken}.*choose another port"
        ):
            await second.__aenter__()


@pytest.mark.parametrize(
    "endpoint", ["pipe://x", "tcp://127.0.0.1", "tcp://:99", "tcp://h:99999", "serial://ttyUSB0", ""]
)
async def test_other_endpoints_are_refused(endpoint: str) -> None:
    with pytest.raises(EmulatorError, match="robot: emulators listen on tcp://HOST:PORT, udp://"):
        await EmulatedBench(
            replace(CONFIG, devices=(EmulatedDevice("robot", "melfa-r3", endpoint),))
        ).__aenter__()


@pytest.mark.parametrize(
    ("config", "text"),
    [
        (EmulationConfig(reflectors=()), "at least one reflector"),
        (replace(CONFIG, speed=0.0), "speed must be above 0"),
        (replace(CONFIG, axis_pattern=5), "4, 6 or 8 axes"),
    ],
)
def test_what_cannot_be_emulated_is_refused(config: EmulationConfig, text: str) -> None:
    with pytest.raises(EmulatorError, match=text):
        EmulatedBench(config)


def test_an_endpoint_is_plain_data() -> None:
    assert EmulatedBench(CONFIG).endpoints[3] == ServedEndpoint(
        "control", "catseye-control", "tcp://127.0.0.1:0"
    )
