"""A designed layout goes from the command into a cell file that the rest of the program accepts."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from tests.patience import HANG_S
from tests.system.command import catseye, environment


@pytest.mark.slow
def test_the_designed_cell_is_valid_and_planned_as_designed(tmp_path: Path) -> None:
    (tmp_path / "cell.toml").write_text(TEMPLATE)
    design = catseye(
        "design", "--cell", "cell.toml", "--write-cell", "new.toml", "-o", "page.html", "--json", cwd=tmp_path
    )
    assert design.returncode == 0, design.stderr
    found = json.loads(design.stdout)
    checked = catseye("config", "validate", "new.toml", cwd=tmp_path)
    assert checked.returncode == 0, checked.stderr
    plan = catseye(
        *("run", "open-loop", "--cell", "new.toml", "--dry-run", "--json"),
        # A design counts neither closures nor commands between the nodes.
        *("--param", "closures=0", "--param", "off_node=0"),
        cwd=tmp_path,
    )
    assert plan.returncode == 0, plan.stderr
    rehearsed, layout = json.loads(plan.stdout), found["layouts"][0]
    assert sum(step["measurements"] for step in rehearsed["steps"]) == layout["points"]
    # The rehearsal also includes the way to the first point and set-up.
    assert rehearsed["total_s"] == pytest.approx(layout["bench_s"], rel=0.05)
    broken = [text for text in rehearsed["warnings"] if "cannot be kept" in text]
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
    floor = ("--floor", "0,100,0,100", "--places", "40")
    refused = catseye("design", "--cell", "cell.toml", *floor, cwd=tmp_path)
    assert refused.returncode == 2
    assert "larger --floor" in refused.stderr
    assert not refused.stdout


def alive_in_group(group: int) -> list[str]:
    """Return the command lines of processes of a group, those that only wait to be reaped left out."""
    listed = subprocess.run(["ps", "-eo", "pgid=,stat=,args="], capture_output=True, text=True, check=True)
    rows = [line.split(maxsplit=2) for line in listed.stdout.splitlines()]
    return [row[2] for row in rows if int(row[0]) == group and not row[1].startswith("Z")]


def test_ctrl_c_during_a_sweep_leaves_no_process_or_traceback(tmp_path: Path) -> None:
    (tmp_path / "cell.toml").write_text(TEMPLATE)
    words = ["design", "--cell", "cell.toml", "--criterion", "D", "--places", "2000", "--workers", "2"]
    with subprocess.Popen(
        [sys.executable, "-m", "catseye", *words],
        cwd=tmp_path,
        env=environment(),
        stderr=subprocess.PIPE,
        start_new_session=True,
    ) as process:
        assert process.stderr is not None
        said = b""
        while b"exchanges" not in said:
            part = os.read(process.stderr.fileno(), 4096)
            assert part, said
            said += part
        # A terminal sends Ctrl-C to the whole group, the workers included.
        os.killpg(process.pid, signal.SIGINT)
        said += process.stderr.read()
        assert process.wait(timeout=HANG_S) == 130
    assert b"Traceback" not in said
    assert not alive_in_group(process.pid)
