"""The list of the day is led by a campaign: its stages, parameters and limits."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from catseye.app.campaign.day import day_of_campaign
from catseye.app.results.readiness.stages import CellStage
from catseye.procedures.kit.procedure import Asked
from tests.unit.app.campaign.night import Night


@pytest.fixture
def night(tmp_path: Path) -> Night:
    return Night(tmp_path)


def day(night: Night, *stages: Mapping[str, Any], document: object = None) -> list[CellStage]:
    return day_of_campaign(night.campaign(*stages), night.stages.values(), lambda _entry, _stage: document)


def test_only_its_stages_in_its_order(night: Night) -> None:
    found = day(night, {"name": "identify"}, {"name": "search"})
    assert [(stage.name, stage.state) for stage in found] == [("identify", "next"), ("search", "later")]


def test_params_and_limits_stand_at_the_stage(night: Night) -> None:
    limit = {"value": "fit.rms_um", "max": 20.0}
    (found,) = day(night, {"name": "search", "params": {"poses": 7}, "limit": [limit]})
    assert found.params == ("poses=7",)
    assert found.limits == ("fit.rms_um ≤ 20",)
    assert found.command == "catseye run search --cell cell.toml --param poses=7"


def test_given_files_are_not_asked_for(night: Night) -> None:
    (night.folder / "wish.csv").write_text("x_mm,y_mm\n")
    asked = Asked("path", "path", "a CSV")
    night.stages["report"] = replace(
        night.stages["report"], words=("compensate", "r.json", "--path", "{path}"), asks=(asked,)
    )
    entry = {"name": "report", "files": {"path": "wish.csv"}, "options": {"limit_um": 40, "fast": True}}
    (found,) = day(night, entry)
    assert found.asks == ()
    path = str(night.folder / "wish.csv")
    assert found.words == ("compensate", "r.json", "--path", path, "--limit-um", "40", "--fast")


def test_a_missed_limit_is_a_failed_stage(night: Night) -> None:
    night.stages["search"] = replace(night.stages["search"], state="done", found="U ≤ 0.2 mm")
    entry = {"name": "search", "limit": [{"value": "u_mm", "max": 0.05}]}
    failed, following = day(night, entry, {"name": "identify"}, document={"u_mm": 0.1})
    assert (failed.state, failed.found) == ("failed", "u_mm = 0.1, limit ≤ 0.05")
    assert following.state == "next"
    passed, _ = day(night, entry, {"name": "identify"}, document={"u_mm": 0.01})
    assert (passed.state, passed.found) == ("done", "U ≤ 0.2 mm")
