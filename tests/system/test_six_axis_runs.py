"""Targets of an emulated IRB 120, measured by an emulated Leica over real sockets."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from catseye.app.cell.arm import arm_description
from catseye.app.cell.serial_arm import chain_of
from catseye.app.cell.templates import SIX_AXIS, TEMPLATES
from catseye.app.cell.tool import tool_description
from tests.system.command import catseye, emulated, last_run

PARAMS = ("--param", "count=4", "--param", "nests_every=2", "--param", "dwell_s=2")
NOMINAL_MM = 12.0
"""Between two targets of the nominal arm: each is off by 5.5 mm at most (six-axis paper, section 6.2)."""


def test_a_validation_is_measured_and_exported(tmp_path: Path) -> None:
    with emulated(tmp_path, "--seed", "3", "--speed", "40", text=TEMPLATES[SIX_AXIS].text) as bench:
        done = catseye(
            "run", "tracker-validation", "--cell", bench.cell, "--speed", "40", *PARAMS, cwd=tmp_path
        )
        assert done.returncode == 0, done.stderr
    run = last_run(tmp_path, "tracker-validation")
    done = catseye("export", run, "-o", "poses.csv", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    lines = (tmp_path / "poses.csv").read_text(encoding="utf-8").splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    assert len(rows) == 4
    # Distances do not depend on frames: those of the nominal arm are right to its errors.
    chain, tool = chain_of(arm_description("irb120")), tool_description("triangular-plate")
    q = np.array([[float(row[f"q{k}_deg"]) for k in range(1, 7)] for row in rows])
    nominal = [
        (flange @ [*tool.place_mm(row["target"]), 1.0])[:3]
        for flange, row in zip(chain.flange(q), rows, strict=True)
    ]
    seen = [[float(row[name]) for name in ("x_mm", "y_mm", "z_mm")] for row in rows]
    for k in range(1, 4):
        expected = math.dist(nominal[k], nominal[0])
        assert abs(math.dist(seen[k], seen[0]) - expected) < NOMINAL_MM
    assert all(0.0 < float(row["u_x_mm"]) < 0.1 for row in rows)


@pytest.mark.parametrize("readback_deg", [0.05, 0.08])
def test_a_read_back_beside_the_command_needs_one_setting(tmp_path: Path, readback_deg: float) -> None:
    text = TEMPLATES[SIX_AXIS].text + "\n[robot.settings]\ntolerance_deg = 0.01\n"
    with emulated(tmp_path, "--seed", "3", "--speed", "40", text=text) as bench:
        bench.ask(op="fault", name="readback", deg=readback_deg)
        run = ("run", "tracker-validation", "--cell", bench.cell, "--speed", "40", *PARAMS)
        refused = catseye(*run, cwd=tmp_path)
        assert "tolerance_deg = 0.01" in refused.stderr
        assert "[robot.settings]" in refused.stderr
        cell = bench.cell.read_text(encoding="utf-8")
        bench.cell.write_text(cell.replace("tolerance_deg = 0.01", "tolerance_deg = 0.4"), encoding="utf-8")
        done = catseye(*run, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    done = catseye("export", last_run(tmp_path, "tracker-validation"), "-o", "poses.csv", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    lines = (tmp_path / "poses.csv").read_text(encoding="utf-8").splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    off = [abs(float(row[f"q{k}_deg"]) - float(row[f"q{k}_read_deg"])) for row in rows for k in range(1, 7)]
    assert len(rows) == 4
    assert 0.03 < max(off) < 0.4
