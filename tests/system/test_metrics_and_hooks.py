"""What a run on the emulated bench tells those who are not at its terminal."""

import json
import time
from pathlib import Path

from tests.patience import HANG_S
from tests.system.command import SPEED, catseye, emulated, own_runtime


def test_a_run_leaves_metrics_and_tells_its_end(tmp_path: Path) -> None:
    command = json.dumps(["/bin/sh", "-c", f"cat >> {tmp_path / 'told.jsonl'}"])
    hooks = f'[hooks]\non = ["run-ended", "prompt", "alarm"]\ncommand = {command}\n\n[engine]'
    with emulated(tmp_path, "--speed", SPEED, edit={"[engine]": hooks}) as bench:
        run = catseye(
            "run",
            "reflector-search",
            "--cell",
            bench.cell,
            "--speed",
            SPEED,
            "--metrics",
            tmp_path / "run.prom",
            "--json",
            cwd=tmp_path,
        )
    assert run.returncode == 0, run.stderr
    events = [json.loads(line) for line in run.stdout.splitlines()]
    told = [json.loads(line) for line in (tmp_path / "told.jsonl").read_text().splitlines()]
    kinds = {"run-ended", "prompt", "error"}
    wanted = [event for event in events if event["event"] in kinds]
    # Commands run side by side, so their order is not that of the events.
    assert sorted(event["t"] for event in told) == sorted(event["t"] for event in wanted)
    [ended] = [event for event in told if event["event"] == "run-ended"]
    assert ended["exit_code"] == 0

    lines = (tmp_path / "run.prom").read_text(encoding="utf-8").splitlines()
    labels = f'cell="lab-1",procedure="reflector-search",run="{ended["run"]}"'
    points = sum(event["event"] == "point" for event in events)
    assert f"catseye_run_points_total{{{labels}}} {float(points)}" in lines
    assert f'catseye_run_state{{{labels},catseye_run_state="COMPLETE"}} 1.0' in lines
    assert f"catseye_run_exit_code{{{labels}}} 0.0" in lines
    assert any(line.startswith("catseye_air_celsius{") for line in lines)
    assert any(line.startswith("catseye_runs_free_bytes{") for line in lines)
    assert lines[-1] == "# EOF"


def test_a_detached_run_leaves_metrics_as_well(tmp_path: Path) -> None:
    cell = ("--cell", "cell.toml", "--speed", SPEED, "--json")
    with own_runtime(), emulated(tmp_path, "--speed", SPEED):
        begun = catseye("run", "reflector-search", *cell, "--detach", "--metrics", "run.prom", cwd=tmp_path)
        assert begun.returncode == 0, begun.stderr
        run = json.loads(begun.stdout)["run"]
        # Ends with the run, or finds that it is over.
        catseye("attach", run, cwd=tmp_path)
        lines = _ended(tmp_path / "run.prom")
    labels = f'cell="lab-1",procedure="reflector-search",run="{run}"'
    assert f'catseye_run_state{{{labels},catseye_run_state="COMPLETE"}} 1.0' in lines
    assert f"catseye_run_exit_code{{{labels}}} 0.0" in lines
    assert any(line.startswith("catseye_run_points_total{") for line in lines)
    assert lines[-1] == "# EOF"


def _ended(file: Path) -> list[str]:
    """Return the lines of a file of metrics once they state how the run ended."""
    end_s = time.monotonic() + HANG_S
    while "catseye_run_exit_code{" not in (text := file.read_text(encoding="utf-8")):
        assert time.monotonic() < end_s, text
        time.sleep(0.05)
    return text.splitlines()
