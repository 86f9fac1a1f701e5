"""Runs of motion resolution on the emulated bench: killed and resumed, at a kilohertz, with too much to do."""

import asyncio
import signal
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from catseye.app.cell.resolution.template import BY_ARM
from catseye.app.engine.recorder import Recorder, recorder_at_work
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.app.store.seal import read_manifest
from catseye.app.store.verify import verify
from catseye.app.testing.proxy import ProxyThread
from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.umd.display import UmdDisplay
from catseye.procedures.kit.recording import Recorded
from catseye.procedures.kit.records import row_of
from tests.patience import HANG_S
from tests.system.command import Emulated, catseye, emulated, last_run, own_runtime

SPEED = 10.0
PARAMS = (
    'joints=["A5"]',
    'positions=["K3"]',
    "directions=[1]",
    "steps=12",
    "standstill_s=15.0",
    "dwell_s=1.5",
)
COUNTER = """driver = "line-counter"
profile = "default"                     # the dialect of the emulator
"""
MM_PER_COUNT = 632.9908e-6 / 2.0
"""Of a uMD display with plain optics (sheet `interferometers`, section 5): half a wavelength."""


@contextmanager
def bench(folder: Path, rate_hz: float, speed: float = SPEED, arm: str = "kr210-r2700") -> Iterator[Emulated]:
    """Emulate an arm and a uMD display that sends so many samples in a real second."""
    display = f'driver = "umd"\nsettings = {{ rate_hz = {rate_hz} }}\n'
    with own_runtime(), emulated(folder, text=BY_ARM[arm], edit={COUNTER: display}) as running:
        running.ask(op="speed", value=speed)
        # Only the emulator knows this setting.
        cell = running.cell.read_text("utf-8")
        running.cell.write_text(cell.replace(f"settings = {{ rate_hz = {rate_hz} }}\n", ""), "utf-8")
        yield running


def display_of(running: Emulated) -> str:
    """Return the endpoint of the display."""
    text = running.cell.read_text("utf-8")
    return text.partition('driver = "umd"')[2].partition('endpoint = "')[2].partition('"')[0]


def run_words(running: Emulated) -> list[str]:
    words = ["run", "resolution", "--cell", str(running.cell), "--speed", f"{SPEED:g}"]
    return words + [word for param in PARAMS for word in ("--param", param)]


def test_a_run_killed_while_it_records_resumes_whole(tmp_path: Path) -> None:
    with bench(tmp_path, 250.0) as running:
        first = catseye(*run_words(running), cwd=tmp_path, crash="chunk-stored")
        assert first.returncode == -signal.SIGKILL, first.stderr
        run = last_run(tmp_path, "resolution")
        again = catseye("resume", run, cwd=tmp_path, crash="chunk-stored")
        assert again.returncode == -signal.SIGKILL, again.stderr
        last = catseye("resume", run, cwd=tmp_path)
        assert last.returncode == 0, last.stderr
    reader = RunReader(tmp_path / "catseye-runs" / run)
    assert reader.status == "complete"
    assert read_manifest(reader.path) is not None
    checked = verify(reader.path)
    assert checked.problems == ()
    # Both lives that were cut short left a chunk that belongs to no recording.
    assert sum("belong to an attempt" in note for note in checked.notes) == 2
    (recording,) = reader.recordings()
    chunks = list(reader.chunks(recording))
    times_s = np.concatenate([np.array(chunk.times_s) for chunk in chunks])
    assert (len(chunks), times_s.size) == (recording["chunks"], recording["readings"])
    assert (np.diff(times_s) >= 0.0).all()
    assert (recording["lost"], recording["values_lost"]) == (0, 0)


def sent_counts(pieces: list[bytes]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return count, in 256ths, and number of each whole line that came from the display."""
    lines = b"".join(pieces).split(b"\r\n")[1:-1]
    fields = np.array([[int(word) for word in line.split()[:6]] for line in lines])
    return 256 * fields[:, 2] + fields[:, 4], fields[:, 5]


def place_of(part: NDArray[np.int64], whole: NDArray[np.int64]) -> int:
    """Return where a part stands in a whole, up to what both begin with; -1 when it stands nowhere."""
    for place in range(whole.size - part.size + 1):
        there = whole[place : place + part.size]
        if np.array_equal(there - there[0], part - part[0]):
            return place
    return -1


async def stored_mm(endpoint: str, folder: Path, duration_s: float) -> NDArray[np.float64]:
    """Record a display as a run does; return what its store then holds."""
    clock = SystemClock()
    display = UmdDisplay(open_transport(endpoint), clock)
    store = await RunStore.create(folder, "resolution", {}, clock, records=(Recorded,), reserve_bytes=0)
    await display.connect()
    try:
        recorder = Recorder(display, store, clock, ("A5", 1, "series-1"), 25.0)
        async with recorder_at_work(recorder):
            await asyncio.sleep(duration_s)
        row = recorder.recorded(await display.status(), 1.0, 0.0)
        await store.append_step("A5", 1, "A5", {}, [(Recorded.table, row_of(row))])
    finally:
        await display.close()
        await store.abandon()
    (recording,) = RunReader(store.path).recordings()
    assert (recording["method"], recording["values_lost"]) == ("streamed", 0)
    return np.concatenate([np.array(chunk.values) for chunk in RunReader(store.path).chunks(recording)])


async def test_a_stream_of_a_kilohertz_is_stored_without_loss(tmp_path: Path) -> None:
    pieces: list[bytes] = []

    def passed(piece: bytes) -> bytes:
        pieces.append(piece)
        return piece

    with bench(tmp_path, 1000.0) as running, ProxyThread("display") as thread:
        running.ask(op="speed", value=1.0)
        host, _, port = display_of(running).removeprefix("tcp://").rpartition(":")
        with thread.proxy((host, int(port))) as proxy:
            proxy.spoil = passed
            values_mm = await stored_mm(proxy.endpoint, tmp_path, 12.0)
    counts, numbers = sent_counts(pieces)
    stored = np.round(256.0 * values_mm / MM_PER_COUNT).astype(np.int64)
    place = place_of(stored, counts)
    assert place >= 0
    assert (np.diff(numbers[place : place + stored.size]) == 1).all()
    # Chunks of ten thousand readings at most: the recording is cut somewhere.
    assert stored.size > 10_000


def test_an_overloaded_bench_answers_and_ends(tmp_path: Path) -> None:
    with bench(tmp_path, 20_000.0) as running:
        host, _, port = display_of(running).removeprefix("tcp://").rpartition(":")
        with socket.create_connection((host, int(port)), timeout=HANG_S) as display:
            threading.Thread(target=_drained, args=(display,), daemon=True).start()
            before = running.ask(op="identify")
            while (now := running.ask(op="identify"))["behind_s"] == 0.0:
                assert now["time_s"] >= before["time_s"]
            running.process.send_signal(signal.SIGTERM)
            running.process.wait(HANG_S)


def _drained(display: socket.socket) -> None:
    try:
        while display.recv(65536):
            pass
    except OSError:
        return
