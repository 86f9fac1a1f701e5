"""The cell file that a calibration of a serial arm begins with: valid, and good enough to plan on."""

from pathlib import Path

import pytest
from pydantic import ValidationError

from catseye.app.cell.bench import bench_of
from catseye.app.cell.load import load_cell
from catseye.app.cell.model import Cell
from catseye.app.cell.templates import SIX_AXIS, TEMPLATES
from catseye.procedures.serial_arm.bench import SerialBench
from catseye.procedures.serial_arm.tracker_validation import TrackerValidation, ValidationParams


def template_bench(folder: Path) -> SerialBench:
    path = folder / "cell.toml"
    path.write_text(TEMPLATES[SIX_AXIS].text, encoding="utf-8")
    bench = bench_of(load_cell(path).cell)
    assert isinstance(bench, SerialBench)
    return bench


def test_the_template_has_nests_and_the_papers_plate(tmp_path: Path) -> None:
    bench = template_bench(tmp_path)
    assert [one.name for one in bench.targets] == ["nest1", "nest2", "nest3"]
    assert [one.name for one in bench.instrument.nests] == ["W1", "W2", "W3"]
    # The paper: nest 1 on axis 6, 125 mm out; nest 3 150 mm from the axis; nest 2 115 mm from it, 215 mm out.
    one, two, three = (target.place_mm for target in bench.targets)
    assert one == (0.0, 0.0, 125.0)
    assert three[0] ** 2 + three[1] ** 2 == pytest.approx(150.0**2)
    assert (two[0] ** 2 + two[1] ** 2) ** 0.5 == pytest.approx(115.0, abs=0.1)
    assert two[2] == 215.0


def test_poses_can_be_planned_on_the_template(tmp_path: Path) -> None:
    plan = TrackerValidation().plan(template_bench(tmp_path), ValidationParams(count=3))
    assert len(plan.poses) == 3


def test_a_tool_that_is_not_shipped_is_refused() -> None:
    robot = {"driver": "abb-rws", "endpoint": "tcp://127.0.0.1:80", "arm": "irb120", "tool": "square-plate"}
    with pytest.raises(ValidationError, match="there are triangular-plate"):
        Cell.model_validate({"format": "catseye-cell/1", "name": "lab", "robot": robot})
