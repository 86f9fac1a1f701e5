"""Runs of older programs are read, verified, exported and gone on with."""

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from catseye.app.results.runs.timeline import timeline
from catseye.app.results.scara.export import run_export
from catseye.app.store import seal
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.app.store.verify import verify
from catseye.procedures.kit.records import Row
from tests.unit.app.engine.fakes import point
from tests.unit.app.store.fakes import PATH_ROW, RECORDS, SEARCH_ROW, TickingClock

DUMPS = Path(__file__).parent / "old_runs"
NAME = "20260102T000001Z_open-loop_0a1b2c"


def stored(folder: Path, version: int) -> Path:
    """Return the directory of a run that a program of that version has stopped and sealed."""
    path = folder / NAME
    path.mkdir()
    with closing(sqlite3.connect(path / seal.DATABASE)) as connection:
        connection.executescript((DUMPS / f"version-{version}.sql").read_text("utf-8"))
    for name in (seal.WIRE_LOG, seal.APP_LOG):
        (path / name).touch()
    seal.seal(path, "2026-01-02T00:00:11+00:00")
    return path


@pytest.fixture(params=[1, 4])
def run(tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    return stored(tmp_path, request.param)


def test_an_old_run_is_what_was_written(run: Path) -> None:
    found = verify(run)
    assert (found.problems, found.notes, found.sealed, found.status) == ((), (), True, "stopped")


def test_an_old_runs_rows_are_read(run: Path) -> None:
    reader = RunReader(run)
    first = reader.rows("points")[0]
    assert {name: first[name] for name in point(1)} == point(1)
    (seen,) = reader.rows("search")
    assert {name: seen[name] for name in SEARCH_ROW} == SEARCH_ROW
    assert seen["j4_deg"] == 3.5


def test_a_run_of_version_4_keeps_every_table(tmp_path: Path) -> None:
    reader = RunReader(stored(tmp_path, 4))
    counts = {name: reader.count(name) for name in ("steps", "points", "search", "path", "records", "events")}
    assert counts == {"steps": 3, "points": 2, "search": 1, "path": 1, "records": 1, "events": 3}
    assert reader.rows("points")[0]["material_c"] == 21.5
    assert (reader.rows("points")[1]["refractive_index"], reader.rows("points")[1]["formula"]) == (
        1.00027,
        "ciddor",
    )
    assert reader.rows("path")[0] == {**reader.rows("path")[0], **PATH_ROW, "pass_number": 0, "u_mm": None}
    (overlap,) = reader.records("overlap")
    assert (overlap["previous_segment"], overlap["displacement_mm"]) == (0, 0.1)


def test_an_old_runs_timeline_is_told(run: Path) -> None:
    texts = [moment.text for moment in timeline(RunReader(run))]
    assert any("P1: point" in text for text in texts)
    assert texts[-1] == "ENDED stopped, exit code 5: enough"


def test_an_old_run_is_exported(run: Path) -> None:
    exported = run_export(RunReader(run))
    assert exported.content == "points"
    assert exported.rows[0] == {**exported.rows[0], **point(1)}
    assert "displacement_mm" in next(line for line in exported.csv.splitlines() if not line.startswith("#"))


async def test_an_old_run_goes_on(run: Path) -> None:
    before = len(RunReader(run).rows("points"))
    store = await RunStore.reopen(run, TickingClock(), records=RECORDS, reserve_bytes=0)
    assert store.stored_result("P1/0000") == {"measured": True, "segment": 0}
    corrected = {**point(3), "raw_displacement_mm": 0.1001, "formula": "ciddor"}
    rows: list[tuple[str, Row]] = [("points", corrected), ("records", {"kind": "closure", "drift_um": 1.5})]
    await store.append_step("P1/0002", 1, "P1: third", {}, rows)
    await store.finish("complete", 0)
    reader = RunReader(run)
    assert [row["raw_displacement_mm"] for row in reader.rows("points")][before:] == [0.1001]
    assert reader.rows("points")[0]["formula"] is None
    assert reader.records("closure")[0]["drift_um"] == 1.5
    assert verify(run).problems == ()


@pytest.mark.parametrize("table", ["points", "steps", "events", "records"])
async def test_an_old_run_that_went_on_stays_append_only(run: Path, table: str) -> None:
    store = await RunStore.reopen(run, TickingClock(), records=RECORDS, reserve_bytes=0)
    await store.append_step("c", 1, "closure", {}, [("records", {"kind": "closure"})])
    await store.abandon()
    with closing(sqlite3.connect(run / seal.DATABASE)) as connection:
        for statement in (f"DELETE FROM {table}", f"UPDATE {table} SET rowid = rowid + 100"):
            with pytest.raises(sqlite3.IntegrityError, match="append-only"):
                connection.execute(statement)
