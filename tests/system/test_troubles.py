"""Each trouble of a measurement on emulated hardware: its state, its sentence, and what becomes of the run.

Alarm, emergency stop and pulled cable are in test_stop.py, a blocked beam in test_recovery.py.
"""

import json
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import IO, Any

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.store.reader import RunReader
from tests.patience import HANG_S
from tests.system.command import Emulated, begun, emulated
from tests.system.forked import Forked
from tests.system.test_ways_of_following import ALL_THETA2, FEW_NODES, TRUTH

SPEED = "60"
POINTS = 16 + 2
DOOR = '[io]\nendpoint = "tcp://127.0.0.1:10503"\n\n[tracker]'


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    folder = tmp_path_factory.mktemp("troubles")
    truth = folder / "truth.json"
    truth.write_text(json.dumps(TRUTH), encoding="utf-8")
    edit = {**FEW_NODES, ALL_THETA2: "theta2_deg = [20.0, 40.0]", "[tracker]": DOOR}
    with emulated(folder, "--speed", SPEED, "--truth", str(truth), edit=edit, text=TEMPLATE) as running:
        yield running


@dataclass
class Run:
    """A measurement under way, as its stdout reports it.

    Attributes:
        process: the command.
        output: its stdout.
        events: what it has published so far.
    """

    process: Forked
    output: IO[str]
    events: list[dict[str, Any]] = field(default_factory=list)

    def until(self, **wanted: str) -> dict[str, Any]:
        """Read on until an event has these values."""
        for line in self.output:
            event: dict[str, Any] = json.loads(line)
            self.events.append(event)
            if all(event.get(key) == value for key, value in wanted.items()):
                return event
        raise AssertionError(f"the run ended without {wanted}: {self.events[-3:]}")

    def end(self) -> dict[str, Any]:
        """Read on to the end and return how it ended."""
        ended = self.until(event="run-ended")
        assert self.process.wait(HANG_S) == ended["exit_code"]
        return ended

    def points(self) -> int:
        return sum(event["event"] == "point" for event in self.events)

    def of_kind(self, kind: str) -> list[dict[str, Any]]:
        return [event["data"] for event in self.events if event["event"] == kind or event.get("kind") == kind]


@pytest.fixture
def run(bench: Emulated) -> Iterator[Run]:
    """A measurement whose second point is done; afterwards the bench is whole again."""
    options = ["--speed", SPEED, "--search", "none", "--json", "--telemetry", "--param", 'reflectors=["P2"]']
    try:
        with begun("run", "open-loop", "--cell", bench.cell, *options, cwd=bench.cell.parent) as (
            process,
            output,
        ):
            made = Run(process, output)
            made.until(event="step-done")
            made.until(event="step-done")
            yield made
    finally:
        bench.ask(op="fault", name="clear_faults")


def motions(bench: Emulated) -> int:
    """Return how many motions the arm has begun."""
    entries = bench.ask(op="log", device="robot")["entries"]
    return sum(entry["kind"] == "motion" and entry["text"].startswith("motion to") for entry in entries)


def test_an_open_door_stops_until_it_is_closed_and_acknowledged(bench: Emulated, run: Run) -> None:
    bench.ask(op="fault", name="door", open=True)
    reason = run.until(event="state", state="SUSPENDING")["reason"]
    assert "the door is open: no motion; close it when nobody is inside" in reason
    run.until(event="state", state="UNSUSPENDING")
    assert not bench.ask(op="state")["moving"]
    before = motions(bench)
    # The emulated operator says yes at once; a second of bench time would be enough for several moves.
    run.until(event="answer", id="acknowledge/1")
    run.until(event="warning")
    time.sleep(0.3)
    assert motions(bench) == before
    bench.ask(op="fault", name="door", open=False)
    run.until(event="answer", id="acknowledge/2")
    run.until(event="state", state="EXECUTE")
    ended = run.end()
    assert ended["status"] == "complete"
    assert run.points() == POINTS
    assert motions(bench) > before
    # What was published is what is stored, in the same order.
    published = [event["state"] for event in run.events if event["event"] == "state" and "reason" in event]
    stored = [
        event.data["state"]
        for event in RunReader(bench.cell.parent / ended["path"]).events()
        if event.kind == "state"
    ]
    assert published == stored
    assert published == ["STARTING", "EXECUTE", "SUSPENDING", "UNSUSPENDING", "EXECUTE", "COMPLETE"]


def test_air_out_of_its_range_suspends_until_it_is_back(bench: Emulated, run: Run) -> None:
    bench.ask(op="fault", name="air", temperature_k=8.0)
    reason = run.until(event="state", state="SUSPENDED")["reason"]
    assert "temperature is 2" in reason
    assert "outside 15 … 25 °C of [conditions]" in reason
    bench.ask(op="fault", name="air", temperature_k=0.0)
    assert run.end()["status"] == "complete"
    assert run.points() == POINTS


def test_a_robot_that_is_not_where_it_was_sent_aborts(bench: Emulated, run: Run) -> None:
    bench.ask(op="fault", name="slip", joint=2, deg=0.8)
    run.until(event="state", state="ABORTED")
    ended = run.end()
    assert (ended["status"], ended["exit_code"]) == ("aborted", 5)
    assert "J2 is at" in ended["text"]
    assert "look for a collision" in ended["text"]


def test_an_overspeed_begins_a_new_segment_and_names_the_override(bench: Emulated, run: Run) -> None:
    bench.ask(op="fault", name="overspeed")
    assert run.end()["status"] == "complete"
    (lost,) = run.of_kind("beam-lost")
    assert lost["cause"] == "overspeed"
    assert any("override" in event["text"] for event in run.events if event["event"] == "warning")
    assert run.points() == POINTS
    points = [event["point"] for event in run.events if event["event"] == "point"]
    assert {point["segment"] for point in points} == {0, 1}


def test_readings_that_scatter_are_shown_and_taken_again(bench: Emulated, run: Run) -> None:
    # It shakes until that was seen: bench time goes on while this machine is busy with something else.
    bench.ask(op="fault", name="vibration", amplitude_um=200.0, duration_s=3600.0)
    while run.until(event="live")["data"]["name"] != "spread of the readings":
        pass
    bench.ask(op="fault", name="clear_faults")
    assert run.end()["status"] == "complete"
    shown = [live for live in run.of_kind("live") if live["name"] == "spread of the readings"]
    assert shown
    assert all(live["value"] > live["high"] == 5.0 and live["unit"] == "µm" for live in shown)
    points = [event["point"] for event in run.events if event["event"] == "point"]
    assert len(points) == POINTS
    assert all(point["spread_mm"] <= 0.005 for point in points)


def test_a_laser_that_loses_its_lock_suspends(bench: Emulated, run: Run) -> None:
    bench.ask(op="fault", name="laser", ready=False)
    reason = run.until(event="state", state="SUSPENDED")["reason"]
    assert "the laser is not ready" in reason
    bench.ask(op="fault", name="laser", ready=True)
    assert run.end()["status"] == "complete"
    assert run.points() == POINTS
