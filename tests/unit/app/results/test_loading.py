"""`catseye.load`: what each kind of path gives."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import catseye
from catseye.app.cell.model import Cell
from catseye.app.cli import cli
from catseye.app.errors import UsageError
from catseye.app.results.loading import CalibratedArm
from catseye.app.store.reader import RunReader
from tests.unit.app.results.serial_arm.sample import sample_calibration
from tests.unit.app.results.serial_arm.test_run_poses import validated


@pytest.fixture
def arm(tmp_path: Path) -> CalibratedArm:
    path = tmp_path / "arm.json"
    path.write_text(sample_calibration().model_dump_json(), encoding="utf-8")
    found = catseye.load(path)
    assert isinstance(found, CalibratedArm)
    return found


async def test_a_folder_gives_its_run(tmp_path: Path) -> None:
    path = await validated(tmp_path)
    found = catseye.load(str(path))
    assert isinstance(found, RunReader)
    assert found.procedure == "tracker-validation"
    assert len(found.rows("targets")) == 8


def test_a_serial_result_gives_a_calibrated_arm(arm: CalibratedArm) -> None:
    assert arm.value("base.x_mm") == (1500.25, 0.031)
    with pytest.raises(UsageError, match=r"no parameter J9\.a_mm"):
        arm.value("J9.a_mm")


def test_joints_of_another_arm_and_unknown_targets_are_refused(arm: CalibratedArm) -> None:
    # The sample holds J3.d_mm, which an IRB 120 does not have.
    parts = [one for one in arm.result.parameters if one.name != "J3.d_mm"]
    arm = CalibratedArm(arm.result.model_copy(update={"parameters": parts}))
    with pytest.raises(UsageError, match=r"shape \(1, 4\): give \(n, 6\)"):
        arm.places_mm(np.zeros((1, 4)), "flange")
    with pytest.raises(UsageError, match="the calibrated arm has no target 'N1'"):
        arm.places_mm(np.zeros((1, 6)), "N1")


def test_a_cell_file_gives_its_cell(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    done = CliRunner().invoke(cli, ["init", str(path), "--system", "six-axis"])
    assert done.exit_code == 0, done.output
    assert isinstance(catseye.load(path), Cell)


def test_another_file_is_refused_with_what_is_known(tmp_path: Path) -> None:
    path = tmp_path / "other.json"
    path.write_text("{}", encoding="utf-8")
    with pytest.raises(UsageError, match=r"its format is not stated; catseye\.load takes"):
        catseye.load(path)


def test_the_package_starts_without_numerical_libraries() -> None:
    code = "import sys, catseye; assert not {'numpy', 'scipy', 'pydantic'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)
