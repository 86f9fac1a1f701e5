"""Instrument, warm-up and single joints of an emulated IRB 120, by real commands, against the bench's truth."""

import json
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from catseye.app.cell.templates import SIX_AXIS, TEMPLATES
from tests.system.command import Emulated, catseye, emulated, last_run

SEED = 3
SPEED = "60"
"""Higher, and a busy machine's delays count as long rests of the arm."""
TWO_FACES_URAD = 4.0
"""Standard deviation of collimation and index errors of the emulated tracker."""


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    folder = tmp_path_factory.mktemp("serial")
    with emulated(folder, "--seed", str(SEED), "--speed", SPEED, text=TEMPLATES[SIX_AXIS].text) as running:
        yield running


def found(bench: Emulated, procedure: str, *params: str) -> dict[str, list[dict[str, Any]]]:
    """Run a procedure; return the tables of what it found as `show --json` has them."""
    folder = bench.cell.parent
    words = [word for param in params for word in ("--param", param)]
    answers = folder / "answers.toml"
    answers.write_text('"bar/1" = "laid"\n', encoding="utf-8")
    done = catseye(
        "run", procedure, "--cell", bench.cell, "--speed", SPEED, "--answers", answers, *words, cwd=folder
    )
    assert done.returncode == 0, done.stderr
    run = last_run(folder, procedure)
    page = folder / f"{procedure}.html"
    assert catseye("report", run, "-o", page, cwd=folder).returncode == 0
    assert "<svg" in page.read_text(encoding="utf-8") or procedure == "instrument-check"
    shown = catseye("show", run, "--json", cwd=folder)
    assert shown.returncode == 0, shown.stderr
    tables: dict[str, list[dict[str, Any]]] = json.loads(shown.stdout)["found"]
    return tables


def test_every_joint_shows_play_and_circle(bench: Emulated) -> None:
    rows = found(bench, "axis-analysis", 'joints=["J2", "J4"]', "step_deg=10", "dwell_s=0.5")["axes"]
    assert [row["joint"] for row in rows] == ["J2", "J4"]
    for row in rows:
        # Table III: play of some hundredths; a circle that repeats to hundredths of a millimetre.
        assert abs(row["backlash_deg"]) < 0.06
        assert row["radial_std_mm"] < 0.1
        assert row["axial_std_mm"] < 0.1
        arc_mm = math.radians(row["angular_range_deg"]) * row["radius_mm"]
        assert row["tangential_range_mm"] == pytest.approx(arc_mm, rel=0.02)


def test_both_faces_differ_by_collimation_and_index(bench: Emulated) -> None:
    tables = found(bench, "instrument-check", "bar_mm=1000", "bar_places=1", "repeats=2", "dwell_s=0.5")
    rng = np.random.default_rng([SEED, 36])
    rng.standard_normal()  # the error of all distances, drawn first
    apart_rad = 2e-6 * TWO_FACES_URAD * float(np.linalg.norm(rng.standard_normal(2)))
    for row, place in zip(tables["nests"], ((-1450, -50), (-1450, 650), (-2150, 650)), strict=True):
        expected_mm = apart_rad * math.hypot(*place, 330.0)
        assert row["two_face_mm"] == pytest.approx(expected_mm, abs=4.0 * row["repeatability_mm"])
    (bar,) = tables["length-errors"]
    assert abs(bar["mean_mm"]) < 0.1


def test_a_warm_up_ends_below_its_limit(bench: Emulated) -> None:
    rows = found(
        bench,
        "tracker-warmup",
        *("exercise_poses=1", "cycles=1", "window_min=2", "checks=1", "limit_um_per_10min=1000"),
        "dwell_s=0.5",
    )["warm-up"]
    assert rows[-1]["drift_um_per_10min"] <= 1000.0
    assert all(row["drift_um_per_10min"] is None for row in rows[:3])
