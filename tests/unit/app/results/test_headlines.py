"""The figure that stands for a finished stage."""

import json
from pathlib import Path

import pytest

from catseye.app.errors import UsageError
from catseye.app.results.headlines import headline_of_result, headline_of_run, headline_of_written
from catseye.app.results.readiness.headline import Headline, Written
from catseye.app.results.resolution.result import write_resolution
from catseye.app.results.scara.result import write_result
from catseye.app.store.run_store import RunStore
from catseye.procedures.kit.records import Row
from tests.unit.app.results.resolution.sample import sample_result
from tests.unit.app.results.scara import sample
from tests.unit.app.results.warm_ups import stored_warm_up
from tests.unit.app.store.fakes import TickingClock
from tests.unit.app.test_path_comparison import distances, identified, positions, stored


@pytest.mark.parametrize(
    ("drift", "warm", "expected"),
    [
        (3.0, True, Headline("warm after 40 min")),
        (30.0, False, Headline("not warm after 40 min", holds=False)),
        (None, False, Headline("not warm", holds=False)),
    ],
)
async def test_a_warm_up_holds_once_the_arm_is_warm(
    tmp_path: Path, drift: float | None, warm: bool, expected: Headline
) -> None:
    assert headline_of_run(await stored_warm_up(tmp_path, TickingClock(), drift, warm=warm)) == expected


async def test_a_run_to_be_identified_has_no_headline(tmp_path: Path) -> None:
    store = await RunStore.create(tmp_path, "open-loop", {}, TickingClock(), reserve_bytes=0)
    await store.finish("complete", 0)
    assert headline_of_run(store.path) is None
    assert headline_of_run(tmp_path / "none") is None


def test_maps_are_worth_their_largest_uncertainty(tmp_path: Path) -> None:
    path = tmp_path / "map.json"
    write_result(sample.hand_made(), path)
    data = json.loads(path.read_text(encoding="utf-8"))
    tables = (data["theta1_map"], data["theta2_map"])
    largest = max(u for t in tables for u in (*t["u_positive_mdeg"], *t["u_negative_mdeg"]))
    assert headline_of_result(path) == Headline(f"maps U ≤ {2.0 * largest:.1f} mdeg (k = 2)")
    assert headline_of_result(tmp_path / "none.json") is None


def test_a_resolution_is_worth_its_least_steps(tmp_path: Path) -> None:
    path = tmp_path / "resolution.json"
    write_resolution(sample_result(), path)
    assert headline_of_result(path) == Headline("steps 0.00015° … 0.050°")


async def test_a_record_that_cannot_be_evaluated_has_no_headline(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = await stored_warm_up(tmp_path, TickingClock(), 3.0, warm=True)

    def refused(reader: object) -> None:
        raise UsageError(f"{reader}: its cell cannot be read")

    monkeypatch.setattr("catseye.app.results.headlines.found_sections", refused)
    assert headline_of_run(path) is None


@pytest.mark.parametrize(("wrong_mm", "holds"), [(0.0, True), (0.1, False)])
async def test_a_validation_holds_only_if_its_test_passed(
    tmp_path: Path, wrong_mm: float, *, holds: bool
) -> None:
    _, result = await identified(tmp_path)
    # What no model explains: every other distance of the true arm is wrong, by far more than its uncertainty.
    rows: list[tuple[str, Row]] = [
        (kind, {**row, "displacement_mm": float(str(row["displacement_mm"])) + wrong_mm * (-1) ** number})
        for number, (kind, row) in enumerate(distances())
    ]
    driven = await stored(tmp_path / "runs", "validation-path", rows)
    page = tmp_path / "validation.html"
    found = headline_of_written(Written("validate", page, (result,), (driven.path,)))
    assert found is not None
    assert found.holds is holds
    assert found.text.startswith("conventional")
    assert ("p <" in found.text) is not holds


@pytest.mark.parametrize(("wrong_mm", "holds"), [(0.0, True), (0.1, False)])
async def test_a_validation_without_a_second_model_can_hold(
    tmp_path: Path, wrong_mm: float, *, holds: bool
) -> None:
    """Only its uncertainties judge a model beside which no conventional one lies: 0.01 mm a coordinate."""
    _, result = await identified(tmp_path)
    rows: list[tuple[str, Row]] = [
        (kind, {**row, "x_meas_mm": float(str(row["x_meas_mm"])) + wrong_mm * (-1) ** number})
        for number, (kind, row) in enumerate(positions())
    ]
    driven = await stored(tmp_path / "runs", "validation-path", rows)
    found = headline_of_written(Written("validate", tmp_path / "page.html", (result,), (driven.path,)))
    assert found is not None
    assert "ratio" not in found.text
    assert found.holds is holds


def test_a_validation_that_cannot_be_judged_does_not_hold(tmp_path: Path) -> None:
    gone = Written("validate", tmp_path / "page.html", (tmp_path / "none.json",), (tmp_path / "run",))
    found = headline_of_written(gone)
    assert found is not None
    assert not found.holds


def test_compensated_commands_are_counted(tmp_path: Path) -> None:
    file = tmp_path / "compensated.csv"
    file.write_text("# made of a path\nj1_deg,j2_deg\n1,2\n3,4\n", encoding="utf-8")
    assert headline_of_written(Written("compensate", file, (), ())) == Headline("2 commands")
