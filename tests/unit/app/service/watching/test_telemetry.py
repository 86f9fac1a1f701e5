"""Those who watch receive the bench, five times a second at most; while nobody watches nothing is done."""

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

from catseye.app.engine.control import RunControl
from catseye.app.engine.devices import Devices, WireRecorder
from catseye.app.engine.handle import RunHandle
from catseye.app.protocol.bench import BenchStatus
from catseye.app.service.watching.bench_facts import facts_of
from catseye.app.service.watching.telemetry import Telemetry, free_bytes
from catseye.drivers.roles.interferometer import BeamStatus
from tests.unit.app.service.manual.benches import bench_from_template, cell_from_template
from tests.unit.app.service.watching.pulled_devices import Listeners, PulledCell, disk
from tests.unit.drivers.virtual_time import VirtualClock, run

FACTS = facts_of(cell_from_template(), bench_from_template())


def status_of(telemetry: Telemetry) -> BenchStatus:
    bench = telemetry.bench()
    assert bench is not None
    return bench


def played(folder: Path, play: Callable[[Telemetry, Listeners], Awaitable[None]]) -> None:
    async def whole() -> None:
        listeners = Listeners()
        telemetry = Telemetry(listeners, VirtualClock(), folder, disk)
        try:
            await play(telemetry, listeners)
        finally:
            await telemetry.end()

    run(whole())


def test_an_unknown_bench_has_no_status(tmp_path: Path) -> None:
    async def play(telemetry: Telemetry, listeners: Listeners) -> None:
        assert telemetry.bench() is None
        telemetry.describe(FACTS)
        assert status_of(telemetry).cell == FACTS.cell
        assert listeners.received == []

    played(tmp_path, play)


def test_the_beam_is_shown_as_it_is_mounted(tmp_path: Path) -> None:
    async def play(telemetry: Telemetry, listeners: Listeners) -> None:
        telemetry.describe(FACTS)
        before = status_of(telemetry).layout
        listeners.run = handle = RunHandle(
            tmp_path,
            "open-loop",
            "",
            RunControl(VirtualClock(), lambda _state, _reason: None),
            lambda _kind, _data: None,
            lambda _text: None,
        )
        assert status_of(telemetry).layout == before
        handle.remounted(178.5)
        layout = status_of(telemetry).layout
        assert before is not None
        assert layout is not None
        assert layout.theta40_deg == before.theta40_deg + 178.5
        listeners.run = None
        assert status_of(telemetry).layout == before

    played(tmp_path, play)


def test_five_messages_a_second_with_every_column_once(tmp_path: Path) -> None:
    async def play(telemetry: Telemetry, listeners: Listeners) -> None:
        telemetry.describe(FACTS)
        telemetry.latest.take_displacement(-1.0)
        await asyncio.sleep(1.0)
        listeners.topics.add("watch")
        telemetry.wake()
        telemetry.wake()
        for number in range(1000):
            await asyncio.sleep(0.001)
            telemetry.latest.take_displacement(float(number))
        await asyncio.sleep(0.3)
        benches, samples = listeners.of("bench"), listeners.of("samples")
        assert len(benches) == len(samples) == 7
        times_s = [time_s for time_s, event, _ in listeners.received if event == "bench"]
        assert times_s == pytest.approx([1.0 + 0.2 * number for number in range(7)])
        counts = [count for event in samples for count in event["count"]]
        # The sample from before is published to nobody.
        assert sum(counts) == 1000
        assert max(counts) <= 21
        assert len(counts) in range(59, 62)
        assert {(event["quantity"], event["period_s"], event["missed"]) for event in samples} == {
            ("displacement_mm", 0.02, 0)
        }
        # The first one does not wait for the disk.
        assert [event["disk_free_bytes"] for event in benches] == [None] + 6 * [1000]

    played(tmp_path, play)


def test_subscribers_of_one_topic_receive_no_other(tmp_path: Path) -> None:
    async def play(telemetry: Telemetry, listeners: Listeners) -> None:
        watched: list[bool] = []
        telemetry.on_watched = watched.append
        telemetry.describe(FACTS)
        listeners.topics.add("traffic")
        telemetry.wake()
        await asyncio.sleep(0.1)
        telemetry.traffic.record("robot", "tx", b"1")
        await asyncio.sleep(0.5)
        assert [event for _, event, _ in listeners.received] == ["wire"]
        listeners.topics = {"watch"}
        telemetry.wake()
        await asyncio.sleep(0.3)
        telemetry.traffic.record("robot", "tx", b"2")
        listeners.topics.clear()
        await asyncio.sleep(0.3)
        assert len(listeners.of("wire")) == 1
        count = len(listeners.received)
        await asyncio.sleep(10.0)
        assert len(listeners.received) == count
        assert watched == [True, False]
        listeners.topics.add("traffic")
        telemetry.wake()
        telemetry.traffic.record("robot", "rx", b"3")
        await asyncio.sleep(0.3)
        assert watched == [True, False, True]
        assert [line["hex"] for event in listeners.of("wire") for line in event["lines"]] == ["31", "33"]

    played(tmp_path, play)


def test_a_runs_devices_are_observed_and_their_traffic_duplicated(tmp_path: Path) -> None:
    async def play(telemetry: Telemetry, listeners: Listeners) -> None:
        cell, stored = PulledCell(), list[tuple[str, str, bytes]]()

        def build(record: WireRecorder) -> Devices:
            record("robot", "tx", b"hello")
            return Devices(cell.robot, cell.counter, cell.air)

        listeners.topics.add("traffic")
        telemetry.wake()
        devices = telemetry.observe(FACTS, build)(lambda *line: stored.append(line))
        await devices.robot.joints()
        assert stored == [("robot", "tx", b"hello")]
        assert telemetry.latest.joints is not None
        await asyncio.sleep(0.3)
        assert len(listeners.of("wire")) == 1

    played(tmp_path, play)


def test_another_bench_voids_values_but_another_aim_does_not(
    tmp_path: Path,
) -> None:
    async def play(telemetry: Telemetry, listeners: Listeners) -> None:
        telemetry.describe(FACTS)
        telemetry.latest.take_beam(BeamStatus(True, False, False, True, 0.8))
        aimed = bench_from_template().aimed({"P1": (1.0, 2.0)}, 0.5)
        telemetry.describe(facts_of(cell_from_template(), aimed))
        assert status_of(telemetry).beam is not None
        telemetry.describe(facts_of(cell_from_template().model_copy(update={"name": "lab-2"}), aimed))
        assert status_of(telemetry).beam is None
        assert listeners.received == []

    played(tmp_path, play)


def test_free_space_is_known_for_a_missing_folder(tmp_path: Path) -> None:
    assert (free_bytes(tmp_path / "runs" / "of" / "today") or 0) > 0


def test_a_publishing_fault_does_not_end_watching(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    async def play(telemetry: Telemetry, listeners: Listeners) -> None:
        watched: list[bool] = []
        telemetry.on_watched = watched.append
        telemetry.describe(FACTS)
        listeners.topics.add("watch")
        telemetry.wake()
        with monkeypatch.context() as broken:
            broken.setattr(telemetry, "bench", None)
            await asyncio.sleep(1.0)
        assert listeners.of("bench") == []
        await asyncio.sleep(0.9)
        assert len(listeners.of("bench")) == 5
        assert watched == [True]

    played(tmp_path, play)
    assert caplog.messages == ["the bench could not be published"]
