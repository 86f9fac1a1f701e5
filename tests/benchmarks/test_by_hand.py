"""An arm that is moved by hand: from STOP, and from the last feed, to what the controller's emulator sees of it.

Targets are printed with the machine. What is judged are ratios to what was measured beside it in the same run.
"""

import contextlib
import statistics
from collections.abc import Iterator

import pytest

from tests.system.command import emulated, own_runtime
from tests.system.test_by_hand import Engine, engine_of, fed

STOPS = 30
FEEDS = 15
TARGET_MS = 60.0
STAND_TARGET_MS = 400.0
MOST_ASKED = 10.0
"""A STOP may take so many bare questions to the emulator's control port until it is on the controller's wire."""

MOST_STOPPED = 100.0
"""An arm that nobody feeds may take so many times as long to stand as one that is stopped: the feed has to be missed
first, and a quick machine stops an arm in milliseconds. One that went on to its limit would take a thousand times."""


@pytest.fixture(scope="module")
def engine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Engine]:
    with (
        own_runtime(),
        emulated(tmp_path_factory.mktemp("by-hand"), "--speed", "1") as bench,
        engine_of(bench) as made,
    ):
        yield made


def report(what: str, taken_ms: list[float]) -> None:
    """Print a figure; with so few the largest stands for the 99th percentile."""
    middle = statistics.median(taken_ms)
    print(f"\n{what}: median {middle:.1f} ms, largest of {len(taken_ms)} {max(taken_ms):.1f} ms")  # noqa: T201  # the figure is the result of a benchmark


def test_another_clients_stop_reaches_the_wire_in_few_questions(engine: Engine) -> None:
    taken_ms, asking_ms = [], []
    with contextlib.closing(engine.joined("Eve")) as other:
        for number in range(STOPS):
            client = engine.steering()
            assert fed(client, "j2", 1 if number % 2 else -1, 0.3)["ok"]
            before_s = engine.now_s()
            # What a question to the emulator's control port takes is in the figure too: it is printed beside it.
            asked_s = engine.now_s()
            assert other.ask("stop")["ok"]
            assert client.ask("jog", on=False)["ok"]
            taken_ms.append(1e3 * (next(t for t in engine.requests("STOP") if t > asked_s) - asked_s))
            asking_ms.append(1e3 * (asked_s - before_s))
    report("a question to the emulator's control port alone", asking_ms)
    report(f"STOP of another client during a jog, to STOP on the wire (target {TARGET_MS:g} ms)", taken_ms)
    assert statistics.median(taken_ms) <= MOST_ASKED * statistics.median(asking_ms)


def test_unfed_arms_stand_soon_compared_with_stopped_ones(engine: Engine) -> None:
    stopped_ms = []
    for number in range(FEEDS):
        client = engine.steering()
        assert fed(client, "j2", 1 if number % 2 else -1, 0.4)["ok"]
        asked_s = engine.now_s()
        assert client.ask("stop")["ok"]
        stopped_ms.append(1e3 * (engine.rest_s() - asked_s))
        assert client.ask("jog", on=False)["ok"]
    client = engine.steering()
    taken_ms = []
    for number in range(FEEDS):
        assert fed(client, "j2", 1 if number % 2 else -1, 0.4)["ok"]
        last_s = engine.now_s()
        assert client.ask("jog-hold", joint="j2", direction=1 if number % 2 else -1)["ok"]
        taken_ms.append(1e3 * (engine.rest_s() - last_s))
    report("STOP to standstill", stopped_ms)
    report(f"last feed to standstill (target {STAND_TARGET_MS:g} ms)", taken_ms)
    assert statistics.median(taken_ms) <= MOST_STOPPED * statistics.median(stopped_ms)
