"""Old runs go, unless they are not sealed, under way or kept."""

import shutil
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from catseye.app.errors import StorageError
from catseye.app.store import prune
from catseye.app.store.lock import RunLock
from catseye.app.store.prune import KEPT, finish_removing, keep, kept_runs, old_runs, release, remove
from catseye.app.store.run_store import RunStore
from catseye.app.store.seal import unseal
from catseye.procedures.kit.records import Json
from tests.unit.app.engine.fakes import ManualClock

NOW = datetime(2026, 6, 1, tzinfo=UTC)
AGE = timedelta(days=90)
META: dict[str, Json] = {
    "cell": "lab-1",
    **dict.fromkeys(
        ("configuration", "configuration_file", "params", "aim", "aimed", "clock_speed", "plan_sha256"),
        "stated",
    ),
}
"""What a run that goes on needs of itself."""


async def stored(root: Path, *, sealed: bool = True, status: str = "complete") -> Path:
    """Return a run of the second of January 2026."""
    store = await RunStore.create(root, "open-loop", META, ManualClock(), reserve_bytes=0)
    await store.finish(status, 0)
    if not sealed:
        unseal(store.path)
    return store.path


def names(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir() if path.name != ".kept.lock"]


def reasons(root: Path, now: datetime = NOW) -> dict[str, str]:
    return {one.path.name: one.why_not for one in old_runs(root, AGE, now)}


async def test_a_sealed_old_run_goes(tmp_path: Path) -> None:
    run = await stored(tmp_path)
    assert reasons(tmp_path) == {run.name: ""}
    assert remove(run) == ""
    assert names(tmp_path) == []


async def test_a_young_run_is_not_looked_at(tmp_path: Path) -> None:
    await stored(tmp_path)
    assert reasons(tmp_path, datetime(2026, 3, 1, tzinfo=UTC)) == {}


async def test_an_unsealed_run_stays(tmp_path: Path) -> None:
    run = await stored(tmp_path, sealed=False)
    assert reasons(tmp_path)[run.name].startswith("it is not sealed")


async def test_a_run_that_can_go_on_stays_unless_asked(tmp_path: Path) -> None:
    run = await stored(tmp_path, status="stopped")
    assert reasons(tmp_path)[run.name].startswith("it can go on")
    assert [one.why_not for one in old_runs(tmp_path, AGE, NOW, unfinished=True)] == [""]


@pytest.mark.parametrize("looked_at", ["_bytes", "is_being_written", "read_manifest", "RunReader"])
async def test_what_somebody_else_removes_meanwhile_is_passed_over(
    looked_at: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run, look = await stored(tmp_path), getattr(prune, looked_at)

    def late(path: Path, *more: object) -> object:
        shutil.rmtree(run)
        return look(path, *more)

    monkeypatch.setattr(prune, looked_at, late)
    assert old_runs(tmp_path, AGE, NOW) == []


async def test_a_run_under_way_stays(tmp_path: Path) -> None:
    run = await stored(tmp_path)
    lock = RunLock(run)
    try:
        assert reasons(tmp_path) == {run.name: "it is under way"}
        assert remove(run) == "it is under way"
    finally:
        lock.release()
    assert run.is_dir()


async def test_a_kept_run_stays_until_it_is_released(tmp_path: Path) -> None:
    run = await stored(tmp_path)
    keep(tmp_path, [run.name], "runs of baseline.json")
    assert reasons(tmp_path) == {run.name: "kept: runs of baseline.json"}
    release(tmp_path, [run.name])
    assert reasons(tmp_path) == {run.name: ""}


async def test_a_run_that_was_kept_meanwhile_stays(tmp_path: Path) -> None:
    run = await stored(tmp_path)
    assert reasons(tmp_path) == {run.name: ""}
    keep(tmp_path, [run.name], "runs of baseline.json")
    assert remove(run) == "kept: runs of baseline.json"
    assert run.is_dir()


async def test_a_run_that_another_prune_removed_is_gone(tmp_path: Path) -> None:
    run = await stored(tmp_path)
    assert remove(run) == ""
    assert remove(run) == "somebody else has removed it"


async def test_nobody_opens_a_run_that_is_being_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = await stored(tmp_path)
    refused: list[str] = []

    def look(path: Path, **_how: object) -> None:
        with pytest.raises(StorageError) as error:
            RunLock(path)
        refused.append(str(error.value))

    monkeypatch.setattr(shutil, "rmtree", look)
    remove(run)
    assert refused
    assert not run.exists()


async def test_two_who_keep_at_once_lose_nothing(tmp_path: Path) -> None:
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda number: keep(tmp_path, [f"run-{number}"], "asked"), range(40)))
    assert set(kept_runs(tmp_path).runs) == {f"run-{number}" for number in range(40)}


async def test_nothing_goes_while_the_kept_ones_are_unknown(tmp_path: Path) -> None:
    await stored(tmp_path)
    (tmp_path / KEPT).write_text("{")
    with pytest.raises(StorageError, match="cannot be read"):
        reasons(tmp_path)


async def test_an_interrupted_removal_is_finished(tmp_path: Path) -> None:
    run = await stored(tmp_path)
    run.rename(tmp_path / f".removed-{run.name}")
    assert reasons(tmp_path) == {}
    finish_removing(tmp_path)
    assert names(tmp_path) == []
