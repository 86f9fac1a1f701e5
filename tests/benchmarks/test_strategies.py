"""Three ways of following a reflector, at real speed on a bench without errors: time per point, largest beam miss."""

import json
import re
import socket
import statistics
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.protocol.procedures import load_procedure, parse_params
from catseye.app.service.emulation import emulated_devices
from catseye.app.service.running import carry_out, plan_run
from catseye.app.store.reader import RunReader
from tests.benchmarks.test_time_per_point import FEW_NODES
from tests.system.command import environment

ENDPOINTS = {
    "melfa-r3": "",
    "melfa-datalink": 'datalink_endpoint = "tcp://127.0.0.1:10003"\n',
    "melfa-mxt": 'mxt_endpoint = "udp://127.0.0.1:10000"\n',
}
TRUTH = {
    "format": "catseye-result/1",
    "link1_mm": {"value": 325.0},
    "link2_mm": {"value": 225.0},
    "theta20_mdeg": {"value": 0.0},
    "theta40_deg": 0.0,
    "reflectors": [{"name": "P2", "x_mm": {"value": 680.0}, "y_mm": {"value": 0.0}}],
}


@dataclass(frozen=True)
class Quiet:
    """A bench without errors: its cell file and its control port."""

    cell: Path
    control: tuple[str, int]

    def ask(self, **request: object) -> dict[str, Any]:
        """Put a request to the control port."""
        with socket.create_connection(self.control, timeout=10) as connection:
            connection.sendall(json.dumps(request).encode() + b"\n")
            answer: dict[str, Any] = json.loads(connection.makefile("rb").readline())
        return answer


@contextmanager
def quiet(folder: Path, driver: str) -> Iterator[Quiet]:
    """Serve a bench whose robot is driven in one of the ways."""
    text = TEMPLATE.replace('driver = "melfa-r3"\n', f'driver = "{driver}"\n{ENDPOINTS[driver]}')
    for old, new in FEW_NODES.items():
        text = text.replace(old, new)
    cell = folder / "cell.toml"
    cell.write_text(re.sub(r"(://127\.0\.0\.1):\d+", r"\1:0", text), encoding="utf-8")
    (folder / "truth.json").write_text(json.dumps(TRUTH), encoding="utf-8")
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.benchmarks.quiet_bench", str(cell)],
        env=environment(),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        original = cell.with_name("asked.toml")
        original.write_text(text, encoding="utf-8")
        loaded = load_cell(original).cell
        assert loaded.tracker is not None
        asked = [*(device.endpoint for device in emulated_devices(loaded)), loaded.tracker.endpoint]
        served = [json.loads(process.stdout.readline())["endpoint"] for _ in asked]
        for old, new in zip(asked, served, strict=True):
            text = text.replace(f'"{old}"', f'"{new}"')
        cell.write_text(text, encoding="utf-8")
        yield Quiet(cell, ("127.0.0.1", int(served[-1].rpartition(":")[2])))
    finally:
        process.communicate(timeout=10)


@pytest.mark.timeout(400)
@pytest.mark.parametrize(
    ("driver", "limit_mm"), [("melfa-r3", 0.25), ("melfa-datalink", 0.25), ("melfa-mxt", 0.1)]
)
async def test_time_per_point_and_largest_miss(driver: str, limit_mm: float, tmp_path: Path) -> None:
    measure = load_procedure("open-loop")
    params = parse_params(measure.params_type, ['reflectors=["P2"]'])
    with quiet(tmp_path, driver) as bench:
        root = tmp_path / "runs"
        planned = plan_run(load_cell(bench.cell), measure, params, root, "none")
        outcome = await carry_out(planned, root, lambda _event: None)
        assert outcome.exit_code == 0, outcome.text
        state = bench.ask(op="state")
    points = RunReader(outcome.path).rows("points")
    assert len(points) == 24
    assert {point["segment"] for point in points} == {0}
    assert not state["beam"]["lost"]
    miss_mm = state["beam"]["largest_miss_mm"]
    per_point_s = statistics.fmean(time.total_s for time in outcome.step_times[1:])
    motion_s = statistics.fmean(time.motion_s for time in outcome.step_times[1:])
    print(  # noqa: T201  # the figure
        f"\n{driver}: {per_point_s:.2f} s per point, of it motion {motion_s:.2f} s; "
        f"largest beam miss {miss_mm:.3f} mm (limit {limit_mm:g} mm)"
    )
    assert miss_mm <= limit_mm
