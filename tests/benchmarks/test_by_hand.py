"""An arm that is moved by hand: from STOP, and from the last feed, to what the controller's emulator sees of it."""

import contextlib
import statistics
from collections.abc import Iterator

import pytest

from tests.system.command import emulated, own_runtime
from tests.system.test_by_hand import Engine, engine_of, fed

STOPS = 30
FEEDS = 15


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


def test_another_clients_stop_reaches_the_wire_within_60_ms(engine: Engine) -> None:
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
    report("STOP of another client during a jog, to STOP on the wire", taken_ms)
    assert max(taken_ms) <= 60.0


def test_the_arm_stands_within_400_ms_of_the_last_feed(engine: Engine) -> None:
    client = engine.steering()
    taken_ms = []
    for number in range(FEEDS):
        assert fed(client, "j2", 1 if number % 2 else -1, 0.4)["ok"]
        last_s = engine.now_s()
        assert client.ask("jog-hold", joint="j2", direction=1 if number % 2 else -1)["ok"]
        taken_ms.append(1e3 * (engine.rest_s() - last_s))
    report("last feed to standstill", taken_ms)
    assert max(taken_ms) <= 400.0
