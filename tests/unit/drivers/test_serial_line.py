"""The serial transport over real pseudo-terminals."""

import asyncio
import os
import threading
import tty
from collections.abc import Iterator
from dataclasses import dataclass

import pytest

from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.links.inbox import Inbox
from catseye.drivers.links.serial_line import LineSettings, SerialTransport
from catseye.drivers.roles.errors import LinkError


@dataclass
class Device:
    """The instrument's end of a serial line."""

    master: int
    slave: int

    @property
    def path(self) -> str:
        return os.ttyname(self.slave)

    def say(self, data: bytes) -> None:
        os.write(self.master, data)

    def hear(self, count: int) -> bytes:
        came = b""
        while len(came) < count:
            came += os.read(self.master, 4096)
        return came

    def unplug(self) -> None:
        os.close(self.slave)
        os.close(self.master)
        self.master = self.slave = -1


@pytest.fixture
def device() -> Iterator[Device]:
    opened = Device(*os.openpty())
    tty.setraw(opened.slave)
    yield opened
    for descriptor in (opened.master, opened.slave):
        if descriptor >= 0:
            os.close(descriptor)


def transport(device: Device, **settings: object) -> SerialTransport:
    return SerialTransport(device.path, LineSettings(**settings))  # type: ignore[arg-type]  # each test gives its own


async def test_bytes_go_both_ways_and_closing_leaves_no_thread(device: Device) -> None:
    before = threading.active_count()
    link = transport(device, baud=19200, parity="E", stopbits="2")
    assert link.endpoint == f"serial://{device.path}?baud=19200&parity=E&bits=8&stopbits=2"
    await link.open()
    await link.open()
    await link.write(b"1;1;STATE\r\x00\xff\n")
    assert device.hear(12) == b"1;1;STATE\r\x00\xff\n"
    device.say(b"QoK\r")
    came = b""
    while len(came) < 4:
        came += await link.read()
    assert came == b"QoK\r"
    assert link.waiting() == b""
    await link.close()
    await link.close()
    assert threading.active_count() == before


@pytest.mark.parametrize("handshake", ["none", "xonxoff", "rtscts"])
async def test_line_settings_are_accepted(device: Device, handshake: str) -> None:
    link = open_transport(f"serial://{device.path}?baud=9600&parity=E&bits=7&handshake={handshake}")
    await link.open()
    await link.write(b"x")
    assert device.hear(1) == b"x"
    await link.close()


async def test_a_port_is_held_by_one_program_only(device: Device) -> None:
    first, second = transport(device), transport(device)
    await first.open()
    with pytest.raises(LinkError, match=r"cannot open the serial port \(another program holds it\)"):
        await second.open()
    await first.close()
    await second.open()
    await second.close()


async def test_what_was_sent_before_is_forgotten_with_a_new_opening(device: Device) -> None:
    link = transport(device)
    await link.open()
    await link.close()
    device.say(b"late")
    await link.open()
    device.say(b"new")
    came = b""
    while len(came) < 3:
        came += await link.read()
    assert came == b"new"
    await link.close()


async def test_a_missing_port_names_path_and_remedy() -> None:
    with pytest.raises(
        LinkError, match=r"serial:///dev/no-such-port\?baud=9600.*\(No such file or directory\).*plugged in"
    ):
        await open_transport("serial:///dev/no-such-port").open()
    with pytest.raises(LinkError, match="cannot open the serial port"):
        await open_transport("serial:///etc/hostname").open()


async def test_a_pulled_adapter_is_an_error_of_the_link(device: Device) -> None:
    link = transport(device)
    await link.open()
    reading = asyncio.create_task(link.read())
    await asyncio.sleep(0)
    device.unplug()
    with pytest.raises(LinkError, match=r"the serial port broke .*plugged in"):
        await reading
    with pytest.raises(LinkError, match="the serial port broke"):
        link.waiting()
    with pytest.raises(LinkError, match="the serial port broke"):
        await link.write(b"x")
    await link.close()


async def test_a_closed_port_refuses_and_wakes_its_reader(device: Device) -> None:
    link = transport(device)
    for action in (link.read, lambda: link.write(b"x")):
        with pytest.raises(LinkError, match="not open: connect first"):
            await action()
    await link.open()
    reading = asyncio.create_task(link.read())
    await asyncio.sleep(0)
    await link.close()
    with pytest.raises(LinkError, match="was closed"):
        await reading


async def test_a_blocked_line_blocks_neither_loop_nor_closing(device: Device) -> None:
    link = SerialTransport(device.path, LineSettings(baud=4_000_000), write_timeout_s=0.05)
    await link.open()
    turns = 0

    async def count() -> None:
        nonlocal turns
        while True:
            turns += 1
            await asyncio.sleep(0)

    counting = asyncio.create_task(count())
    with pytest.raises(LinkError, match=r"does not take bytes.*handshake"):
        await link.write(bytes(1 << 20))
    assert turns > 100
    writing = asyncio.create_task(link.write(bytes(1 << 20)))
    await asyncio.sleep(0)
    await link.close()
    with pytest.raises(LinkError):
        await writing
    counting.cancel()


async def test_opening_is_bounded_in_time(device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    gate = threading.Event()
    whole = SerialTransport._open_port  # noqa: SLF001  # stands for a driver of the system that hangs

    def hanging(link: SerialTransport) -> object:
        gate.wait(5.0)
        return whole(link)

    monkeypatch.setattr(SerialTransport, "_open_port", hanging)
    link = SerialTransport(device.path, LineSettings(), open_timeout_s=0.01)
    with pytest.raises(LinkError, match=r"not open within 0\.01 s"):
        await link.open()
    gate.set()
    while any(thread.name.startswith("serial-line") for thread in threading.enumerate()):  # noqa: ASYNC110  # a thread
        await asyncio.sleep(0.001)
    monkeypatch.undo()
    await link.open()
    await link.close()


async def test_an_inbox_keeps_order_bound_and_end() -> None:
    inbox = Inbox(5)
    assert inbox.put(b"abc")
    assert inbox.put(b"de")
    assert not inbox.put(b"f")
    inbox.end(LinkError("gone"))
    inbox.end(LinkError("again"))
    assert not inbox.put(b"")
    assert [inbox.take(), await inbox.read()] == [b"abc", b"de"]
    for _ in range(2):
        with pytest.raises(LinkError, match="gone"):
            await inbox.read()


async def test_closing_under_a_steady_stream_comes_to_an_end(device: Device) -> None:
    link = transport(device)
    ended = threading.Event()

    def stream() -> None:
        os.set_blocking(device.master, False)
        while not ended.is_set():
            try:
                os.write(device.master, b"0 0 0 0\r\n" * 20)
            except BlockingIOError:
                ended.wait(0.0005)

    talker = threading.Thread(target=stream)
    talker.start()
    try:
        for _ in range(20):
            await link.open()
            assert await link.read()
            await link.close()
    finally:
        ended.set()
        talker.join()
