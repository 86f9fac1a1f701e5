"""Lines that are typed, however they come."""

import asyncio
import os
import pty
import signal
import tty
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import pytest

from catseye.app.service.lines import Lines
from tests.patience import HANG_S
from tests.unit.app.service.benches import settled


@contextmanager
def piped() -> Iterator[tuple[int, int]]:
    reading, writing = os.pipe()
    try:
        yield reading, writing
    finally:
        os.close(reading)
        os.close(writing)


async def test_lines_come_whole_however_they_are_cut() -> None:
    typed: list[str] = []
    with piped() as (reading, writing), Lines(reading, typed.append).read():
        for part in (b"mo", b"ve\nn", b"o\r\n\xff\n", b"half"):
            os.write(writing, part)
            await settled(5)
    assert typed == ["move", "no", "\ufffd"]


async def test_the_end_is_reported_once() -> None:
    typed: list[str] = []
    ends: list[bool] = []
    reading, writing = os.pipe()
    with Lines(reading, typed.append, lambda: ends.append(True)).read():
        os.write(writing, b"g\n")
        os.close(writing)
        await settled(10)
    os.close(reading)
    assert typed == ["g"]
    assert ends == [True]


async def test_plain_files_and_the_null_device_are_read_immediately(tmp_path: Path) -> None:
    file = tmp_path / "lines"
    file.write_text("h\ng\n")
    for path, lines in ((file, ["h", "g"]), (Path("/dev/null"), [])):
        typed: list[str] = []
        descriptor = os.open(path, os.O_RDONLY)
        with Lines(descriptor, typed.append, partial(typed.append, "end")).read():
            pass
        os.close(descriptor)
        assert typed == [*lines, "end"]


@pytest.mark.parametrize("device", ["/dev/zero", "/dev/full"])
async def test_a_device_without_end_is_given_up(device: str) -> None:
    typed: list[str] = []
    descriptor = os.open(device, os.O_RDONLY)
    with Lines(descriptor, typed.append, partial(typed.append, "end")).read():
        pass
    os.close(descriptor)
    assert typed == ["end"]


async def test_lines_without_end_leave_the_loop_free(tmp_path: Path) -> None:
    typed: list[str] = []
    file = tmp_path / "lines"
    file.write_bytes(b"g\n" * 4_000_000)
    descriptor = os.open(file, os.O_RDONLY)
    with Lines(descriptor, typed.append, partial(typed.append, "end")).read():
        pass
    os.close(descriptor)
    assert typed[-1] == "end"
    assert len(typed) < 4_000_000


async def test_a_line_without_end_from_a_pipe_is_given_up() -> None:
    typed: list[str] = []
    with piped() as (reading, writing), Lines(reading, typed.append, partial(typed.append, "end")).read():
        os.set_blocking(writing, False)
        for _ in range(3):
            os.write(writing, b"x" * 30_000)
            await settled(5)
    assert typed == ["end"]


async def test_a_process_in_the_background_leaves_its_terminal_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    typed: list[str] = []
    master, slave = pty.openpty()
    tty.setraw(slave)
    foreground = os.getpgrp() + 1
    monkeypatch.setattr(os, "tcgetpgrp", lambda _descriptor: foreground)
    monkeypatch.setattr("catseye.app.service.lines._FOREGROUND_POLL_S", 0.001)
    with Lines(slave, typed.append).read():
        os.write(master, b"s\n")
        await settled()
        assert typed == []
        foreground = os.getpgrp()
        async with asyncio.timeout(HANG_S):
            while not typed:  # noqa: ASYNC110  # the terminal has no event to wait for
                await asyncio.sleep(0.001)
    os.close(master)
    os.close(slave)
    assert typed == ["s"]
    assert signal.getsignal(signal.SIGTTIN) == signal.SIG_DFL
