"""What stored runs give to later steps: the aim of a search, the mean of a validation path."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from catseye.app.errors import StorageError, UsageError
from catseye.app.results.scara.path_rows import path_measurement
from catseye.app.results.scara.validation import established_rows
from catseye.app.store.aftermath import find_aftermath
from catseye.app.store.basis import find_basis
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.calibration.scara.points import Commands
from catseye.procedures.kit.records import Json, Row
from catseye.procedures.scara.aiming import SEARCHED
from catseye.procedures.scara.before import TURNED
from tests.unit.app.store.fakes import RECORDS, TickingClock
from tests.unit.procedures.benches import bench


def solution(x_mm: float) -> dict[str, Json]:
    return {"reflectors": [{"name": "P1", "x_mm": x_mm, "y_mm": -401.0}], "theta40_deg": 1.25}


class Shelf:
    """A folder of runs that is filled run by run."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.clock = TickingClock()

    async def put(
        self,
        procedure: str,
        result: Mapping[str, Json] | None,
        status: str = "complete",
        cell: str = "lab-1",
        rows: list[Row] | None = None,
        off_mm: float = 0.0,
        asked: Mapping[str, str | None] | None = None,
        mounted_deg: tuple[float, ...] = (),
    ) -> Path:
        """Store a run of a cell file whose reflectors stand off by some mm."""
        places: list[Json] = [
            {"name": r.name, "x_mm": r.x_mm + off_mm, "y_mm": r.y_mm} for r in bench().reflectors
        ]
        meta: dict[str, Json] = {"cell": cell, "configuration": {"reflector": places}}
        store = await RunStore.create(
            self.root, procedure, meta, self.clock, records=RECORDS, reserve_bytes=0
        )
        if rows:
            await store.append_step("rows", 1, "rows", {}, [("path", row) for row in rows])
        if result is not None:
            await store.append_step("solve", 1, "solve", result, [])
        for prompt_id, answer in (asked or {}).items():
            await store.event("asked", {"id": prompt_id, "text": "Turn it.", "asked_utc": "now"})
            if answer is not None:
                await store.prompt(prompt_id, "confirm", "Turn it.", "now", answer, "somebody")
        for turned_deg in mounted_deg:
            await store.event("mounted", {"turned_deg": turned_deg})
        await store.finish(status, 0)
        return store.path


@pytest.fixture
def shelf(tmp_path: Path) -> Shelf:
    return Shelf(tmp_path)


async def test_the_newest_complete_search_of_the_cell_gives_the_aim(shelf: Shelf) -> None:
    await shelf.put("reflector-search", solution(651.0))
    newest = await shelf.put("reflector-search", solution(652.0))
    await shelf.put("reflector-search", solution(653.0), cell="lab-2")
    await shelf.put("reflector-search", solution(654.0), status="stopped")
    await shelf.put("reflector-search", solution(655.0), off_mm=30.0)
    await shelf.put("reflector-search", None)
    await shelf.put("open-loop", None)
    aim = find_basis(SEARCHED, bench(), shelf.root)
    assert aim.source == newest.name
    assert (aim.bench.reflectors[0].x_mm, aim.bench.reflectors[0].y_mm) == (652.0, -401.0)
    assert aim.bench.reflectors[1:] == bench().reflectors[1:]
    assert aim.bench.optics.theta40_deg == 1.25


@pytest.mark.parametrize("answer", ["yes", None])
async def test_a_search_before_the_beam_was_moved_is_refused(shelf: Shelf, answer: str | None) -> None:
    before = await shelf.put("beam-to-j4", None, asked={"stage/1": "yes"})
    search = await shelf.put("reflector-search", solution(651.0))
    # None of these moves this beam after the search.
    await shelf.put("beam-to-j4", None)
    await shelf.put("beam-to-j4", None, status="failed", asked={"stage/1": "no"})
    await shelf.put("beam-to-j4", None, cell="lab-2", asked={"stage/1": "yes"})
    await shelf.put("beam-level", None, asked={"level/1": "yes"})
    assert find_basis(SEARCHED, bench(), shelf.root).source == search.name
    # The last question was put to hands before the process died, or they said so: the run need not be complete.
    moved = await shelf.put("beam-to-j4", None, status="stopped", asked={"stage/1": answer})
    assert before.name < search.name < moved.name
    with pytest.raises(UsageError, match=f"{moved.name} moved the beam after {search.name}.*Search again"):
        find_basis(SEARCHED, bench(), shelf.root)
    assert find_basis(SEARCHED, bench(), shelf.root, search.name).source == search.name
    assert find_basis(SEARCHED, bench(), shelf.root, "none").source == "cell file"
    again = await shelf.put("reflector-search", solution(652.0))
    assert find_basis(SEARCHED, bench(), shelf.root).source == again.name


async def test_a_search_before_the_interferometer_was_turned_is_refused(shelf: Shelf) -> None:
    search = await shelf.put("reflector-search", solution(651.0))
    await shelf.put("open-loop", None, asked={"place/P1": "yes"})
    await shelf.put("open-loop", None, asked={"mount/1": "no"}, status="failed")
    assert find_basis(SEARCHED, bench(), shelf.root).source == search.name
    turned = await shelf.put("open-loop", None, asked={"mount/1": "no", "mount/2": "yes"}, status="stopped")
    with pytest.raises(UsageError, match=f"{turned.name} moved the beam after {search.name}"):
        find_basis(SEARCHED, bench(), shelf.root)


async def test_a_run_that_left_the_interferometer_turned_is_named(shelf: Shelf) -> None:
    assert find_aftermath(TURNED, "lab-1", shelf.root) == ""
    turned = await shelf.put("open-loop", None, status="failed", mounted_deg=(180.0, 178.75))
    await shelf.put("reflector-search", None, status="failed")
    await shelf.put("open-loop", None)
    text = find_aftermath(TURNED, "lab-1", shelf.root)
    assert text.startswith(f"{turned.name} left the interferometer turned by 178.8°")
    assert find_aftermath(TURNED, "lab-2", shelf.root) == ""
    assert find_aftermath(None, "lab-1", shelf.root) == ""


async def test_a_search_that_succeeds_settles_how_it_is_mounted(shelf: Shelf) -> None:
    await shelf.put("open-loop", None, mounted_deg=(178.75,))
    await shelf.put("reflector-search", solution(651.0))
    assert find_aftermath(TURNED, "lab-1", shelf.root) == ""


async def test_a_mounting_that_was_not_turned_leaves_nothing(shelf: Shelf) -> None:
    await shelf.put("open-loop", None, status="failed", mounted_deg=(180.0, 0.0))
    assert find_aftermath(TURNED, "lab-1", shelf.root) == ""


async def test_without_a_search_the_cell_file_gives_the_aim(shelf: Shelf) -> None:
    assert find_basis(SEARCHED, bench(), shelf.root).source == "cell file"
    await shelf.put("reflector-search", solution(651.0))
    aim = find_basis(SEARCHED, bench(), shelf.root, "none")
    assert (aim.source, aim.bench) == ("cell file", bench())


async def test_a_named_older_search_gives_the_aim(shelf: Shelf) -> None:
    older = await shelf.put("reflector-search", solution(651.0))
    await shelf.put("reflector-search", solution(652.0))
    assert find_basis(SEARCHED, bench(), shelf.root, older.name[-6:]).bench.reflectors[0].x_mm == 651.0


async def test_a_run_not_searching_these_reflectors_is_refused(shelf: Shelf) -> None:
    other = await shelf.put("open-loop", None)
    with pytest.raises(UsageError, match=f"{other.name} is not a complete reflector search; search first"):
        find_basis(SEARCHED, bench(), shelf.root, other.name)
    foreign = await shelf.put("reflector-search", solution(651.0), off_mm=0.5)
    with pytest.raises(
        UsageError, match=f"{foreign.name} searched reflectors at other rough places.*search again"
    ):
        find_basis(SEARCHED, bench(), shelf.root, foreign.name)


def path_row(i: int, pass_number: int, error_mm: float) -> Row:
    y = [0.0, 10.0, 10.0, 0.0][i]
    return {
        "x_mm": 200.0,
        "y_mm": y,
        "theta1_deg": 10.0 * i,
        "theta2_deg": 90.0,
        "direction1": 1,
        "direction2": -1,
        "x_meas_mm": 200.0 + error_mm,
        "y_meas_mm": y - 2 * error_mm,
        "u_mm": 0.006,
        "pass_number": pass_number,
    }


async def test_passes_are_averaged_and_a_broken_one_is_left_out(shelf: Shelf) -> None:
    rows = [path_row(i, p, error) for p, error in ((0, 0.01), (1, 0.03)) for i in range(4)]
    rows += [path_row(i, 2, 9.0) for i in range(2)]
    path = path_measurement(RunReader(await shelf.put("validation-path", None, rows=rows)), 1.0)
    assert path.measured_mm == pytest.approx(
        np.array([[200.02, -0.04], [200.02, 9.96], [200.02, 9.96], [200.02, -0.04]])
    )
    # What the instrument's frame, scale and angles are wrong by is the same in each pass.
    assert path.u_mm == pytest.approx(np.full(4, 0.006))
    assert path.travel.tolist() == [1, 1, -1, -1]
    assert path.commands.theta1_rad == pytest.approx(np.radians([0.0, 10.0, 20.0, 30.0]))
    assert path.commands.direction2.tolist() == [-1] * 4
    assert path.established.all()


async def test_a_stopped_path_keeps_its_directions_of_travel(shelf: Shelf) -> None:
    # Three of four rows: the far end was reached, and one row of the way back.
    rows = [path_row(i, 0, 0.01) for i in range(3)]
    stopped = path_measurement(RunReader(await shelf.put("validation-path", None, rows=rows)), 1.0)
    assert stopped.travel.tolist() == [1, 1, -1]
    only_there = path_measurement(RunReader(await shelf.put("validation-path", None, rows=rows[:2])), 1.0)
    assert only_there.travel.tolist() == [1, 1]


async def test_a_run_without_a_path_is_refused(shelf: Shelf) -> None:
    run = await shelf.put("open-loop", None)
    with pytest.raises(UsageError, match="holds no path; it takes a run of validation-path"):
        path_measurement(RunReader(run), 1.0)


def test_a_direction_holds_again_after_the_take_up_angle() -> None:
    theta1 = np.radians([0.0, 2.0, 1.6, 1.1, 0.9, -3.0, -2.5, -2.5, -1.9])
    directions = np.array([1, 1, -1, -1, -1, -1, 1, 1, 1])
    still = np.radians(np.full(9, 40.0))
    commands = Commands(theta1, still, directions, np.ones(9, dtype=np.int64))
    # Reversed at 2.0°: 0.4°, 0.9° and 1.1° back; reversed at -3.0°: 0.5°, 0.5° and 1.1° back.
    expected = [True, True, False, False, True, True, False, False, True]
    assert established_rows(commands, np.radians(1.0)).tolist() == expected
    swapped = Commands(still, theta1, np.ones(9, dtype=np.int64), directions)
    assert established_rows(swapped, np.radians(1.0)).tolist() == expected


async def test_a_changed_search_aims_nothing(shelf: Shelf) -> None:
    search = await shelf.put("reflector-search", solution(651.0))
    (search / "wire.log").chmod(0o644)
    (search / "wire.log").write_text("changed")
    for wanted in ("auto", search.name):
        with pytest.raises(StorageError, match=search.name):
            find_basis(SEARCHED, bench(), shelf.root, wanted)
