"""The measurement with each way of following the reflector, on emulated hardware with all its errors."""

import json
from pathlib import Path

import pytest

from catseye.app.store.catalog import resolve_run
from catseye.app.store.reader import RunReader
from tests.system.command import catseye, emulated, last_run

FEW_NODES = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-60.0, -40.0]"
    ),
}
ALL_THETA2 = "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]"
TRUTH = {
    "format": "catseye-result/1",
    "link1_mm": {"value": 325.01},
    "link2_mm": {"value": 224.98},
    "theta20_mdeg": {"value": 20.0},
    "theta40_deg": 0.0,
    "reflectors": [{"name": "P2", "x_mm": {"value": 680.0}, "y_mm": {"value": 0.0}}],
}
"""An arm whose reflector stands where the cell file has it, so that no search is needed."""

DOORS = {
    "melfa-datalink": 'datalink_endpoint = "tcp://127.0.0.1:10003"\n',
    "melfa-mxt": 'mxt_endpoint = "udp://127.0.0.1:10000"\n',
}


# Real-time control is given up when nothing is heard for a time: a busy machine may take longer than the default.
@pytest.mark.parametrize(
    ("driver", "speed", "theta2_deg"),
    [("melfa-datalink", "40", "20.0, 40.0, 60.0"), ("melfa-mxt", "3", "20.0, 30.0")],
)
def test_a_measurement_keeps_the_beam_between_the_points(
    driver: str, speed: str, theta2_deg: str, tmp_path: Path
) -> None:
    chosen = {'driver = "melfa-r3"\n': f'driver = "{driver}"\n{DOORS[driver]}'}
    if driver == "melfa-mxt":
        chosen["[robot.limits_deg]"] = "[robot.settings]\nmxt_timeout_s = 20.0\n\n[robot.limits_deg]"
    nodes = {**FEW_NODES, ALL_THETA2: f"theta2_deg = [{theta2_deg}]"}
    truth = tmp_path / "truth.json"
    truth.write_text(json.dumps(TRUTH), encoding="utf-8")
    with emulated(tmp_path, "--speed", speed, "--truth", str(truth), edit={**nodes, **chosen}) as bench:
        options = ["--speed", speed, "--search", "none", "--param", 'reflectors=["P2"]']
        run = catseye("run", "open-loop", "--cell", bench.cell, *options, cwd=tmp_path)
        assert run.returncode == 0, run.stderr
        stopped = bench.ask(op="state")
    points = RunReader(resolve_run(tmp_path / "catseye-runs", last_run(tmp_path, "open-loop"))).rows("points")
    # Two commands more lie between the nodes.
    assert len(points) == 2 * 2 * 2 * len(theta2_deg.split(",")) + 2
    assert {point["segment"] for point in points} == {0}
    assert not stopped["moving"]
    # The driver's joints are encoder feedback: finer than the R-protocol's hundredths.
    reported = [float(str(point["reported4_deg"])) for point in points]
    assert any(abs(angle - round(angle, 2)) > 1e-4 for angle in reported)
