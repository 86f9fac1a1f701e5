"""One path file for compensate and for the arm: lines and a circle with a turned tool, on an arm that is known."""

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from catseye.app.store.reader import RunReader
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.comparison import rigid_fit
from tests.system.command import SPEED, Emulated, catseye, emulated
from tests.system.test_compensation_round_trip import result_of_the_truth
from tests.system.test_validation_path import truth

PATH = """
[[segment]]
kind = "line"
from = [250.0, -300.0]
to = [250.0, 100.0]
points = 9
z_mm = 45.0
c_deg = 20.0
[[segment]]
kind = "line"
from = [250.0, 100.0]
to = [250.0, -300.0]
points = 9
z_mm = 45.0
c_deg = 20.0
[[segment]]
kind = "circle"
centre = [300.0, -80.0]
radius_mm = 90.0
points = 25
z_mm = 55.0
c_deg = [20.0, 110.0]
"""

LINE = [1] * 18 + [2] * 25


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    folder = tmp_path_factory.mktemp("path-file")
    (folder / "truth.json").write_text(json.dumps(truth()), encoding="utf-8")
    (folder / "result.json").write_text(json.dumps(result_of_the_truth()), encoding="utf-8")
    (folder / "path.toml").write_text(PATH, encoding="utf-8")
    with emulated(folder, "--seed", "3", "--truth", "truth.json") as running:
        yield running


def driven(bench: Emulated, param: str) -> RunReader:
    arguments = ("--cell", bench.cell, "--speed", SPEED, "--search", "none", "--param", param)
    done = catseye("run", "validation-path", *arguments, cwd=bench.cell.parent)
    assert done.returncode == 0, done.stderr
    return RunReader(bench.cell.parent / done.stdout.strip())


def column(reader: RunReader, name: str) -> Floats:
    return np.array([float(str(row[name])) for row in reader.rows("path")])


def deviation_deg(reader: RunReader, joint: str) -> Floats:
    """Return how far a joint of the true arm stands from its commands."""
    table: Any = truth()[f"theta{joint}_map"]
    up, down = (
        np.interp(column(reader, f"theta{joint}_deg"), table["node_deg"], table[f"{side}_mdeg"])
        for side in ("positive", "negative")
    )
    return np.asarray(1e-3 * np.where(column(reader, f"direction{joint}") > 0.0, up, down))


def off_um(reader: RunReader) -> float:
    """Return the rms distance from the wished places, frames aligned, µm."""
    wished, seen = (
        np.column_stack([column(reader, one) for one in names])
        for names in (("x_mm", "y_mm"), ("x_meas_mm", "y_meas_mm"))
    )
    off = rigid_fit(seen, wished).apply(seen) - wished
    return 1e3 * float(np.sqrt(np.mean(np.sum(off**2, axis=1))))


def test_a_path_file_is_driven_with_and_without_correction(bench: Emulated) -> None:
    folder = bench.cell.parent
    options = ("--path", "path.toml", "--cell", bench.cell, "--start-direction", "along", "-o", "joints.csv")
    done = catseye("compensate", "result.json", *options, cwd=folder)
    assert done.returncode == 0, done.stderr
    plain, corrected = driven(bench, "path=path.toml"), driven(bench, "joints=joints.csv")
    angle = np.arange(25) * 2.0 * np.pi / 24.0
    for reader in (plain, corrected):
        assert [row["line"] for row in reader.rows("path")] == LINE
        assert column(reader, "x_mm")[18:] == pytest.approx(300.0 + 90.0 * np.cos(angle), abs=1e-5)
        assert column(reader, "j3_mm") == pytest.approx([45.0] * 18 + [55.0] * 25)
        turned = column(reader, "theta1_deg") + column(reader, "theta2_deg") + column(reader, "j4_deg")
        if reader is corrected:
            turned += sum(deviation_deg(reader, joint) for joint in ("1", "2"))
        assert turned == pytest.approx([20.0] * 18 + np.linspace(20.0, 110.0, 25).tolist(), abs=1e-5)
    # The tracker scatters by 7.5 µm in x and y, the arm by 10 µm at each arrival and by its radial error motions.
    assert off_um(corrected) < 45.0
    assert off_um(plain) > 2.0 * off_um(corrected)
