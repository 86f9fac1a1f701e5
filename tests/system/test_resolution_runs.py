"""Runs of motion resolution on the emulated bench: killed and resumed, and with more to do than there is time."""

import signal
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from catseye.app.cell.resolution.template import TEMPLATE
from catseye.app.store.reader import RunReader
from catseye.app.store.seal import read_manifest
from catseye.app.store.verify import verify
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


@contextmanager
def bench(folder: Path, rate_hz: float) -> Iterator[Emulated]:
    """Emulate a KUKA and a uMD display that sends so many samples in a real second."""
    display = f'driver = "umd"\nsettings = {{ rate_hz = {rate_hz} }}\n'
    with own_runtime(), emulated(folder, text=TEMPLATE, edit={COUNTER: display}) as running:
        running.ask(op="speed", value=SPEED)
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
