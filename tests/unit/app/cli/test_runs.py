"""The list of runs and the timeline as they are printed."""

import json
import os
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from typer.testing import CliRunner

from catseye.app.cli import cli
from catseye.app.cli.show import show
from catseye.app.cli.verify import verify as verify_command
from catseye.app.errors import UsageError
from catseye.app.files.atomic import write_atomically
from catseye.app.store.mend import seal_late
from catseye.app.store.run_store import RunStore
from catseye.app.store.seal import DATABASE, read_manifest
from catseye.app.store.verify import verify
from catseye.procedures.kit.records import Json
from tests.unit.app.engine.fakes import ManualClock

ENOUGH: dict[str, Json] = {
    "configuration": {},
    "configuration_file": "cell.toml",
    "params": {},
    "aim": "cell file",
    "aimed": {},
    "clock_speed": 1.0,
    "plan_sha256": "",
}
"""Everything that going on needs, as far as a list of runs looks."""


async def store(root: Path, status: str | None, meta: dict[str, Json]) -> Path:
    """Store a run of one step; without a status it dies."""
    clock = ManualClock()
    made = await RunStore.create(root, "open-loop", meta, clock, reserve_bytes=0)
    clock.advance(1.25)
    await made.append_step("a/0001", 1, "a step", {}, [])
    clock.advance(1.0)
    await (made.abandon() if status is None else made.finish(status, 0, ""))
    return made.path


def listed(root: Path, *options: str) -> str:
    """Return what the command writes."""
    done = CliRunner().invoke(cli, ["runs", "--runs", str(root), *options])
    assert done.exit_code == 0, done.output
    return done.stdout


async def test_resumable_runs_are_listed_with_the_command(tmp_path: Path) -> None:
    complete = await store(tmp_path, "complete", ENOUGH)
    dead = await store(tmp_path, None, ENOUGH)
    aborted = await store(tmp_path, "aborted", ENOUGH)
    old = await store(tmp_path, "stopped", {})
    lines = {line.split()[0]: line for line in listed(tmp_path).splitlines() if line}
    for path in (dead, aborted):
        run_id = path.name.rpartition("_")[2]
        assert lines[run_id].endswith(f"catseye resume {run_id}")
    for path in (complete, old):
        assert "resume" not in lines[path.name.rpartition("_")[2]]
    rows = [json.loads(line) for line in listed(tmp_path, "--json").splitlines()]
    assert {row["run"] for row in rows if row["resumable"]} == {dead.name, aborted.name}


async def test_a_run_with_damaged_events_does_not_hide_others(tmp_path: Path) -> None:
    damaged, sound = await store(tmp_path, None, ENOUGH), await store(tmp_path, None, ENOUGH)
    with closing(sqlite3.connect(damaged / DATABASE, isolation_level=None)) as connection:
        connection.execute("PRAGMA ignore_check_constraints=1")
        connection.execute("INSERT INTO events (time_utc, kind, data) VALUES ('', 'note', 'no JSON')")
    rows = [json.loads(line) for line in listed(tmp_path, "--json").splitlines()]
    assert {row["run"]: row["resumable"] for row in rows} == {damaged.name: False, sound.name: True}


async def test_the_timeline_is_wrapped_and_dated(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = await store(tmp_path, None, ENOUGH)
    clock = ManualClock()
    clock.advance(60.0)
    again = await RunStore.reopen(path, clock, reserve_bytes=0)
    await again.event("warning", {"text": "word " * 60})
    await again.finish("stopped", 130, "the operator stopped the run")
    show(str(path), as_json=False)
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == f"{path.name}: stopped"
    assert "2026-01-02 (UTC)" in lines
    assert all(len(line) <= 118 for line in lines)
    warning = next(number for number, line in enumerate(lines) if "WARNING" in line)
    assert lines[warning].startswith("  03:05:05.0  WARNING: word")
    assert "  03:04:06.2  a step, in 0.0 s" in lines
    assert lines[warning + 1].startswith(" " * 14 + "word")
    assert "  03:04:06.2  DIED: nothing was stored after this, the run was not closed" in lines
    assert lines[-1].endswith("ENDED stopped, exit code 130: the operator stopped the run")


async def test_what_an_older_program_stored_does_not_command_the_terminal(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot: Json = {"model": "CR800\x1b]0;owned\x07", "version": "1", "serial": ""}
    made = await RunStore.create(
        tmp_path, "open-loop", {**ENOUGH, "devices": {"robot": robot}}, ManualClock(), reserve_bytes=0
    )
    await made.event("warning", {"text": "it says \x1b[2J\x9b1m"})
    await made.finish("failed", 1, "it says \x1b[5m")
    show(str(made.path), as_json=False)
    output = capsys.readouterr().out
    assert all(line.isprintable() for line in output.splitlines())
    assert r"CR800\x1b]0;owned\x07" in output
    assert r"WARNING: it says \x1b[2J\x9b1m" in output


async def test_a_path_that_is_no_utf_8_is_reported(
    tmp_path: Path, capsysbinary: pytest.CaptureFixture[bytes]
) -> None:
    file = os.fsdecode(b"/bench/\xff.toml")
    made = await RunStore.create(
        tmp_path, "open-loop", {**ENOUGH, "configuration_file": file}, ManualClock(), reserve_bytes=0
    )
    await made.finish("complete", 0)
    show(str(made.path), as_json=True)
    assert json.loads(capsysbinary.readouterr().out)["meta"]["configuration_file"] == file
    write_atomically(tmp_path / "about.json", json.dumps(file, ensure_ascii=False))
    assert json.loads((tmp_path / "about.json").read_text()) == file


async def test_the_facts_keep_their_names(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = await store(tmp_path, "complete", ENOUGH)
    show(str(path), as_json=True)
    facts = json.loads(capsys.readouterr().out)
    old = {"run", "status", "exit_code", "meta", "counts", "results", "events", "prompts"}
    assert set(facts) == old | {"format", "resumable", "story", "found", "said"}
    assert facts["found"] == {}
    assert facts["story"][-1]["text"] == "ENDED complete, exit code 0"
    assert facts["resumable"] is False


async def test_a_complete_run_whose_process_died_unsealed_is_sealed_late(tmp_path: Path) -> None:
    made = await RunStore.create(tmp_path, "open-loop", ENOUGH, ManualClock(), reserve_bytes=0)
    await made.append_step("a/0001", 1, "a step", {}, [])
    await made.event("run-ended", {"status": "complete", "exit_code": 0})
    await made.abandon()
    assert read_manifest(made.path) is None
    assert seal_late(made.path, "2026-01-02T03:04:05+00:00")
    assert read_manifest(made.path) is not None
    assert verify(made.path).ok
    assert not seal_late(made.path, "2026-01-02T03:04:06+00:00")


async def test_verify_says_manifest_only_where_there_is_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sealed, dead = await store(tmp_path, "complete", ENOUGH), await store(tmp_path, None, ENOUGH)
    verify_command(str(sealed), as_json=False)
    assert capsys.readouterr().err == f"✓ {sealed.name}: manifest, database and sequence numbers agree\n"
    verify_command(str(dead), as_json=False)
    first, second = capsys.readouterr().err.splitlines()
    assert first == f"✓ {dead.name}: database and sequence numbers agree"
    assert second == f"{dead.name}: not sealed: its process died before it was closed"


async def test_verify_writes_its_notes_as_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for status, sealed in ((None, False), ("complete", True)):
        path = await store(tmp_path, status, ENOUGH)
        verify_command(str(path), as_json=True)
        facts = json.loads(capsys.readouterr().out)
        assert (facts["sound"], facts["problems"], facts["sealed"]) == (True, [], sealed)
        assert bool(facts["notes"]) is not sealed


async def test_verify_says_what_was_dropped(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made = await RunStore.create(tmp_path, "open-loop", ENOUGH, ManualClock(), reserve_bytes=0)
    await made.drop_step("a/0001", 1, {"error": "the beam was lost"})
    await made.finish("complete", 0)
    verify_command(str(made.path), as_json=False)
    assert "step a/0001 was dropped: the beam was lost" in capsys.readouterr().err


@pytest.mark.parametrize("words", [["--runs", "elsewhere"], ["--json"]])
def test_options_before_prune_are_refused_and_not_lost(words: list[str], tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    done = CliRunner().invoke(cli, ["runs", *words, "prune", "--older-than", "1d"])
    assert isinstance(done.exception, UsageError)
    assert "after prune" in str(done.exception)


def test_an_age_beyond_the_calendar_is_refused(tmp_path: Path) -> None:
    done = CliRunner().invoke(
        cli, ["runs", "prune", "--older-than", "999999999999d", "--runs", str(tmp_path)]
    )
    assert isinstance(done.exception, UsageError)
