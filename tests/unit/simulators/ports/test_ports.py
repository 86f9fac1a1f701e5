"""Serial lines as real pseudo-terminals and datagrams on the real loopback."""

import asyncio
import contextlib
import os
import time
import tty
from collections import deque
from collections.abc import AsyncIterator, Iterator
from contextlib import AsyncExitStack, asynccontextmanager, contextmanager
from pathlib import Path
from typing import Any

import pytest
import serial

from catseye.simulators.errors import EmulatorError
from catseye.simulators.ports.address import LineAddress, parse_address
from catseye.simulators.ports.pacer import Pacer
from catseye.simulators.ports.port import Port
from catseye.simulators.ports.session import Answer, Pending, Session
from catseye.simulators.ports.udp import MOST_PEERS
from catseye.simulators.world.timekeeper import TimeKeeper
from tests.patience import HANG_S, until
from tests.unit.simulators.benches import quiet_bench

FAST = "baud=4000000"


class Parrot(Session):
    """Answers each line by its number in this session and its text; `wait` takes bench time, `go` streams."""

    def __init__(self, keeper: TimeKeeper) -> None:
        self._keeper = keeper
        self._bytes = b""
        self._lines: deque[bytes] = deque()
        self._count = 0
        self._next_s: float | None = None
        self.feeds: list[bytes] = []

    def feed(self, data: bytes) -> None:
        self.feeds.append(data)
        *lines, self._bytes = (self._bytes + data).split(b"\n")
        self._lines.extend(lines)

    def answer(self) -> Answer | None:
        if not self._lines:
            return None
        line = self._lines.popleft()
        self._count += 1
        reply = b"%d %s\n" % (self._count, line)
        if line == b"wait":
            due_s = self._keeper.bench.time_s + 0.1
            return Pending(lambda: due_s if self._keeper.bench.time_s < due_s else None, lambda: reply)
        if line == b"go":
            self._next_s = self._keeper.bench.time_s + 0.01
        return reply

    def next_output_s(self) -> float | None:
        return self._next_s

    def output(self) -> bytes:
        self._next_s = self._keeper.bench.time_s + 0.01
        return b"tick\n"


class Served:
    """A port of parrots.

    Args:
        port: the port.
        sessions: those it has made.
    """

    def __init__(self, endpoint: str, speed: float) -> None:
        self.sessions: list[Parrot] = []
        keeper = TimeKeeper(quiet_bench(), speed)

        def new_session() -> Parrot:
            self.sessions.append(Parrot(keeper))
            return self.sessions[-1]

        self.port = Port("parrot", "parrot", endpoint, keeper, lambda: new_session)

    async def has_made(self, count: int) -> None:
        """Wait until so many sessions have been made."""
        await until(lambda: len(self.sessions) >= count)

    async def has_fed(self, number: int, end: bytes) -> None:
        """Wait until what a session was fed ends like this."""
        await until(lambda: b"".join(self.sessions[number].feeds).endswith(end))

    @property
    def path(self) -> str:
        """Path of the serial line."""
        return self.port.endpoint.removeprefix("serial://").partition("?")[0]


@asynccontextmanager
async def served(endpoint: str, speed: float = 1.0) -> AsyncIterator[Served]:
    serving = Served(endpoint, speed)
    await serving.port.open()
    try:
        yield serving
    finally:
        await serving.port.close()


def _resolve(future: asyncio.Future[None]) -> None:
    if not future.done():
        future.set_result(None)


class Client:
    """A program that has the serial line open.

    Args:
        path: of the line.
    """

    def __init__(self, path: str) -> None:
        self.descriptor = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        tty.setraw(self.descriptor)
        self.chunks: list[bytes] = []

    def send(self, data: bytes) -> None:
        os.write(self.descriptor, data)

    async def chunk(self) -> bytes:
        """Return what comes next; empty at the end of the line."""
        loop = asyncio.get_running_loop()
        readable: asyncio.Future[None] = loop.create_future()
        loop.add_reader(self.descriptor, _resolve, readable)
        try:
            await asyncio.wait_for(readable, HANG_S)
            return os.read(self.descriptor, 4096)
        except OSError:
            return b""
        finally:
            loop.remove_reader(self.descriptor)

    async def line(self) -> bytes:
        """Return what comes up to a line end."""
        came = b""
        while not came.endswith(b"\n"):
            self.chunks.append(await self.chunk())
            assert self.chunks[-1], "the line ended"
            came += self.chunks[-1]
        return came

    async def ask(self, data: bytes) -> bytes:
        self.send(data)
        return await self.line()


@contextmanager
def client(path: str) -> Iterator[Client]:
    opened = Client(path)
    try:
        yield opened
    finally:
        os.close(opened.descriptor)


async def test_a_line_stands_at_its_path_while_it_is_emulated(tmp_path: Path) -> None:
    path = tmp_path / "counter"
    async with served(f"serial://{path}?{FAST}") as serving:
        assert path.is_symlink()
        assert serving.port.endpoint == f"serial://{path}?{FAST}"
        with client(str(path)) as line:
            assert await line.ask(b"hello\n") == b"1 hello\n"
    assert not path.is_symlink()


async def test_any_free_terminal_is_named() -> None:
    async with served(f"serial:///dev/ptmx?{FAST}") as serving:
        assert serving.path.startswith("/dev/pts/")
        assert serving.port.endpoint.endswith(f"?{FAST}")
        with client(serving.path) as line:
            assert await line.ask(b"a\r\nb\n") in {b"1 a\r\n", b"1 a\r\n2 b\n"}


async def test_bytes_pass_unchanged_and_are_not_echoed() -> None:
    odd = bytes(set(range(256)) - {10})
    async with served(f"serial:///dev/ptmx?{FAST}") as serving:
        with client(serving.path) as line:
            assert await line.ask(odd + b"\n") == b"1 " + odd + b"\n"


async def test_a_reconnecting_client_gets_a_new_session() -> None:
    async with served(f"serial:///dev/ptmx?{FAST}") as serving:
        for number in range(3):
            with client(serving.path) as line:
                assert await line.ask(b"x\n") == b"1 x\n"
                line.send(b"half a line")
                await serving.has_fed(number, b"half a line")
            await serving.has_made(number + 2)


@pytest.mark.parametrize("settings", [{"parity": "E"}, {"parity": "O", "bytesize": 7}])
async def test_a_client_may_set_line_parameters_repeatedly(settings: dict[str, Any]) -> None:
    async with served(f"serial:///dev/ptmx?{FAST}") as serving:
        for number in range(1, 4):
            line = serial.Serial(serving.path, 9600, exclusive=True, timeout=HANG_S, **settings)
            line.write(b"x\n")
            assert await asyncio.to_thread(line.readline) == b"1 x\n"
            line.close()
            await serving.has_made(number + 1)


async def test_a_line_takes_the_time_of_its_bytes() -> None:
    text = b"0123456789" * 10 + b"\n"
    async with served("serial:///dev/ptmx?baud=9600&parity=E&stopbits=2") as serving:
        with client(serving.path) as line:
            start_s = time.perf_counter()
            answer = await line.ask(text)
            took_s = time.perf_counter() - start_s
    least_s = (len(text) + len(answer)) * 12 / 9600
    assert took_s >= least_s
    assert len(line.chunks) > 3


async def test_bench_time_runs_the_line_faster() -> None:
    async with served("serial:///dev/ptmx?baud=300", speed=1000.0) as serving:
        with client(serving.path) as line:
            await line.ask(b"0123456789\n")
    # Two milliseconds carry more than all of it; at the speed of the bench each byte comes alone.
    assert len(line.chunks) == 1


@pytest.mark.parametrize("stands", ["file", "link to a file"])
async def test_what_stands_at_the_path_is_left_alone(tmp_path: Path, stands: str) -> None:
    path, other = tmp_path / "line", tmp_path / "other"
    other.write_text("data")
    if stands == "file":
        path.write_text("data")
    else:
        path.symlink_to(other)
    with pytest.raises(EmulatorError, match=r"parrot: cannot emulate a serial line at .*choose a path"):
        await Served(f"serial://{path}", 1.0).port.open()
    assert path.read_text() == "data"


async def test_a_real_device_and_a_missing_folder_are_refused(tmp_path: Path) -> None:
    with pytest.raises(EmulatorError, match="is a real device or file"):
        await Served("serial:///dev/null", 1.0).port.open()
    with pytest.raises(EmulatorError, match="in a folder that does not exist"):
        await Served(f"serial://{tmp_path}/no/line", 1.0).port.open()


async def test_the_link_of_an_earlier_emulator_is_replaced(tmp_path: Path) -> None:
    path = tmp_path / "line"
    path.symlink_to("/dev/pts/999999")
    async with served(f"serial://{path}?{FAST}") as serving:
        with client(serving.path) as line:
            assert await line.ask(b"x\n") == b"1 x\n"


async def test_faults_work_on_a_line(tmp_path: Path) -> None:
    path = tmp_path / "line"
    async with served(f"serial://{path}?{FAST}") as serving:
        port = serving.port
        with client(str(path)) as line:
            start_s = time.perf_counter()
            port.stalled_until_s = port.keeper.sync() + 0.05
            assert await line.ask(b"x\n") == b"1 x\n"
            assert time.perf_counter() - start_s >= 0.05
            port.muted = True
            line.send(b"unheard\n")
            await until(lambda: b"unheard\n" in b"".join(serving.sessions[-1].feeds))
            port.muted = False
            assert await line.ask(b"x\n") == b"3 x\n"
            port.drop()
            assert await line.chunk() == b""
        with client(str(path)) as line:
            assert await line.ask(b"x\n") == b"1 x\n"


async def test_answers_that_take_time_and_streams_come_over_a_line() -> None:
    async with served(f"serial:///dev/ptmx?{FAST}", speed=10.0) as serving:
        with client(serving.path) as line:
            assert await line.ask(b"wait\n") == b"1 wait\n"
            assert await line.ask(b"go\n") == b"2 go\n"
            assert (await line.line()).startswith(b"tick\n")


async def test_a_client_that_asks_and_goes_troubles_nobody(caplog: pytest.LogCaptureFixture) -> None:
    async with served("serial:///dev/ptmx?baud=19200") as serving:
        for number in range(5):
            with client(serving.path) as line:
                line.send(b"a question that nobody waits for\n")
                await serving.has_fed(number, b"\n")
            await serving.has_made(number + 2)
        with client(serving.path) as line:
            assert await line.ask(b"x\n") == b"1 x\n"
    assert not caplog.records


async def test_a_client_that_never_reads_does_not_grow_the_emulator() -> None:
    async with served("serial:///dev/ptmx?baud=100000000") as serving:
        with client(serving.path) as line:
            for _ in range(2000):
                try:
                    line.send(b"0123456789" * 10 + b"\n")
                except BlockingIOError:
                    await asyncio.sleep(0.001)
            wire = serving.port._listener._line  # type: ignore[union-attr]  # noqa: SLF001  # buffers are inside
            assert wire._out.room_bytes >= 0 and wire._in.room_bytes >= 0  # noqa: SLF001, PT018  # the same


async def test_a_socket_client_that_never_reads_is_dropped() -> None:
    async with served("tcp://127.0.0.1:0") as serving:
        host, port = serving.port.endpoint.removeprefix("tcp://").split(":")
        _, writer = await asyncio.open_connection(host, int(port))

        async def talk() -> None:
            for _ in range(5000):
                writer.write(b"0123456789" * 1000 + b"\n")
                await writer.drain()

        with pytest.raises(ConnectionError):
            await talk()
        writer.close()
        with contextlib.suppress(ConnectionError):
            await writer.wait_closed()


@pytest.mark.parametrize(
    ("query", "symbols"),
    [
        ("", 10),
        ("?parity=E", 11),
        ("?parity=O&stopbits=2", 12),
        ("?bits=7&parity=E", 10),
        ("?stopbits=1.5", 10.5),
    ],
)
def test_time_of_a_byte(query: str, symbols: float) -> None:
    address = parse_address("x", f"serial:///dev/x{query}")
    assert isinstance(address, LineAddress)
    assert address.byte_s == pytest.approx(symbols / 9600)


@pytest.mark.parametrize(
    "query", ["baud=0", "baud=fast", "parity=M", "bits=9", "stopbits=3", "speed=1", "handshake=dtr"]
)
def test_wrong_line_settings_are_refused(query: str) -> None:
    with pytest.raises(EmulatorError, match="counter: 'serial:///dev/x"):
        parse_address("counter", f"serial:///dev/x?{query}")


async def test_a_full_line_loses_and_counts() -> None:
    came: list[bytes] = []
    pacer = Pacer(lambda: 1e-4, came.append, 10)
    pacer.put(b"0123456789ABC")
    assert (pacer.lost_bytes, pacer.room_bytes) == (3, 0)
    await until(lambda: b"".join(came) == b"0123456789")
    pacer.put(b"more")
    pacer.clear()
    await asyncio.sleep(0.005)
    assert b"".join(came) == b"0123456789"


class Datagrams(asyncio.DatagramProtocol):
    """A client on UDP."""

    def __init__(self) -> None:
        self.came: asyncio.Queue[bytes] = asyncio.Queue()

    def datagram_received(self, data: bytes, addr: object) -> None:  # noqa: ARG002  # asyncio's signature
        self.came.put_nowait(data)

    async def next(self) -> bytes:
        return await asyncio.wait_for(self.came.get(), HANG_S)


@asynccontextmanager
async def datagrams(endpoint: str) -> AsyncIterator[tuple[Datagrams, asyncio.DatagramTransport]]:
    host, _, port = endpoint.removeprefix("udp://").rpartition(":")
    loop = asyncio.get_running_loop()
    transport, protocol = await loop.create_datagram_endpoint(Datagrams, remote_addr=(host, int(port)))
    try:
        yield protocol, transport
    finally:
        transport.close()
        await asyncio.sleep(0)


async def test_each_peer_has_a_session_answering_in_datagrams() -> None:
    async with served("udp://127.0.0.1:0") as serving:
        endpoint = serving.port.endpoint
        assert not endpoint.endswith(":0")
        async with datagrams(endpoint) as (one, to_one), datagrams(endpoint) as (two, to_two):
            to_one.sendto(b"a\nb\n")
            assert [await one.next(), await one.next()] == [b"1 a\n", b"2 b\n"]
            to_two.sendto(b"c\n")
            assert await two.next() == b"1 c\n"
        assert [session.feeds for session in serving.sessions] == [[b"a\nb\n"], [b"c\n"]]


async def test_answers_that_take_time_streams_and_faults_work_on_datagrams() -> None:
    async with served("udp://127.0.0.1:0", speed=10.0) as serving:
        port = serving.port
        async with datagrams(port.endpoint) as (peer, to_peer):
            to_peer.sendto(b"wait\n")
            assert await peer.next() == b"1 wait\n"
            start_s = time.perf_counter()
            port.stalled_until_s = port.keeper.sync() + 0.5
            to_peer.sendto(b"go\n")
            assert await peer.next() == b"2 go\n"
            assert time.perf_counter() - start_s >= 0.05
            assert await peer.next() == b"tick\n"
            port.drop()
            to_peer.sendto(b"new\n")
            while (answer := await peer.next()) == b"tick\n":
                pass
            assert answer == b"1 new\n"
            port.muted = True
            to_peer.sendto(b"unheard\n")
            await until(lambda: b"unheard\n" in serving.sessions[-1].feeds)
            assert peer.came.empty()


async def test_peers_are_bounded_in_number() -> None:
    # All stay open: the system hands a closed peer's port out again, which would make it the same peer.
    async with served("udp://127.0.0.1:0") as serving, AsyncExitStack() as peers:
        for _ in range(MOST_PEERS + 3):
            peer, to_peer = await peers.enter_async_context(datagrams(serving.port.endpoint))
            to_peer.sendto(b"x\n")
            assert await peer.next() == b"1 x\n"
        listener = serving.port._listener  # noqa: SLF001  # what it remembers is inside
        assert len(listener._clients) == MOST_PEERS  # type: ignore[union-attr]  # noqa: SLF001  # the same


async def test_a_taken_datagram_port_is_named_with_its_remedy() -> None:
    async with served("udp://127.0.0.1:0") as serving:
        with pytest.raises(EmulatorError, match=r"parrot: cannot listen on udp://.*choose another port"):
            await Served(serving.port.endpoint, 1.0).port.open()
