"""Two calibrations of one arm, and of an arm that has changed, against one another."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from catseye.app.cli import cli
from catseye.app.errors import MeasurementRejectedError
from catseye.app.results.provenance import Provenance
from catseye.app.results.serial_arm.comparison import compare_arms, comparison_report
from catseye.app.results.serial_arm.result import SerialArmResult
from tests.unit.app.results.serial_arm.tables import arm_file, poses_file, some_poses, tool_file
from tests.unit.app.results.serial_arm.test_prediction import result_with
from tests.unit.calibration.serial_arm.true_arm import FOUND, TrueArm


def calibrated(folder: Path, name: str, seed: int, true: TrueArm | None = None) -> Path:
    poses = poses_file(folder, some_poses(60, seed), seed=seed, true=true)
    words = ["--poses", str(poses), "--arm", str(arm_file(folder)), "--tool", str(tool_file(folder))]
    words += ["--model", "geometric+compliance", "-o", str(folder / name)]
    done = CliRunner().invoke(cli, ["calibrate", *words])
    assert done.exit_code == 0, done.output
    return folder / name


def compared(first: Path, second: Path, *words: str) -> Result:
    return CliRunner().invoke(cli, ["compare", str(first), str(second), "--json", *words])


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("compared")
    longer = FOUND.copy()
    longer[2, 1] += 0.5
    elsewhere = TrueArm(base=np.array([400.0, -300.0, 50.0, 1.0, -2.0, 60.0]))
    return {
        "january": calibrated(folder, "january.json", 1),
        "other tracker": calibrated(folder, "tracker.json", 2, elsewhere),
        "struck": calibrated(folder, "struck.json", 3, TrueArm(longer)),
    }


def test_same_arm_by_another_instrument_agrees(results: dict[str, Path]) -> None:
    done = compared(results["january"], results["other tracker"], "--limit-u", "4.5")
    said = json.loads(done.stdout)
    assert done.exit_code == 0, done.output
    assert said["within"] >= 0.8 * said["judged"]
    assert said["judged"] == 25
    assert said["places_apart"]["mean_mm"] < 0.15


def test_link_that_has_changed_is_named(results: dict[str, Path]) -> None:
    done = compared(results["january"], results["struck"], "--limit-u", "4.5")
    said = json.loads(done.stdout)
    sizes = {one["name"]: one for one in said["parameters"]}
    assert isinstance(done.exception, MeasurementRejectedError)
    assert sizes["J3.a_mm"]["difference"] == pytest.approx(0.5, abs=4.0 * sizes["J3.a_mm"]["u"])
    assert abs(sizes["J3.a_mm"]["normalised"]) > 4.5


def of_run(*, simulated: bool, unverified: list[str] | None) -> SerialArmResult:
    origin = Provenance(
        runs=[], software="catseye", created="2026-11-25", simulated=simulated, unverified=unverified
    )
    return result_with().model_copy(update={"provenance": origin})


def test_what_marks_a_result_marks_the_comparison() -> None:
    emulated, changed = of_run(simulated=True, unverified=None), of_run(simulated=False, unverified=["run R"])
    origin = comparison_report(compare_arms(emulated, changed), ("one", "other")).origin
    assert (origin.simulated, origin.unverified) == (True, ("run R",))
    plain = of_run(simulated=False, unverified=None)
    assert not comparison_report(compare_arms(plain, plain), ("one", "other")).origin.banners
