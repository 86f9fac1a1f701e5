"""What the user interface costs: time to the first screen, from a key to what it does, from STOP to the wire.

Times are targets, printed with the machine; judged are ratios to a peer that is timed in turn, which other work meets
as well.
"""

import contextlib
import json
import re
import select
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path

import pytest

from tests.benchmarks.test_pictures import EMPTY, MOST, latency_text, opened_s, say
from tests.patience import HANG_S
from tests.system.command import Emulated, emulated, own_runtime
from tests.system.screen import Screen, on_screen
from tests.system.test_engine_service import SMALL, SPEED, held, while_the_arm_moves

STOPS = 20
STARTS = 7
PRESSES = 200
KEYS = 5
"""The first one is slow on a screen that has just come."""

SIZE = (120, 40)
"""There is room for the strip, whose length a key changes."""


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    with own_runtime(), emulated(tmp_path_factory.mktemp("tui"), "--speed", SPEED, edit=SMALL) as running:
        yield running


def opened(bench: Emulated) -> contextlib.AbstractContextManager[Screen]:
    return on_screen("tui", "--cell", bench.cell, "--speed", SPEED, cwd=bench.cell.parent, size=SIZE)


@contextlib.contextmanager
def streaming(cell: Path) -> Iterator[None]:
    """Put a display that sends 1000 values a second in the place of a cell's interferometer."""
    arguments = [sys.executable, "-m", "tests.benchmarks.stream_peers", "emitter"]
    with subprocess.Popen(
        arguments, cwd=Path(__file__).parents[2], stdout=subprocess.PIPE, text=True
    ) as display:
        try:
            assert display.stdout is not None
            endpoint = display.stdout.readline().strip()
            section = f'[interferometer]\ndriver = "umd"\nendpoint = "{endpoint}"\n'
            text = cell.read_text(encoding="utf-8")
            changed = re.sub(r"^\[interferometer\]\n(?:(?!\[).*\n)*", section, text, flags=re.MULTILINE)
            assert section in changed
            cell.write_text(changed, encoding="utf-8")
            yield
        finally:
            display.kill()


def test_first_screen_keeps_up_with_an_empty_program(bench: Emulated) -> None:
    taken_s, empty_s = [], []
    for _ in range(STARTS):
        taken_s.append(
            opened_s("tui", "--cell", bench.cell, "--speed", SPEED, cwd=bench.cell.parent, size=SIZE)
        )
        empty_s.append(opened_s(cwd=bench.cell.parent, size=SIZE, program=("-c", EMPTY)))
    say(
        f"first painted screen after {min(taken_s):.2f}…{max(taken_s):.2f} s, "
        f"median {statistics.median(taken_s):.2f} s (aim 1 s), "
        f"of an empty program of the same toolkit {statistics.median(empty_s):.2f} s"
    )
    assert statistics.median(taken_s) < MOST * statistics.median(empty_s)


def test_a_stream_delays_no_key(bench: Emulated, tmp_path: Path) -> None:
    """1000 values a second come in and are drawn; the key changes the length of the strip, which is shown as text.

    The peer is the same screen of a bench that sends a few values a second; keys are pressed in turn.
    """
    with (
        emulated(tmp_path, "--speed", "1") as fast,
        streaming(fast.cell),
        on_screen("tui", "--cell", fast.cell, cwd=tmp_path, size=SIZE) as screen,
        opened(bench) as peer,
    ):
        for each in (screen, peer):
            each.shows("interferometer", " s  ", "now")
        pairs = [(_press(screen), _press(peer)) for _ in range(PRESSES)]
    taken_ms, peer_ms = (sorted(column) for column in zip(*pairs, strict=True))
    say(
        f"key to its effect on the screen while streaming: {statistics.median(taken_ms):.0f} ms, "
        f"{latency_text(taken_ms)}; without a stream {statistics.median(peer_ms):.0f} ms"
    )
    assert statistics.median(taken_ms) < MOST * statistics.median(peer_ms)


def test_stop_is_on_the_wire_as_soon_as_keys_act(bench: Emulated) -> None:
    """The peer is a key of the same screen until its effect is seen; the largest of both are printed."""
    pairs = [_stop(bench, held(bench)) for _ in range(STOPS)]
    taken_ms, key_ms = (sorted(column) for column in zip(*pairs, strict=True))
    say(
        f"STOP key to STOP on the wire: median {statistics.median(taken_ms):.1f} ms, largest of {STOPS} "
        f"{taken_ms[-1]:.1f} ms (aim 60 ms); another key to its effect {statistics.median(key_ms):.1f} ms, "
        f"largest {key_ms[-1]:.1f} ms"
    )
    assert statistics.median(taken_ms) < statistics.median(key_ms)


def _press(screen: Screen) -> float:
    """Press the key for another length of the strip; return how long until its axis says so, ms."""
    before = _length(screen.text)
    pressed_s = time.monotonic()
    screen.press(",")
    while _length(screen.text) == before:
        assert time.monotonic() < pressed_s + HANG_S, screen.text
        select.select([screen.descriptor], [], [], 0.5)
    return 1e3 * (screen.read_at_s - pressed_s)


def _length(text: str) -> int:
    """Return which of the lengths of the strip is shown, in units of ten seconds."""
    found = re.search(r"−(\d+)\.\d s ", text)
    return 0 if found is None else round(float(found[1]) / 10.0)


def _stop(bench: Emulated, run: Path) -> tuple[float, float]:
    """Press STOP while the arm moves; return how long it took to the wire, and other keys before it, ms."""
    with opened(bench) as screen:
        screen.shows("HELD", run.name, " s  ", "now")
        key_ms = statistics.median(_press(screen) for _ in range(KEYS))
        screen.let_go_on()
        while_the_arm_moves(bench)
        pressed_s = time.time()
        screen.press("f12")
        screen.shows("stopped")
    return 1e3 * (_stop_sent_s(run, pressed_s) - pressed_s), key_ms


def _stop_sent_s(run: Path, after_s: float) -> float:
    """Return when STOP went to the controller, s since the epoch, as the transcript of the run stamps it."""
    for line in (run / "wire.log").read_text(encoding="utf-8").splitlines():
        entry = json.loads(line)
        at_s = datetime.fromisoformat(entry["t"]).timestamp()
        if (
            entry["device"] == "robot"
            and entry["direction"] == "tx"
            and at_s >= after_s
            and "STOP" in entry["text"]
        ):
            return at_s
    raise AssertionError("STOP is not in the transcript")
