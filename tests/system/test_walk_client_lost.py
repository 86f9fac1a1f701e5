"""A client that is killed while it walks an arm through the engine's socket."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.system.command import Emulated, begun, emulated, own_runtime
from tests.system.test_by_hand import Engine, feeder
from tests.system.test_walk_by_keys import SMALL


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Emulated]:
    with (
        own_runtime(),
        emulated(tmp_path, "--speed", "1", text=SMALL, module="tests.system.prompt_drives") as running,
    ):
        yield running


@pytest.fixture
def engine(bench: Emulated) -> Iterator[Engine]:
    with begun("engine", "--cell", bench.cell, cwd=bench.cell.parent) as (process, output):
        made = Engine(bench, process, json.loads(output.readline())["socket"])
        try:
            yield made
        finally:
            made.client.close()


def test_killing_a_client_during_a_walk_stops_the_arm(engine: Engine) -> None:
    with feeder(engine, "walk") as client:
        client.kill()
        end = engine.client.until(event="run-ended")
    assert (end["status"], end["exit_code"]) == ("stopped", 130)
    assert "is lost" in end["text"]
    assert not engine.moving()
    # The drives are on, and everybody gets to know until when.
    assert end["drives_on"] is True
    engine.client.until(event="idle", state="STOPPED")
    assert engine.client.until(event="drives")["on"] is True
