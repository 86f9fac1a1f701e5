"""A command that a screen has begun ends when it is cancelled, and leaves no process behind."""

import asyncio
from pathlib import Path

import pytest

from catseye.app.service.command_process import Commands, Done
from tests.patience import HANG_S


def processes_with(text: str) -> list[str]:
    """Return command lines of living processes that hold a text."""
    found = []
    for line in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = line.read_bytes().replace(b"\0", b" ").decode(errors="replace")
        except OSError:
            continue
        if text in words:
            found.append(words)
    return found


async def test_cancelling_ends_the_process(tmp_path: Path) -> None:
    """A demonstration in real time takes hours; it says within seconds that it has begun."""
    said = asyncio.Event()
    out = tmp_path / "demo"
    work = asyncio.create_task(
        Commands().do("demo", "--out", out, "--speed", "1", heard=lambda _: said.set())
    )
    async with asyncio.timeout(HANG_S):
        await said.wait()
        assert processes_with(str(out))
        work.cancel()
        with pytest.raises(asyncio.CancelledError):
            await work
    # What the command has started ends with its stdin, a moment later.
    async with asyncio.timeout(HANG_S):
        while processes_with(str(out)):  # noqa: ASYNC110  # a process of a process has no event
            await asyncio.sleep(0.05)


async def test_a_command_interrupted_from_outside_ends_with_its_code(tmp_path: Path) -> None:
    """SIGINT to the command itself: exit code 130, as the command line documents it."""
    said = asyncio.Event()
    out = tmp_path / "demo"
    work = asyncio.create_task(
        Commands().do("demo", "--out", out, "--speed", "1", heard=lambda _: said.set())
    )
    async with asyncio.timeout(HANG_S):
        await said.wait()
        process = await asyncio.create_subprocess_exec("pkill", "-INT", "-f", f"demo --out {out}")
        await process.wait()
        done: Done = await work
    assert done.code == 130
