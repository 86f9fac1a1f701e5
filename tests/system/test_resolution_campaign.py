"""The resolution paper's campaign over real sockets: what it consists of; measured, it takes an hour."""

from pathlib import Path

from catseye.app.cell.load import load_cell
from catseye.app.cli.resolution.demo_cell import CELL
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
