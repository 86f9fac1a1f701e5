"""A designed layout goes from the command into a cell file that the rest of the program accepts."""

import json
from pathlib import Path

import pytest

from app.cell.template import TEMPLATE
from tests.system.command import catseye


@pytest.mark.slow
def test_the_designed_cell_is_valid_and_its_plan_is_what_the_design_said(tmp_path: Path) -> None:
    (tmp_path / "cell.toml").write_text(TEMPLATE)
    design = catseye(
        "design", "--cell", "cell.toml", "--write-cell", "new.toml", "-o", "page.html", "--json", cwd=tmp_path
    )
    assert design.returncode == 0, design.stderr
    found = json.loads(design.stdout)
    checked = catseye("config", "validate", "new.toml", cwd=tmp_path)
    assert checked.returncode == 0, checked.stderr
    plan = catseye(
        "run", "open-loop", "--cell", "new.toml", "--param", "closures=0", "--dry-run", "--json", cwd=tmp_path
    )
    assert plan.returncode == 0, plan.stderr
    told, layout = json.loads(plan.stdout), found["layouts"][0]
    assert sum(step["measurements"] for step in told["steps"]) == layout["points"]
    # The rehearsal also tells of the way to the first point and of set-up.
    assert told["total_s"] == pytest.approx(layout["bench_s"], rel=0.05)
    broken = [text for text in told["warnings"] if "cannot be kept" in text]
    assert len(broken) == sum(one["breaks"] > 0 for one in found["reflectors"])
    assert layout["planned_breaks"] == sum(one["breaks"] for one in found["reflectors"])
    assert "<svg" in (tmp_path / "page.html").read_text()


@pytest.mark.slow
def test_processes_find_the_same_design(tmp_path: Path) -> None:
    (tmp_path / "cell.toml").write_text(TEMPLATE)
    options = ["design", "--cell", "cell.toml", "--places", "150", "--random-only", "--json", "--workers"]
    alone, two = (catseye(*options, workers, cwd=tmp_path) for workers in ("1", "2"))
    assert alone.returncode == 0, alone.stderr
    assert json.loads(two.stdout) == json.loads(alone.stdout)


def test_bad_floor_is_exit_code_2(tmp_path: Path) -> None:
    (tmp_path / "cell.toml").write_text(TEMPLATE)
    refused = catseye("design", "--cell", "cell.toml", "--floor", "0,100,0,100", cwd=tmp_path)
    assert refused.returncode == 2
    assert "larger --floor" in refused.stderr
    assert not refused.stdout
