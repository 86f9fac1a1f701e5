"""What a run says never makes it wait, whoever reads it or does not."""

import asyncio
import fcntl
import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from catseye.app.cli.narrator import Narrator
from catseye.app.cli.outlet import Outlet, patient_output
from catseye.app.errors import ReaderStuckError
from catseye.app.protocol.run_events import Progressed

PIPE_BYTES = 16384
LINE = "x" * 99 + "\n"


@pytest.fixture
def pipe() -> Iterator[tuple[int, int]]:
    """Return reading and writing end of a pipe that takes little."""
    source, sink = os.pipe()
    fcntl.fcntl(sink, fcntl.F_SETPIPE_SZ, PIPE_BYTES)
    yield source, sink
    os.close(source)
    os.close(sink)


@contextmanager
def stdout_is(descriptor: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Have stdout be a descriptor that is kept open."""
    with open(descriptor, "w", encoding="utf-8", closefd=False) as stream:
        monkeypatch.setattr(sys, "stdout", stream)
        yield


def read_all(descriptor: int) -> str:
    """Return what a pipe holds now."""
    os.set_blocking(descriptor, False)
    try:
        return os.read(descriptor, 1 << 24).decode()
    except BlockingIOError:
        return ""


def filled(outlet: Outlet) -> int:
    """Write lines until one is refused; return how many were taken."""
    for number in range(1000):
        try:
            outlet.write(LINE)
        except ReaderStuckError:
            return number
    raise AssertionError("a pipe that nobody reads takes everything")


def test_what_a_reader_leaves_waits_within_bounds(pipe: tuple[int, int]) -> None:
    _, sink = pipe
    taken = filled(Outlet(sink, 1000)) * len(LINE)
    assert 1000 - len(LINE) < taken <= PIPE_BYTES + 1000


def test_a_reader_that_comes_back_misses_nothing_it_was_promised(pipe: tuple[int, int]) -> None:
    source, sink = pipe
    outlet = Outlet(sink, 1000)
    taken = filled(outlet)
    read = read_all(source)
    assert outlet.drain(1.0)
    assert read + read_all(source) == LINE * taken


async def test_a_slow_reader_gets_the_rest_by_itself(pipe: tuple[int, int]) -> None:
    source, sink = pipe
    taken = filled(Outlet(sink, 1000))
    read = ""
    async with asyncio.timeout(10.0):
        while len(read) < taken * len(LINE):
            read += read_all(source)
            await asyncio.sleep(0)
    assert read == LINE * taken


def test_a_full_disk_is_an_error_at_once() -> None:
    with open("/dev/full", "wb") as full, pytest.raises(OSError, match="No space left"):
        Outlet(full.fileno()).write(LINE)


def test_a_reader_that_goes_is_an_error() -> None:
    source, sink = os.pipe()
    os.close(source)
    with pytest.raises(BrokenPipeError):
        Outlet(sink).write(LINE)
    os.close(sink)


def test_the_end_waits_for_no_reader(pipe: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    _, sink = pipe
    with stdout_is(sink, monkeypatch):
        with patient_output(0.0):
            print(LINE * 200)  # noqa: T201  # as any library might
        # Nor does what is said after it.
        print(LINE * 1000, flush=True)  # noqa: T201


def test_a_stream_in_memory_is_left_alone(capsys: pytest.CaptureFixture[str]) -> None:
    with patient_output():
        print("told")  # noqa: T201
    assert capsys.readouterr().out == "told\n"


def progress(done: int) -> Progressed:
    """Return an event that is short and shown on no file."""
    times = dict.fromkeys(("elapsed_bench_s", "left_bench_s", "elapsed_s", "left_s"), 0.0)
    return Progressed.model_validate({"done": float(done), "total": 1e9, "text": "", **times})


def test_dropped_events_are_counted_for_the_reader(
    pipe: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    source, sink = pipe
    narrator = Narrator("warmup", as_json=True)
    monkeypatch.setattr(sys, "stdout", Outlet(sink, 1000))
    refused = 0
    for number in range(200):
        try:
            narrator.publish(progress(number))
        except ReaderStuckError:
            refused += 1
    read = read_all(source)
    narrator.publish(progress(200))
    lines = [json.loads(line) for line in (read + read_all(source)).splitlines()]
    assert refused > 0
    assert (lines[-2]["event"], lines[-2]["count"]) == ("dropped", refused)
    assert [line["done"] for line in lines if line["event"] == "progress"] == [
        *map(float, range(200 - refused)),
        200.0,
    ]
