"""The timeline of a scripted run: interrupted, resumed, with everything that may happen in it."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import pytest
from pydantic import BaseModel

from catseye.app.protocol.installed import procedure_names
from catseye.app.results.runs import summary as summaries
from catseye.app.results.runs import timeline as timelines
from catseye.app.results.runs.event_text import event_text, texts_of
from catseye.app.results.runs.reports import story_report
from catseye.app.results.runs.summary import summary
from catseye.app.results.runs.timeline import incidents, timeline
from catseye.app.store.reader import RunReader, StoredEvent
from catseye.app.store.run_store import RunStore
from catseye.app.store.software import SOFTWARE
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Json, Record, Row
from tests.unit.app.engine.fakes import ManualClock, point
from tests.unit.app.store.fakes import RECORDS

DEVICES: dict[str, Json] = {
    "robot": {"model": "RH-3FRH5515", "firmware": "A1", "serial": "17", "simulated": True},
    "interferometer": {"model": "counter", "firmware": "1.0", "serial": "", "simulated": True},
}


class Author:
    """Writes a run, a second passing before each entry."""

    def __init__(self, root: Path) -> None:
        self.clock = ManualClock()
        self._root = root
        self.store: RunStore

    async def open(self, procedure: str = "open-loop", **meta: Json) -> None:
        about: dict[str, Json] = {"cell": "lab-1", "operator": "Ada", "aim": "cell file", "simulated": True}
        given: dict[str, Json] = {"devices": DEVICES, **about, **meta}
        self.store = await RunStore.create(
            self._root, procedure, given, self.clock, records=RECORDS, reserve_bytes=0
        )

    async def die(self) -> None:
        await self.store.abandon()

    async def reopen(self, after_s: float) -> None:
        self.clock.advance(after_s)
        about: dict[str, Json] = {"operator": "Bob"}
        self.store = await RunStore.reopen(
            self.store.path, self.clock, about, records=RECORDS, reserve_bytes=0
        )

    async def event(self, kind: str, **data: Json) -> None:
        self.clock.advance(1.0)
        await self.store.event(kind, data)

    async def answer(self, prompt_id: str, text: str, answer: str | None, who: str | None) -> None:
        self.clock.advance(1.0)
        asked = self.clock.now_utc().isoformat()
        await self.store.event("asked", {"id": prompt_id, "text": text, "asked_utc": asked})
        self.clock.advance(4.0)
        await self.store.prompt(prompt_id, "choice", text, asked, answer, who)

    async def points(self, first: int, last: int, segment: int) -> None:
        for number in range(first, last + 1):
            started = self.clock.now_utc().isoformat()
            self.clock.advance(1.0)
            rows: list[tuple[str, Row]] = [("points", {**point(number), "segment": segment})]
            await self.store.append_step(
                f"P1/{number:04d}", 1, f"point {number}", {}, rows, started_utc=started
            )

    async def record(self, step_id: str, title: str, **row: Json) -> None:
        self.clock.advance(1.0)
        await self.store.append_step(step_id, 1, title, {}, [("records", row)])

    @property
    def reader(self) -> RunReader:
        return RunReader(self.store.path)


@pytest.fixture
async def author(tmp_path: Path) -> Author:
    made = Author(tmp_path)
    await made.open()
    return made


def timeline_of(author: Author) -> list[str]:
    return [moment.text for moment in timeline(author.reader)]


async def test_a_resumed_run_reads_in_chronological_order(author: Author) -> None:
    await author.event("devices", devices=DEVICES)
    await author.event("warning", text="SIMULATED: every device is an emulator", simulated=True)
    await author.event("state", state="EXECUTE", reason="devices are ready")
    await author.event("zero", number=1, dead_path_mm=279.947)
    await author.points(0, 36, 0)
    await author.die()
    await author.reopen(125.0)
    await author.event("devices", devices=DEVICES)
    await author.answer("resume/reflectors", "Has it been moved?", "untouched", "Bob")
    await author.event("zero", number=1, dead_path_mm=280.0)
    await author.points(37, 39, 1)
    await author.event("state", state="COMPLETE", reason="the procedure has come to its end")
    await author.store.finish("complete", 0)
    lines = timeline_of(author)
    assert lines[0].startswith("opened by Ada on ")
    host = lines[0].removeprefix("opened by Ada on ").partition(" with ")[0]
    assert lines[1:] == [
        "devices answer: robot, interferometer",
        "EXECUTE: devices are ready",
        "count zeroed (no. 1), dead path 279.95 mm",
        "P1: points 1…37 measured, segment 0, in 37 s",
        "DIED: nothing was stored after this, the run was not closed",
        f"RESUMED by Bob on {host} with {SOFTWARE}, 2 min 05 s after it died",
        "the same devices answer as before",
        "QUESTION resume/reflectors: Has it been moved?",
        "ANSWER resume/reflectors: “untouched”, Bob, after 4.0 s",
        "count zeroed (no. 1), dead path 280.00 mm",
        "P1: points 38…40 measured, segment 1, in 3.0 s",
        "COMPLETE: the procedure has come to its end",
        "ENDED complete, exit code 0",
    ]
    times = [moment.time_utc for moment in timeline(author.reader)]
    assert times == sorted(times)


async def test_what_goes_wrong_is_reported_with_its_cause(author: Author) -> None:
    await author.points(0, 0, 0)
    await author.event("beam-lost", reflector="P1", point=1, segment=0, cause="blocked", by="the column")
    await author.event("warning", text="beam lost: look what is in it")
    await author.event("state", state="HELD", reason="Ada asks for a hold")
    await author.event("client-lost", client="tui", who="Ada", reason="closed", policy="hold")
    await author.event("control", what="taken", by="Bob", before="Ada")
    await author.store.drop_step("P1/0001", 1, {"error": "Interrupted: Ctrl-C", "rows": 2})
    await author.event("error", text="the operator stopped the run", type="InterruptedRunError")
    await author.store.finish("stopped", 130, "the operator stopped the run")
    assert timeline_of(author)[1:] == [
        "P1: point 1 measured, segment 0, in 1.0 s",
        "BEAM LOST: P1, on the way to point 2; segment 0 ends; cause: blocked (by the column)",
        "WARNING: beam lost: look what is in it",
        "HELD: Ada asks for a hold",
        "front end tui (Ada) lost: closed; the run is to hold",
        "control taken: Bob, before: Ada",
        "attempt 1 at P1/0001 dropped: Interrupted: Ctrl-C; 2 row(s) were not kept",
        "ERROR: the operator stopped the run",
        "ENDED stopped, exit code 130",
    ]


async def test_why_a_life_ended_is_listed_once(author: Author) -> None:
    for _ in range(2):
        await author.event("state", state="ABORTING", reason="alarm 1")
        await author.event("state", state="ABORTED", reason="the robot stands")
        await author.event("error", text="alarm 1", type="AlarmError")
        await author.store.finish("aborted", 5, "alarm 1")
        await author.reopen(1.0)
    await author.die()
    life = ["ABORTING: alarm 1", "ABORTED: the robot stands", "ENDED aborted, exit code 5"]
    assert [line for line in timeline_of(author)[1:] if not line.startswith("RESUMED")] == life * 2


async def test_a_question_open_when_the_process_died_is_listed(author: Author) -> None:
    asked = author.clock.now_utc().isoformat()
    await author.event("asked", id="stage/1", text="Turn the screw.", asked_utc=asked)
    await author.die()
    assert timeline_of(author)[1:] == ["QUESTION stage/1: Turn the screw. (never answered)"]


async def test_an_unanswered_question_is_listed_once(author: Author) -> None:
    await author.answer("stage/1", "Turn the screw.", None, None)
    assert timeline_of(author)[1:] == [
        "QUESTION stage/1: Turn the screw.",
        "QUESTION stage/1 stayed without an answer",
    ]
    await author.die()


async def test_alignments_are_listed_before_and_after(author: Author) -> None:
    await author.die()
    await author.open("beam-to-j4")
    first: dict[str, Json] = {
        "kind": "alignment",
        "quantity": "offset",
        "unit": "mm",
        "round": 1,
        "instruction": "",
    }
    await author.record("stage/1/measure", "offset, round 1", **{**first, "value": 0.43, "u": 0.02})
    await author.record(
        "stage/1/turn", "turn", kind="screw", screw="stage", turns=0.86, text="0.86 turns clockwise"
    )
    last: dict[str, Json] = {**first, "round": 2, "instruction": "0.86 turns clockwise"}
    await author.record("stage/2/measure", "offset, round 2", **{**last, "value": -0.03, "u": 0.02})
    assert "alignment, round 1: offset +0.43 ± 0.04 mm (k = 2)" in timeline_of(author)
    assert "0.86 turns clockwise" in timeline_of(author)
    assert "alignment, round 2: offset -0.03 ± 0.04 mm (k = 2) after: 0.86 turns clockwise" in timeline_of(
        author
    )
    assert dict(summary(author.reader))["alignment"] == "offset: +0.43 mm before, -0.03 mm after 2 round(s)"
    await author.die()


async def test_an_event_of_another_program_is_shown_by_names(author: Author) -> None:
    await author.event("tea", sugar=2, milk=None, warm_c=61.23456789)
    assert timeline_of(author)[1:] == ["tea: sugar 2, warm_c 61.2346"]
    await author.die()


async def test_the_summary_counts_lives_distances_and_segments(author: Author) -> None:
    await author.points(0, 4, 0)
    await author.die()
    await author.reopen(3.0)
    await author.points(5, 6, 1)
    await author.store.finish("stopped", 130)
    lines = dict(summary(author.reader))
    assert story_report(author.reader).origin.simulated
    assert lines["robot"] == "RH-3FRH5515 A1 no. 17"
    assert lines["stored"] == "7 steps, 7 points"
    assert lines["interrupted"].startswith("died 1×; 3.0 s")
    assert lines["P1"] == "7 distances in 2 segment(s)"
    # This run does not say what it was planned with, so it cannot go on.
    assert "to go on" not in lines


async def test_the_summary_labels_parameters_and_gives_their_units(tmp_path: Path) -> None:
    given: dict[str, Json] = {"half_range_deg": 6.0, "most_poses": None, "auto_centre": True}
    meta: dict[str, Json] = {"procedure": "reflector-search", "params": given}
    store = await RunStore.create(tmp_path, "reflector-search", meta, ManualClock(), reserve_bytes=0)
    await store.finish("stopped", 130)
    shown = dict(summary(RunReader(store.path)))
    assert shown["parameters"].splitlines() == ["First scan ±, deg: 6", "Centre by program: true"]


async def test_the_summary_lists_names_without_brackets(tmp_path: Path) -> None:
    meta: dict[str, Json] = {"procedure": "resolution", "params": {"joints": ["A1", "A5"]}}
    store = await RunStore.create(tmp_path, "resolution", meta, ManualClock(), reserve_bytes=0)
    await store.finish("stopped", 130)
    assert dict(summary(RunReader(store.path)))["parameters"] == "Axes: A1, A5"


@dataclass(frozen=True, kw_only=True)
class _Pose(Record):
    table: ClassVar[str] = "poses"
    is_point: ClassVar[bool] = True
    q1_deg: float


class _NoParams(BaseModel):
    pass


class _Poses(Procedure):
    params_type = _NoParams
    records = (_Pose,)


@pytest.mark.parametrize("target", ["", "ball"])
async def test_points_without_reflector_or_segment_are_counted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, target: str
) -> None:
    monkeypatch.setattr(_Pose, "target_column", "target" if target else "")
    for module in (timelines, summaries):
        monkeypatch.setattr(module, "declared_by", lambda _name: _Poses)
    store = await RunStore.create(tmp_path, "poses", {}, ManualClock(), records=[_Pose], reserve_bytes=0)
    for number in range(3):
        row: Row = {"q1_deg": 1.0, "target": "ball"}
        await store.append_step(f"pose/{number:04d}", 1, f"pose {number}", {}, [("poses", row)])
    await store.finish("stopped", 130)
    reader = RunReader(store.path)
    prefix = f"{target}: " if target else ""
    assert timeline(reader)[1].text.startswith(f"{prefix}points 1…3 measured, in ")
    assert dict(summary(reader)).get("ball") == ("3 points" if target else None)


@pytest.mark.parametrize(
    ("kind", "data", "text"),
    [
        (
            "hands",
            {"prompt": "level/1", "op": "turn_screw", "screw": "level", "turns": -0.52},
            "the emulated operator's hands turned the level screw by -0.52 turns",
        ),
        (
            "aim",
            {
                "worst_uncertainty_mm": 0.195011,
                "acceptance_mm": 1,
                "room_mm": 0.8,
                "poses": 24,
                "holds": True,
            },
            "the aim holds over the whole plan: 0.39 mm at worst, 0.80 mm allowed (k = 2), 24 poses",
        ),
        (
            "warmup",
            {
                "warm": False,
                "reflector": "P1",
                "limit_um_per_10min": 5.0,
                "visits": 4,
                "elapsed_min": 6.02793,
                "drift_um_per_10min": None,
            },
            "NOT WARM: drift not known, limit 5 µm in 10 min, 4 visits to P1 in 6 min",
        ),
        ("height", {"j3_mm": 50.5, "u_j3_mm": 0.00579563}, "beam at J3 = 50.50 ± 0.01 mm (k = 2)"),
        (
            "position-repeatability",
            {"pose": 2, "rp_um": 41.23, "u_rp_um": 8.67},
            "pose 2, position: RP = 41.2 ± 17.3 µm (k = 2)",
        ),
        (
            "repeatability",
            {"pose": 1, "reflector": "P1", "refused": "no two arrivals share a dead path"},
            "pose 1, along the beam to P1: no result: no two arrivals share a dead path",
        ),
        (
            "repeatability",
            {
                "pose": 2,
                "reflector": "P1",
                "s_um": 8.04,
                "s_low_um": 3.5,
                "s_high_um": 256.0,
                "rp_um": 24.1,
                "range_um": 11.4,
                "drift_um": None,
            },
            "pose 2, along the beam to P1: S = 8.0 µm (95 %: 3.5…256.0), RP = ±24.1 µm, range 11.4 µm, "
            "drift not known",
        ),
    ],
)
def test_results_read_with_units_and_few_digits(kind: str, data: dict[str, Json], text: str) -> None:
    texts = {kind: text for name in procedure_names() for kind, text in texts_of(name).items()}
    assert event_text(StoredEvent(1, "2026-01-02T03:04:05Z", kind, data), texts) == text


async def test_a_clock_that_jumps_back_disorders_nothing(author: Author) -> None:
    await author.event("warning", text="one")
    await author.points(0, 1, 0)
    author.clock.advance(-3600.0)
    await author.event("warning", text="two")
    await author.answer("clear", "Clear?", "yes", "Ada")
    await author.points(2, 2, 0)
    await author.event("warning", text="three")
    await author.die()
    author.clock.advance(-3600.0)
    await author.reopen(1.0)
    wanted = ("one", "points 1…2", "two", "QUESTION", "ANSWER", "point 3", "three", "DIED", "RESUMED")
    lines = timeline_of(author)
    found = [next(i for i, line in enumerate(lines) if text in line) for text in wanted]
    assert found == sorted(found)
    assert "an unknown time (the clock was set back)" in lines[found[-1]]
    await author.die()


async def test_incidents_have_the_words_of_the_timeline(author: Author) -> None:
    await author.event("beam-lost", reflector="P1", point=3, segment=0)
    await author.event("warning", text="the signal is weak")
    await author.die()
    await author.reopen(3.0)
    texts = [moment.text for moment in incidents(author.reader)]
    assert texts == [text for text in timeline_of(author) if text.startswith(("BEAM LOST", "RESUMED"))]
    assert len(texts) == 2
    await author.die()
