"""Runs of two arms or tools are not mixed, and a result is not judged by another arm's run."""

import re
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from catseye.app.cell.arm import shipped_arm
from catseye.app.cli import cli
from catseye.app.errors import UsageError
from catseye.procedures.serial_arm.tracker_validation import TrackerValidation, ValidationParams
from tests.unit.app.results.serial_arm.test_run_poses import configuration
from tests.unit.procedures.serial_arm.benches import SIX, Room, carried_out


async def measured(folder: Path, seed: int, **robot: Any) -> Path:
    """Measure 8 poses; the run's record says other things of the robot where these are given."""
    runs = folder / "runs"
    runs.mkdir(exist_ok=True)
    plan = TrackerValidation().plan(SIX, ValidationParams(count=8, settle_s=0.2, seed=seed))
    stated = configuration(folder)
    stated["robot"] |= {key: change(stated["robot"][key]) for key, change in robot.items()}
    meta = {"configuration": stated, "procedure": TrackerValidation.name}
    outcome = await carried_out(Room(runs), TrackerValidation(), plan, meta=meta)
    assert (outcome.status, outcome.text) == ("complete", "")
    return outcome.path


def longer(_: Any) -> Any:
    """Return an IRB 120 whose forearm is 10 mm longer."""
    arm = shipped_arm("irb120").model_dump(mode="json")
    arm["joint"][3]["d_mm"] += 10.0
    return arm | {"name": "long arm"}


def heavier(tool: Any) -> Any:
    return tool | {"mass_kg": 3.5, "name": "heavy plate"}


def with_normals_turned(tool: Any) -> Any:
    return tool | {"target": [one | {"normal": [0.0, 0.0, 1.0]} for one in tool["target"]]}


def ran(folder: Path, *words: object) -> Any:
    return CliRunner().invoke(cli, [*map(str, words), "--runs", str(folder / "runs")])


@pytest.mark.parametrize(
    ("robot", "text", "option"),
    [
        ({"arm": longer}, "another arm than .*: long arm, not .*state --arm", ("--arm", "irb120")),
        ({"tool": heavier}, "another tool than .*: heavy plate, not plate.*state --tool", ("--tool",)),
    ],
)
async def test_runs_that_differ_are_refused(
    tmp_path: Path, robot: dict[str, Any], text: str, option: tuple[str, ...]
) -> None:
    runs = await measured(tmp_path, 0), await measured(tmp_path, 1, **robot)
    output = tmp_path / "arm.json"
    done = ran(tmp_path, "calibrate", *runs, "--model", "frames", "-o", output)
    assert isinstance(done.exception, UsageError)
    assert re.search(text, str(done.exception))
    stated = (*option, tmp_path / "plate.toml") if option == ("--tool",) else option
    done = ran(tmp_path, "calibrate", *runs, "--model", "frames", "-o", output, *stated)
    assert done.exit_code == 0, done.output


async def test_a_validation_of_another_arm_or_tool_is_refused(tmp_path: Path) -> None:
    first, output = await measured(tmp_path, 0), tmp_path / "arm.json"
    done = ran(tmp_path, "calibrate", first, "--model", "frames", "-o", output)
    assert done.exit_code == 0, done.output
    for robot, text in (
        ({"arm": longer}, "another arm than the result"),
        ({"tool": heavier}, "another tool"),
    ):
        done = ran(tmp_path, "validate", output, "--measured", await measured(tmp_path, 1, **robot))
        assert isinstance(done.exception, UsageError)
        assert text in str(done.exception)
    # Where targets look says nothing of the arm.
    other = await measured(tmp_path, 1, tool=with_normals_turned)
    done = ran(tmp_path, "validate", output, "--measured", other)
    assert done.exit_code == 0, done.output
