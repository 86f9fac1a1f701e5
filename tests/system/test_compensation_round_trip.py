"""A path compensated with a known arm and driven on it by the real driver: the arm's repeatability is left."""

import asyncio
import csv
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2

from catseye.app.store.reader import RunReader
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.comparison import rigid_fit
from catseye.calibration.scara.planar import inverse
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.roles.clock import SystemClock
from catseye.procedures.scara.motion.approach import Command, with_take_up
from catseye.simulators.config import EmulationConfig, ErrorBudget, TruthText
from catseye.simulators.emulated_bench import EmulatedBench
from tests.system.command import SPEED, catseye, emulated
from tests.system.test_validation_path import truth
from tests.unit.simulators.benches import QUIET

Row = tuple[float, float, float, float, int, int]
"""x and y in mm, J1 and J2 in deg, states of approach."""

Y_MM = [*range(-400, 401, 50), *range(400, -401, -50)]

REPEATABILITY_UM = ErrorBudget().repeatability_um
"""Standard deviation of x and of y at each arrival."""


def result_of_the_truth() -> dict[str, Any]:
    """Return the true arm as an identification would have found it, had it been perfect."""
    result: dict[str, Any] = truth()
    for name in ("theta1_map", "theta2_map"):
        zeros = [0.0] * len(result[name]["node_deg"])
        result[name] |= {"u_positive_mdeg": zeros, "u_negative_mdeg": zeros}
    for estimate in (result["link1_mm"], result["link2_mm"]):
        estimate["u"] = 0.0
    return result | {
        "model": "error-map",
        "gauge": "true arm",
        "nominal": {"link1_mm": 325.0, "link2_mm": 225.0},
        "reflectors": [],
        "dead_paths": [],
        "fit": dict.fromkeys(("n_points", "n_parameters", "dof", "rms_um", "sigma0_um", "iterations"), 0)
        | {"rejected": [], "null_directions": []},
        "provenance": {"runs": [], "software": "", "created": ""},
    }


def compensated(folder: Path) -> list[Row]:
    """Return the corrected rows that the command writes for the path."""
    (folder / "truth.json").write_text(json.dumps(truth()), encoding="utf-8")
    (folder / "result.json").write_text(json.dumps(result_of_the_truth()), encoding="utf-8")
    lines = ["x_mm,y_mm", *(f"200,{y}" for y in Y_MM)]
    (folder / "path.csv").write_text("\n".join(lines), encoding="utf-8")
    done = catseye("compensate", "result.json", "--path", "path.csv", "-o", "joints.csv", cwd=folder)
    assert done.returncode == 0, done.stderr
    text = (folder / "joints.csv").read_text(encoding="utf-8").splitlines()
    return [row_of(row) for row in csv.DictReader(line for line in text if not line.startswith("#"))]


def row_of(cells: dict[str, str]) -> Row:
    x_mm, y_mm, one, two = (float(cells[name]) for name in ("x_mm", "y_mm", "theta1_deg", "theta2_deg"))
    return x_mm, y_mm, one, two, int(cells["direction1"]), int(cells["direction2"])


def uncorrected(rows: Sequence[Row]) -> list[Row]:
    """Return the same rows with the commands of the nominal arm."""
    place = np.array([row[:2] for row in rows])
    theta = np.rad2deg(np.column_stack(inverse(place, 325.0, 225.0)))
    return [(*row[:2], float(one), float(two), *row[4:]) for row, (one, two) in zip(rows, theta, strict=True)]


async def true_errors_um(rows: Sequence[Row], config: EmulationConfig) -> Floats:
    """Drive the rows with their take-ups and return how far the arm truly stands from each, µm, shape (n,)."""
    stops = with_take_up(tuple(Command(i, *row[2:]) for i, row in enumerate(rows)), 1.0)
    missed = []
    async with EmulatedBench(config) as bench:
        robot, *_, control = (served.endpoint for served in bench.endpoints)
        clock = SystemClock(config.speed)
        driver = MelfaR3.at(robot, clock)
        try:
            await driver.connect()
            await driver.servo(on=True)
            await driver.set_override(20.0)
            for stop in stops:
                await driver.move_joints((stop.theta1_deg, stop.theta2_deg, 0.0, 0.0))
                if stop.command is not None:
                    # The ringing dies away before anybody would look.
                    await clock.sleep(1.0)
                    x_mm, y_mm = (await asked(control, op="state"))["xy_mm"]
                    missed.append(
                        np.hypot(x_mm - rows[stop.command.index][0], y_mm - rows[stop.command.index][1])
                    )
        finally:
            await driver.close()
    return 1e3 * np.array(missed)


async def asked(endpoint: str, **request: object) -> dict[str, Any]:
    host, _, port = endpoint.removeprefix("tcp://").rpartition(":")
    reader, writer = await asyncio.open_connection(host, int(port))
    writer.write(json.dumps(request).encode() + b"\n")
    answer: dict[str, Any] = json.loads(await reader.readline())
    writer.close()
    assert answer["ok"], answer
    return answer


def rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("round-trip")


@pytest.fixture(scope="module")
def rows(folder: Path) -> list[Row]:
    return compensated(folder)


def bench_with(folder: Path, budget: ErrorBudget) -> EmulationConfig:
    text = TruthText((folder / "truth.json").read_bytes(), "truth.json")
    return replace(QUIET, speed=float(SPEED), truth=text, seed=3, budget=budget)


async def test_an_arm_that_repeats_exactly_stands_there_within_a_step(folder: Path, rows: list[Row]) -> None:
    config = bench_with(folder, ErrorBudget.none())
    before, after = await true_errors_um(uncorrected(rows), config), await true_errors_um(rows, config)
    assert rms(before) > 100.0
    # Half a step of 1 mdeg: 4.8 µm by J1 at full reach, 2.0 µm by J2.
    assert after.max() < 6.8


async def test_the_error_falls_to_the_arms_repeatability(
    folder: Path, rows: list[Row], capsys: pytest.CaptureFixture[str]
) -> None:
    config = bench_with(folder, replace(ErrorBudget.none(), repeatability_um=REPEATABILITY_UM))
    before, after = await true_errors_um(uncorrected(rows), config), await true_errors_um(rows, config)
    assert rms(before) > 100.0
    # x and y of n arrivals; steps of 1 mdeg add up to 3 µm.
    low, high = (chi2.ppf(share, 2 * after.size) / after.size for share in (1e-4, 1.0 - 1e-4))
    assert REPEATABILITY_UM * np.sqrt(low) < rms(after) < np.hypot(REPEATABILITY_UM * np.sqrt(high), 3.0)
    with capsys.disabled():
        print(  # noqa: T201  # the figure is the result
            f"\ncompensated path: true 2-D error {rms(before):.0f} → {rms(after):.1f} µm rms; "
            f"repeatability {np.sqrt(2.0) * REPEATABILITY_UM:.1f} µm, step of 1 mdeg 3 µm"
        )


def test_a_technician_drives_it_and_an_independent_instrument_sees_it(
    folder: Path, rows: list[Row], capsys: pytest.CaptureFixture[str]
) -> None:
    header = "x_mm,y_mm,theta1_deg,theta2_deg,direction1,direction2"
    lines = [header, *(",".join(map(str, row)) for row in uncorrected(rows))]
    (folder / "nominal.csv").write_text("\n".join(lines), encoding="utf-8")
    seen = {}
    with emulated(folder, "--seed", "3", "--truth", "truth.json") as bench:
        for name in ("nominal.csv", "joints.csv"):
            options = (
                "--cell",
                bench.cell,
                "--speed",
                SPEED,
                "--search",
                "none",
                "--param",
                f"joints={name}",
            )
            done = catseye("run", "validation-path", *options, cwd=folder)
            assert done.returncode == 0, done.stderr
            found = RunReader(folder / done.stdout.strip()).rows("path")
            place = np.array([[row["x_mm"], row["y_mm"]] for row in found], dtype=np.float64)
            measured = np.array([[row["x_meas_mm"], row["y_meas_mm"]] for row in found], dtype=np.float64)
            seen[name] = 1e3 * rms(np.hypot(*(rigid_fit(measured, place).apply(measured) - place).T))
    with capsys.disabled():
        print(  # noqa: T201  # the figure is the result
            f"\nseen by a tracker, all errors of the bench: {seen['nominal.csv']:.0f} → "
            f"{seen['joints.csv']:.0f} µm rms"
        )
    # Repeatability and radial error motions of three joints, x and y: 22 µm; the tracker adds 11 µm.
    assert seen["joints.csv"] < 30.0
    assert seen["nominal.csv"] > 2.0 * seen["joints.csv"]
