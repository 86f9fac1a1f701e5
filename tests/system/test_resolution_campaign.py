"""The campaigns of motion resolution in short: what the paper's consists of, and one joint of each of the others."""

from pathlib import Path

from catseye.app.cell.load import load_cell
from catseye.app.cli.resolution.demo_cell import CELL
from tests import masking
from tests.recorded_least_steps import found_at, plan_of
from tests.resolution_campaign import arguments, planned_run, wide


def test_the_campaign_is_sixty_series_of_thirty_places(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    path.write_text(wide(CELL), encoding="utf-8")
    loaded, asked = load_cell(path), arguments([])
    plans = []
    for joint in asked.joints:
        planned = planned_run(loaded, tmp_path, joint, asked.positions)
        assert planned is not None
        plans.append(planned.plan)
    places = [place for plan in plans for place in plan.places]
    assert len({(place.joint, place.name) for place in places}) == 30
    assert sorted(series.direction for place in places for series in place.series) == [-1] * 30 + [1] * 30
    # A5 stands at 90° while A4 is tested (resolution paper, section 3.2).
    assert {place.pose[4] for place in places if place.joint == "A4"} == {90.0}


def test_a_recorded_least_step_lies_in_its_interval() -> None:
    plan = plan_of("A6", "K3", directions=[1], first_deg=0.02, steps=40, standstill_s=30.0)
    (found,) = found_at("A6", plan, 100)
    assert found.held
    # A4 to A6 of the paper: 0.002 to 0.006 deg.
    assert 0.002 < found.true_deg < 0.006


def test_play_hides_what_a1_makes_in_one_direction() -> None:
    found = masking.compared(0, masking.NAMES.index("A1"))
    assert found.hidden
    assert found.iso_deg > 2.0 * found.one_way_high_deg
