"""A client that comes in the middle of a run knows what was before."""

from pathlib import Path
from typing import Any

from catseye.app.protocol.events import event_of
from catseye.app.protocol.run_events import LiveData, StepStarted
from catseye.app.results.runs.rehearsal_command import rehearsal_command
from catseye.app.store.run_store import RunStore
from catseye.app.tui.record import read_record
from catseye.app.tui.run_state import LogLine, RunState, SoFar
from catseye.procedures.kit.live import Live
from tests.unit.app.engine.fakes import ManualClock, point
from tests.unit.app.store.fakes import RECORDS
from tests.unit.app.tui.scripted import snapshot_with

RUN = "20261121T090000Z_open-loop_abc123"


def run_state() -> RunState:
    return RunState(RUN, "open-loop", "Open loop", 0.0)


def publish(run: RunState, event: str, **fields: Any) -> None:
    run.take(event_of({"event": event, "t": "2026-11-21T09:30:00+00:00", "run": RUN, **fields}), 1.0)


def so_far(**fields: Any) -> SoFar:
    return SoFar(**{"steps": [], "points": 0, "log": [], **fields})


async def test_the_record_holds_steps_points_and_what_happened(tmp_path: Path) -> None:
    clock = ManualClock()
    meta: dict[str, Any] = {
        "procedure": "open-loop",
        "configuration_file": "/bench/cell.toml",
        "params": {"reflectors": ["P1"], "closures": 2, "subdivide": True},
        "aim": "20261121T080000Z_reflector-search_000000",
        "clock_speed": 20.0,
    }
    store = await RunStore.create(tmp_path, "open-loop", meta, clock, records=RECORDS, reserve_bytes=0)
    await store.append_step("P1/0000", 1, "first", {}, [("points", point(1)), ("points", point(2))])
    await store.event("map-known", {"u_theta1_mdeg": 5.0, "u_theta2_mdeg": 7.0})
    await store.event("warning", {"text": "the beam is weak"})
    found = read_record(store.path)
    assert found.steps == [("P1/0000", "first")]
    assert found.points == 2
    assert found.speed == 20.0
    # The pictures of the run say it.
    assert not any("map" in line.text for line in found.log)
    assert ("warning", "the beam is weak") in [(line.level, line.text) for line in found.log]
    assert found.command[:8] == (
        *("run", "open-loop", "--cell", "/bench/cell.toml", "--runs", str(tmp_path)),
        *("--search", "20261121T080000Z_reflector-search_000000"),
    )
    params = [found.command[n + 1] for n, word in enumerate(found.command) if word == "--param"]
    assert params == ['reflectors=["P1"]', "closures=2", "subdivide=true"]
    assert found.command[-2:] == ("--dry-run", "--json")
    await store.abandon()


async def test_a_record_that_says_little_is_not_rehearsed(tmp_path: Path) -> None:
    store = await RunStore.create(tmp_path, "open-loop", {}, ManualClock(), records=RECORDS, reserve_bytes=0)
    found = read_record(store.path)
    assert (found.points, found.command) == (0, ())
    await store.abandon()


def test_a_run_without_a_search_is_rehearsed_without_one() -> None:
    meta = {
        "procedure": "warmup",
        "configuration_file": "c.toml",
        "params": {"reflector": None},
        "aim": "cell file",
    }
    words = rehearsal_command(meta, Path("/runs"))
    assert words[words.index("--search") + 1] == "none"
    assert "--param" not in words


def test_a_parameter_too_long_for_a_command_is_not_rehearsed() -> None:
    meta = {
        "procedure": "a",
        "configuration_file": "c",
        "params": {"joints": "x" * 200_000},
        "aim": "cell file",
    }
    assert rehearsal_command(meta, Path("/runs")) == ()


def test_what_has_come_meanwhile_stands_behind_the_record() -> None:
    run = run_state()
    publish(run, "step-done", step="b", title="second", stored=False)
    publish(run, "step-started", step="c", title="third", attempt=1)
    publish(run, "point", step="b", point={"theta1_deg": 2.0})
    publish(run, "happened", state="EXECUTE", kind="map-known", data={"u_theta1_mdeg": 4.0})
    publish(run, "warning", text="later")
    run.take_record(
        so_far(
            steps=[("a", "first"), ("b", "second")],
            points=2,
            log=[
                LogLine("2026-11-21T09:00:00+00:00", "info", "before"),
                LogLine("2026-11-21T09:30:00+00:00", "warning", "later"),
            ],
        )
    )
    assert [(step.id, step.status) for step in run.steps.values()] == [
        ("a", "done"),
        ("b", "done"),
        ("c", "current"),
    ]
    assert run.points_seen == 2
    assert [line.text for line in run.log] == ["before", "later"]
    assert run.recorded


def test_steps_that_a_resumed_run_passes_are_marked_as_stored() -> None:
    run = run_state()
    run.take_record(so_far(steps=[("a", "first")]))
    publish(run, "step-done", step="a", title="first", stored=True)
    assert run.steps["a"].stored


def test_a_live_value_remembers_its_band() -> None:
    run = run_state()
    for value in (1.0, 9.0):
        data = LiveData.of(Live("innovation", value, "µm", -5.0, 5.0))
        publish(run, "live", state="EXECUTE", data=data.json_object())
    assert [seen.accepted for seen in run.live["innovation"].history] == [True, False]


def test_a_client_that_comes_later_knows_the_step_under_way() -> None:
    step = StepStarted(step="P1/0003", title="third", attempt=1).stamped("", RUN)
    run = RunState.of_snapshot(snapshot_with(run=RUN, state="EXECUTE", step=step), 5.0)
    run.take_record(so_far(steps=[("P1/0002", "second")]))
    assert run.current is not None
    assert run.current.title == "third"
    assert list(run.steps) == ["P1/0002", "P1/0003"]


def test_an_answer_of_somebody_else_does_not_command_the_terminal() -> None:
    run = run_state()
    publish(run, "answer", id="note", answer="\x1b[2J", who="Bob")
    assert run.log[-1].text == r"note: \x1b[2J (Bob)"
