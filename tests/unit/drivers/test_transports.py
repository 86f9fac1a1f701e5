"""The byte pipes under the drivers."""

import asyncio
import socket
from contextlib import AbstractAsyncContextManager

import pytest

from catseye.app.testing.memory import pipe
from catseye.drivers.links.endpoint import (
    Endpoint,
    SerialEndpoint,
    TcpEndpoint,
    UdpEndpoint,
    open_transport,
    parse_endpoint,
)
from catseye.drivers.links.record import RecordingTransport
from catseye.drivers.links.tcp import TcpTransport
from catseye.drivers.roles.errors import LinkError
from tests.free_ports import free_port
from tests.unit.drivers.peers import loopback


def server(answer: bytes = b"") -> AbstractAsyncContextManager[int]:
    """Answer each chunk, or hang up at the first one."""

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while await reader.read(4096) and answer:
            writer.write(answer)

    return loopback(serve)


async def test_tcp_carries_bytes_both_ways_and_closes_twice() -> None:
    async with server(b"QoK") as port:
        link = TcpTransport("127.0.0.1", port)
        await link.open()
        await link.open()
        await link.write(b"1;1;STATE\r")
        assert await link.read() == b"QoK"
        await link.close()
        await link.close()


async def test_tcp_says_when_the_other_side_hangs_up() -> None:
    async with server() as port:
        link = TcpTransport("127.0.0.1", port)
        await link.open()
        await link.write(b"x")
        with pytest.raises(LinkError, match=rf"tcp://127.0.0.1:{port}: the other side has closed"):
            await link.read()
        await link.close()


async def test_tcp_that_nobody_listens_to_names_endpoint_and_remedy() -> None:
    port = free_port()
    with pytest.raises(
        LinkError, match=rf"tcp://127.0.0.1:{port}: cannot connect \(Connection refused\).*switched on"
    ):
        await TcpTransport("127.0.0.1", port).open()


async def test_unopened_tcp_refuses_writing_and_reading() -> None:
    link = TcpTransport("127.0.0.1", 1)
    with pytest.raises(LinkError, match="not open: connect first"):
        await link.write(b"x")
    with pytest.raises(LinkError, match="not open: connect first"):
        await link.read()


async def test_tcp_sees_what_has_come_without_waiting() -> None:
    accepted: list[socket.socket] = []
    with socket.create_server(("127.0.0.1", 0)) as listener:
        link = TcpTransport("127.0.0.1", listener.getsockname()[1])
        await link.open()
        accepted.append(listener.accept()[0])
        assert link.waiting() == b""
        accepted[0].sendall(b"unasked")
        assert link.waiting() == b"unasked"
        accepted[0].sendall(b"last")
        accepted[0].shutdown(socket.SHUT_WR)
        assert link.waiting() == b"last"
        with pytest.raises(LinkError, match="other side has closed"):
            link.waiting()
        # A peer that says no more may still listen: this is how a STOP gets through.
        await link.write(b"STOP")
        assert accepted[0].recv(100) == b"STOP"
        accepted[0].close()
        await link.close()


async def test_tcp_waits_until_a_slow_peer_takes_everything() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        link = TcpTransport("127.0.0.1", listener.getsockname()[1])
        await link.open()
        peer = listener.accept()[0]
        data = bytes(range(256)) * 100_000
        writing = asyncio.create_task(link.write(data))
        await asyncio.sleep(0)
        assert not writing.done()
        came = bytearray()
        while len(came) < len(data):
            came += peer.recv(1 << 20)
            await asyncio.sleep(0)
        await writing
        assert came == data
        stuck = asyncio.create_task(link.write(data))
        await asyncio.sleep(0)
        await link.close()
        with pytest.raises(LinkError, match="was closed"):
            await stuck
        peer.close()


async def test_tcp_that_is_closed_wakes_its_reader() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        link = TcpTransport("127.0.0.1", listener.getsockname()[1])
        await link.open()
        reading = asyncio.create_task(link.read())
        await asyncio.sleep(0)
        await link.close()
        with pytest.raises(LinkError, match="the link was closed: connect again"):
            await reading


async def test_tcp_connect_timeout_is_an_error_of_the_link(monkeypatch: pytest.MonkeyPatch) -> None:
    async def never(*_: object) -> None:
        await asyncio.Event().wait()

    monkeypatch.setattr(asyncio.get_running_loop(), "sock_connect", never)
    with pytest.raises(LinkError, match=r"no connection within 0\.001 s"):
        await TcpTransport("192.0.2.1", 10001, connect_timeout_s=0.001).open()


async def test_pipe_keeps_chunks_and_order() -> None:
    near, far = pipe()
    await near.open()
    await far.open()
    await near.write(b"ab")
    await near.write(b"c")
    assert [await far.read(), await far.read()] == [b"ab", b"c"]


async def test_pipe_end_is_seen_after_the_bytes_before_it() -> None:
    near, far = pipe()
    await near.open()
    await far.open()
    await near.write(b"last")
    await near.close()
    assert await far.read() == b"last"
    with pytest.raises(LinkError, match="other side has closed"):
        await far.read()


async def test_reopened_pipe_forgets_what_was_sent_before() -> None:
    near, far = pipe()
    await near.open()
    await far.open()
    await far.write(b"stale")
    await near.close()
    await near.open()
    await far.write(b"fresh")
    assert await near.read() == b"fresh"


async def test_pipe_without_listener_is_a_closed_link() -> None:
    near, _ = pipe("memory://nobody")
    with pytest.raises(LinkError, match="memory://nobody"):
        await near.read()
    await near.open()
    with pytest.raises(LinkError, match="memory://nobody"):
        await near.write(b"x")


async def test_recording_shows_direction_and_bytes_and_changes_nothing() -> None:
    near, far = pipe("memory://device")
    seen: list[tuple[str, bytes]] = []
    link = RecordingTransport(near, lambda direction, data: seen.append((direction, data)))
    await far.open()
    await link.open()
    await link.write(b"R\r\n")
    await far.write(b"+1.5 mm\r\n")
    assert await link.read() == b"+1.5 mm\r\n"
    await link.close()
    assert link.endpoint == "memory://device"
    assert seen == [("tx", b"R\r\n"), ("rx", b"+1.5 mm\r\n")]


async def test_recording_shows_what_a_failed_write_may_have_sent() -> None:
    near, _ = pipe()
    seen: list[bytes] = []
    link = RecordingTransport(near, lambda _, data: seen.append(data))
    with pytest.raises(LinkError):
        await link.write(b"1;1;STOP\r")
    assert seen == [b"1;1;STOP\r"]


@pytest.mark.parametrize(
    ("text", "endpoint"),
    [
        ("tcp://192.168.0.20:10001", TcpEndpoint("192.168.0.20", 10001)),
        ("tcp://robot.lab:502", TcpEndpoint("robot.lab", 502)),
        ("tcp://[::1]:9090", TcpEndpoint("::1", 9090)),
        ("serial:///dev/ttyUSB1", SerialEndpoint("/dev/ttyUSB1")),
        (
            "serial:///dev/ttyUSB0?baud=9600&parity=E&stopbits=2",
            SerialEndpoint("/dev/ttyUSB0", 9600, "E", "2"),
        ),
        ("serial:///dev/serial/by-id/x?stopbits=1.5", SerialEndpoint("/dev/serial/by-id/x", stopbits="1.5")),
        (
            "serial:///dev/ttyS0?bits=7&handshake=rtscts",
            SerialEndpoint("/dev/ttyS0", bits=7, handshake="rtscts"),
        ),
        ("udp://192.168.0.20:10000", UdpEndpoint("192.168.0.20", 10000)),
    ],
)
def test_endpoints_of_cell_files_are_read_and_written_back(text: str, endpoint: Endpoint) -> None:
    assert parse_endpoint(text) == endpoint
    assert parse_endpoint(str(endpoint)) == endpoint


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("192.168.0.20:10001", "unknown kind"),
        ("", "unknown kind"),
        ("pipe://host:1", "unknown kind 'pipe'"),
        ("udp://host", "port must be a number from 1 to 65535"),
        ("tcp://host", "port must be a number from 1 to 65535"),
        ("tcp://host:0", "port must be a number from 1 to 65535"),
        ("tcp://host:70000", "port must be a number from 1 to 65535"),
        ("tcp://host:abc", "port must be a number from 1 to 65535"),
        ("tcp://:10001", "host is missing"),
        ("tcp://host:1/path", "nothing may follow"),
        ("tcp://[::1:502", "write tcp://host:port"),
        ("serial://ttyUSB0", "device path must follow"),
        (
            "serial:///dev/ttyUSB0?boud=9600",
            "setting 'boud'; known are baud, parity, bits, stopbits, handshake",
        ),
        ("serial:///dev/ttyUSB0?baud=fast", "baud must be a positive integer"),
        ("serial:///dev/ttyUSB0?baud=0", "baud must be a positive integer"),
        ("serial:///dev/ttyUSB0?parity=even", "parity must be one of N, E, O"),
        ("serial:///dev/ttyUSB0?bits=9", "bits must be one of 7, 8"),
        ("serial:///dev/ttyUSB0?handshake=dtr", "handshake must be one of none, xonxoff, rtscts"),
        ("serial:///dev/ttyUSB0?stopbits=3", "stopbits must be one of 1, 1.5, 2"),
    ],
)
def test_wrong_endpoints_say_what_is_wrong(text: str, fault: str) -> None:
    with pytest.raises(ValueError, match=fault):
        parse_endpoint(text)


def test_wrong_endpoint_is_an_error_of_the_link() -> None:
    with pytest.raises(LinkError, match="unknown kind"):
        open_transport("robot")


async def test_transport_of_an_endpoint_records_on_request() -> None:
    seen: list[tuple[str, bytes]] = []
    async with server(b"QoK") as port:
        link = open_transport(f"tcp://127.0.0.1:{port}", sink=lambda d, b: seen.append((d, b)))
        assert link.endpoint == f"tcp://127.0.0.1:{port}"
        await link.open()
        await link.write(b"a")
        await link.read()
        await link.close()
    assert seen == [("tx", b"a"), ("rx", b"QoK")]
