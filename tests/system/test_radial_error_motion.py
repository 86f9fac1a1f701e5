"""Radial error motions by the command and its emulated operator: against the truth, and into the budget."""

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from catseye.app.exitcode import ExitCode
from catseye.simulators.world.scara.axis_errors import RadialError
from tests.system.command import SPEED, Emulated, catseye, emulated, last_run

SEED = 5
CERTIFICATES = ("--param", "u_indicator_um=0.1", "--param", "form_um=0.4")
QUICK = ("--param", "cycles=2", "--param", "indicators=2", *CERTIFICATES)
NODES = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-60.0, -30.0, 0.0, 30.0, 60.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [40.0, 70.0, 100.0, 130.0]",
}


def true_rms_um(joint: int, from_deg: float, to_deg: float) -> float:
    """Return the rms of a joint's motion about its circle over the places of an arc, 20° apart, as it was drawn."""
    rng = np.random.default_rng([SEED, 3])
    motions = [RadialError(rng, rms_um) for rms_um in (5.0, 5.0, 10.0)]
    angles_deg = np.arange(from_deg, to_deg + 1.0, 20.0)
    motion_um = 1e3 * motions[joint].shift_mm(angles_deg)
    design = np.stack([np.ones(angles_deg.size), np.exp(1j * np.deg2rad(angles_deg))], axis=1)
    left = motion_um - design @ np.linalg.lstsq(design, motion_um, rcond=None)[0]
    return math.sqrt(float(np.mean(np.abs(left) ** 2)) / 2.0)


def measured(bench: Emulated, *words: str, crash: str = "") -> list[dict[str, Any]]:
    command: tuple[str | Path, ...] = (
        "run",
        "radial-error-motion",
        "--cell",
        bench.cell,
        "--speed",
        SPEED,
        "--json",
        "--telemetry",
        *words,
    )
    return events(catseye(*command, *words, cwd=bench.cell.parent, crash=crash).stdout)


def events(stdout: str) -> list[dict[str, Any]]:
    return [json.loads(line) for line in stdout.splitlines()]


def found(events_seen: list[dict[str, Any]]) -> dict[str, dict[str, Any]]:
    motions = (event["data"] for event in events_seen if event.get("kind") == "radial-error-motion")
    return {motion["joint"]: motion for motion in motions}


def asked(events_seen: list[dict[str, Any]]) -> list[str]:
    return [event["id"] for event in events_seen if event["event"] == "prompt"]


def identified(bench: Emulated, name: str) -> dict[str, Any]:
    """Return the result of the open-loop run."""
    folder = bench.cell.parent
    done = catseye("identify", last_run(folder, "open-loop"), "-o", name, cwd=folder)
    assert done.returncode == ExitCode.DONE, done.stderr
    result: dict[str, Any] = json.loads((folder / name).read_text(encoding="utf-8"))
    return result


def test_what_is_measured_is_true_and_reaches_the_result(tmp_path: Path) -> None:
    with emulated(tmp_path, "--seed", str(SEED), edit=NODES) as bench:
        motions = found(measured(bench, *QUICK))
        assert list(motions) == ["J1", "J2"]
        for number, motion in enumerate(motions.values()):
            true_um = true_rms_um(number, motion["from_deg"], motion["to_deg"])
            assert abs(motion["rms_um"] - true_um) <= 2.0 * motion["u_rms_um"]
            assert motion["u_rms_um"] < 0.25
            assert max(motion["eccentricity_um"]) < 25.0

        run = last_run(tmp_path, "radial-error-motion")
        text = bench.cell.read_text(encoding="utf-8")
        assert catseye("budget", run, "--cell", bench.cell, cwd=tmp_path).returncode == ExitCode.USAGE
        assert bench.cell.read_text(encoding="utf-8") == text
        done = catseye("budget", run, "--cell", bench.cell, "--yes", cwd=tmp_path)
        assert done.returncode == ExitCode.DONE, done.stderr
        changed = bench.cell.read_text(encoding="utf-8")
        assert re.findall(r"#.*", changed) == re.findall(r"#.*", text)

        shown = catseye("show", run, cwd=tmp_path)
        assert "Radial error motion, rms along a direction (k = 2): J1" in shown.stdout + shown.stderr
        page = catseye("report", run, "-o", "radial.html", cwd=tmp_path)
        assert page.returncode == ExitCode.DONE, page.stderr
        assert "Radial error motion values (ISO 230-7" in (tmp_path / "radial.html").read_text(
            encoding="utf-8"
        )

        for procedure in ("reflector-search", "open-loop"):
            done = catseye("run", procedure, "--cell", bench.cell, "--speed", SPEED, cwd=tmp_path)
            assert done.returncode == ExitCode.DONE, done.stderr[-2000:]
        lines = {line["name"]: line for line in identified(bench, "result.json")["budget"]["contributor"]}
        for joint, motion in motions.items():
            line = lines[f"radial error motion of {joint}"]
            assert line["value_um"] == pytest.approx(motion["rms_um"], abs=0.006)
            assert line["measured_by"] == run
        assert "measured_by" not in lines["radial error motion of J4"]


def test_a_killed_run_goes_on_where_it_was_read(tmp_path: Path) -> None:
    with emulated(tmp_path, "--seed", str(SEED)) as bench:
        only_j1 = ("--param", 'joints=["J1"]', *QUICK)
        before = asked(measured(bench, *only_j1, crash="after-commit:30"))
        died = last_run(tmp_path, "radial-error-motion")
        events_seen = events(catseye("resume", died, "--json", "--telemetry", cwd=tmp_path).stdout)
        after = asked(events_seen)
        assert "J1/direct/mount" in before
        assert "J1/direct/mount" not in after
        assert not {name for name in before if "/xy/" in name} & set(after)
        motion = found(events_seen)["J1"]
        true_um = true_rms_um(0, motion["from_deg"], motion["to_deg"])
        assert abs(motion["rms_um"] - true_um) <= 2.0 * motion["u_rms_um"]
