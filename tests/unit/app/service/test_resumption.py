"""The rest of an interrupted run is planned from the run alone, exactly as the whole was."""

import re
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.errors import StorageError, UsageError
from catseye.app.protocol.procedures import load_procedure, parse_params
from catseye.app.service.plan_digest import plan_digest
from catseye.app.service.resumption import plan_resume
from catseye.app.service.running import PlannedRun, plan_run, run_meta
from catseye.app.store.resumable import MOVED
from catseye.app.store.run_store import RunStore
from catseye.procedures.kit.records import Json
from catseye.procedures.scara.bench import ScaraBench
from tests.unit.app.engine.fakes import ManualClock

SMALL = re.sub(
    r"theta2_deg = .*",
    "theta2_deg = [40.0, 70.0]",
    re.sub(r"theta1_deg = .*", "theta1_deg = [-60.0, -30.0]", TEMPLATE),
)
FOUND: dict[str, Json] = {
    "reflectors": [
        {"name": "P1", "x_mm": 651.25, "y_mm": -399.5},
        {"name": "P2", "x_mm": 679.0, "y_mm": 1.5},
        {"name": "P3", "x_mm": 640.5, "y_mm": 381.0},
    ],
    "theta40_deg": 0.75,
}


@pytest.fixture
def cell(tmp_path: Path) -> Path:
    file = tmp_path / "cell.toml"
    file.write_text(SMALL, encoding="utf-8")
    return file


@pytest.fixture
def root(tmp_path: Path) -> Path:
    return tmp_path / "runs"


def write(cell: Path, text: str) -> None:
    cell.write_text(text, encoding="utf-8")


def lose(cell: Path, search: Path) -> None:
    cell.unlink()
    shutil.rmtree(search)


def planned(cell: Path, root: Path) -> PlannedRun:
    procedure = load_procedure("open-loop")
    params = parse_params(procedure.params_type, ['reflectors=["P1", "P3"]'])
    return plan_run(load_cell(cell), procedure, params, root, "auto")


async def stored(
    root: Path,
    procedure: str,
    meta: dict[str, Json],
    *,
    result: dict[str, Json] | None = None,
    status: str | None = "stopped",
) -> RunStore:
    """Store a run with one step."""
    store = await RunStore.create(root, procedure, meta, ManualClock(), reserve_bytes=0)
    await store.append_step("solve", 1, "a step", result or {}, [])
    if status is not None:
        await store.finish(status, 0)
    return store


async def searched(cell: Path, root: Path) -> Path:
    configuration = load_cell(cell).cell.model_dump(mode="json")
    meta: dict[str, Json] = {"cell": "lab-1", "simulated": True, "configuration": configuration}
    return (await stored(root, "reflector-search", meta, result=FOUND, status="complete")).path


async def interrupted(
    cell: Path, root: Path, *, drop: str = "", status: str | None = "stopped", **changes: Json
) -> RunStore:
    """Store a run that can go on, unless something is changed or dropped from what it says about itself."""
    meta = {"cell": "lab-1", **run_meta(planned(cell, root), 50.0), **changes}
    meta.pop(drop, None)
    return await stored(root, "open-loop", meta, status=status)


async def test_neither_cell_file_nor_search_have_to_be_there(cell: Path, root: Path) -> None:
    search = await searched(cell, root)
    whole = planned(cell, root)
    assert whole.aim == search.name
    run = (await interrupted(cell, root)).path
    lose(cell, search)
    rest = plan_resume(root, run.name)
    assert rest.bench == whole.bench
    assert isinstance(rest.bench, ScaraBench)
    assert (rest.bench.reflectors[0].x_mm, rest.bench.optics.theta40_deg) == (651.25, 0.75)
    assert rest.params == whole.params
    assert plan_digest(rest.plan) == plan_digest(whole.plan)
    assert [part.reflector.name for part in rest.plan.reflectors] == ["P1", "P3"]
    assert (rest.resume, rest.clock_speed, rest.aim, rest.aim_simulated) == (run, 50.0, search.name, True)
    assert rest.loaded.cell == whole.loaded.cell
    assert not rest.relinked


async def test_resuming_accepts_other_endpoints_and_timeouts(cell: Path, root: Path) -> None:
    run = (await interrupted(cell, root)).path
    text = SMALL.replace("127.0.0.1:10001", "127.0.0.1:40001")
    write(cell, text + "\n[environment.settings]\ntimeout_s = 5.0\n")
    rest = plan_resume(root, run.name, load_cell(cell))
    assert rest.loaded.cell.robot.endpoint == "tcp://127.0.0.1:40001"
    assert rest.loaded.cell.instruments["environment"].settings == {"timeout_s": 5.0}
    assert rest.relinked


HOOKS = '[hooks]\non = ["alarm"]\ncommand = ["{}"]\n\n[engine]'


async def test_resuming_takes_hooks_from_the_cell_file(cell: Path, root: Path) -> None:
    write(cell, SMALL.replace("[engine]", HOOKS.format("before")))
    run = (await interrupted(cell, root)).path
    write(cell, SMALL.replace("[engine]", HOOKS.format("now")))
    assert plan_resume(root, run.name).loaded.cell.hooks.command == ["now"]
    assert plan_resume(root, run.name, load_cell(cell)).loaded.cell.hooks.command == ["now"]


async def test_a_record_starts_no_command(cell: Path, root: Path) -> None:
    write(cell, SMALL.replace("[engine]", HOOKS.format("evil")))
    whole = load_cell(cell).cell.model_dump(mode="json")
    run = (await interrupted(cell, root, configuration=whole)).path
    assert "hooks" not in run_meta(planned(cell, root), 1.0)["configuration"]  # type: ignore[operator]
    write(cell, SMALL)
    assert plan_resume(root, run.name).loaded.cell.hooks.command == []


async def test_new_endpoints_stay_with_the_run(cell: Path, root: Path) -> None:
    run = (await interrupted(cell, root)).path
    write(cell, SMALL.replace("127.0.0.1:10001", "127.0.0.1:40001"))
    configuration = load_cell(cell).cell.model_dump(mode="json")
    store = await RunStore.reopen(run, ManualClock(), {"configuration": configuration}, reserve_bytes=0)
    await store.abandon()
    assert plan_resume(root, run.name).loaded.cell.robot.endpoint == "tcp://127.0.0.1:40001"


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("settle_time_s = 0.5", "settle_time_s = 0.4", "measurement.settle_time_s"),
        ("x_mm = 680.0", "x_mm = 681.0", "reflector[2].x_mm"),
        ('name = "lab-1"', 'name = "lab-2"', "name"),
        ("override_cap_percent = 20", "override_cap_percent = 30", "robot.override_cap_percent"),
        ('map = "vaisala"', 'map = "vaisala"\nsettings = { unit = 7 }', "environment.settings.unit"),
    ],
)
async def test_a_cell_file_may_change_nothing_else(
    cell: Path, root: Path, old: str, new: str, key: str
) -> None:
    run = (await interrupted(cell, root)).path
    assert SMALL.count(old) == 1
    changed = SMALL.replace(old, new).replace("127.0.0.1:10001", "127.0.0.1:40001")
    write(cell, changed)
    with pytest.raises(UsageError) as refused:
        plan_resume(root, run.name, load_cell(cell))
    assert f"these differ: {key};" in str(refused.value)


async def test_a_complete_run_is_refused(cell: Path, root: Path) -> None:
    run = (await interrupted(cell, root, status="complete")).path
    with pytest.raises(UsageError, match="is complete"):
        plan_resume(root, run.name)


async def test_a_run_that_is_under_way_is_to_be_attached(cell: Path, root: Path) -> None:
    store = await interrupted(cell, root, status=None)
    with pytest.raises(UsageError, match=f"catseye attach {store.path.name}"):
        plan_resume(root, store.path.name)
    await store.abandon()
    assert plan_resume(root, store.path.name).resume == store.path


@pytest.mark.parametrize("key", ["aimed", "clock_speed", "plan_sha256"])
async def test_an_older_run_is_refused_naming_the_missing_key(cell: Path, root: Path, key: str) -> None:
    run = (await interrupted(cell, root, drop=key)).path
    with pytest.raises(UsageError, match=rf"did not store what going on needs \({key}\)"):
        plan_resume(root, run.name)


async def test_a_run_that_died_before_it_described_itself_is_refused(cell: Path, root: Path) -> None:
    run = (await interrupted(cell, root, drop="configuration")).path
    with pytest.raises(UsageError, match="died before it had stored its configuration"):
        plan_resume(root, run.name)


async def test_a_run_whose_reflectors_were_moved_never_goes_on(cell: Path, root: Path) -> None:
    store = await interrupted(cell, root, status=None)
    await store.event(MOVED, {})
    await store.finish("failed", 1)
    with pytest.raises(UsageError, match="search again and start a new run"):
        plan_resume(root, store.path.name)


async def test_a_program_that_plans_differently_does_not_go_on(cell: Path, root: Path) -> None:
    run = (await interrupted(cell, root, plan_sha256="0" * 64)).path
    with pytest.raises(UsageError, match="plans it differently"):
        plan_resume(root, run.name)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"configuration": {"format": "catseye-cell/1"}}, "does not fit this program"),
        ({"params": {"reflectors": [], "gone": 1}}, "parameters do not fit"),
    ],
)
async def test_what_this_program_does_not_understand_is_refused(
    cell: Path, root: Path, changes: dict[str, Any], message: str
) -> None:
    run = (await interrupted(cell, root, **changes)).path
    with pytest.raises(UsageError, match=message):
        plan_resume(root, run.name)


def test_a_plan_has_one_fingerprint_in_every_process(cell: Path, root: Path) -> None:
    one, other = (planned(cell, root).plan for _ in range(2))
    assert plan_digest(one) == plan_digest(other)
    assert (
        len({plan_digest(value) for value in (one, one.reflectors[0], {"a": 1}, {"a": 2}, (1, 2), ())}) == 6
    )
    assert plan_digest(0.1 + 0.2) == plan_digest(0.3)
    assert plan_digest({1.0, 2.0}) == plan_digest({2.0, 1.0})
    assert plan_digest(-0.0) == plan_digest(0.0)


async def test_a_run_changed_after_its_end_does_not_go_on(cell: Path, root: Path) -> None:
    run = (await interrupted(cell, root)).path
    (run / "app.log").chmod(0o644)
    (run / "app.log").write_text("changed")
    with pytest.raises(StorageError, match=r"app\.log was changed after the end"):
        plan_resume(root, run.name)


async def test_a_dead_run_with_a_changed_row_is_not_resumed(cell: Path, root: Path) -> None:
    store = await interrupted(cell, root, status=None)
    await store.abandon()
    with closing(sqlite3.connect(store.path / "run.sqlite")) as connection, connection:
        connection.execute("DROP TRIGGER steps_no_update")
        connection.execute("UPDATE steps SET result = '{\"changed\":1}'")
    with pytest.raises(StorageError, match="row 1 of steps is not what was written"):
        plan_resume(root, store.path.name)
