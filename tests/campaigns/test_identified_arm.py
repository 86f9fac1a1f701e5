"""The paper's plan measured on the emulated bench, and what the identified arm is good for on that same bench.

Compensation: the path is driven with the commands that the identified arm asks for, and the true error counted.

J4: its radial error motion shifts the beam's origin against link 2 by c(θ4); along the beam that adds
−Re(c exp(−iβ)) to a distance, β being the beam's angle against link 2. This function of β is all that distances see:
what lies across the beam stays unknown, and its orders 0 and 1 are dead paths, L2 and the mean of the J2 map.
"""

import csv
import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2

from catseye.app.cell.load import load_cell
from catseye.app.service.scara.emulation import emulation_config
from catseye.calibration.core.types import Floats
from catseye.simulators.config import EmulationConfig, ErrorBudget
from catseye.simulators.world.scara.axis_errors import RadialError
from tests.campaigns.test_whole_plan import run
from tests.system.command import Emulated, catseye, emulated
from tests.system.test_compensation_round_trip import Row, rms, row_of, true_errors_um, uncorrected

SPEED, SEED = "400", 3

ORDERS = (2, 3, 4, 5, 6)

Y_MM = [*range(-420, 421, 20), *range(420, -421, -20)]
X_MM = 240.0
"""The whole path lies within the nodes of the cell file."""


@dataclass(frozen=True)
class Measured:
    """A bench that has been measured and identified.

    Attributes:
        folder: with result.json, j4.json and the cell file.
        config: of the same bench, for driving on it again.
        truth: its true arm, a result document.
    """

    folder: Path
    config: EmulationConfig
    truth: dict[str, Any]


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Measured:
    folder = tmp_path_factory.mktemp("identified")
    with emulated(folder, "--seed", str(SEED)) as bench:
        truth = bench.ask(op="truth")["truth"]
        (folder / "truth.json").write_text(json.dumps(truth), encoding="utf-8")
        measure(bench, folder)
        cell = load_cell(bench.cell).cell
    config = emulation_config(cell, float(SPEED), SEED, folder / "truth.json")
    free = tuple(replace(device, endpoint="tcp://127.0.0.1:0") for device in config.devices)
    return Measured(folder, replace(config, devices=free, control="tcp://127.0.0.1:0"), truth)


def measure(bench: Emulated, folder: Path) -> None:
    run(bench.cell, folder, "reflector-search", SPEED)
    record = run(bench.cell, folder, "open-loop", SPEED)
    for options in (["-o", "result.json"], ["-o", "j4.json", "--extend", "j4"]):
        done = catseye("identify", record.path, *options, cwd=folder)
        assert done.returncode == 0, done.stderr


def result_of(measured: Measured, name: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((measured.folder / name).read_text(encoding="utf-8"))
    return found


def gauge_turn_rad(measured: Measured) -> float:
    """Return what an identified J1 map is shifted by against the true one: its mean over the identified nodes."""
    true, nodes = measured.truth["theta1_map"], result_of(measured, "result.json")["theta1_map"]["node_deg"]
    values = [np.interp(nodes, true["node_deg"], true[f"{name}_mdeg"]) for name in ("positive", "negative")]
    return float(np.deg2rad(1e-3 * np.mean(values)))


def in_true_frame(rows: list[Row], turn_rad: float) -> list[Row]:
    """Return rows whose wished places are given in the frame of the true arm instead of the result's."""
    turned = [complex(row[0], row[1]) * np.exp(1j * turn_rad) for row in rows]
    return [(place.real, place.imag, *row[2:]) for place, row in zip(turned, rows, strict=True)]


def read_rows(file: Path) -> list[Row]:
    lines = [line for line in file.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return [row_of(row) for row in csv.DictReader(lines)]


def u_um(file: Path) -> Floats:
    """Return the stated 2-D standard uncertainties of a compensated path, µm."""
    lines = [line for line in file.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    cells = list(csv.DictReader(lines))
    x_um, y_um = (np.array([float(row[name]) for row in cells]) for name in ("u_x_um", "u_y_um"))
    return np.asarray(np.hypot(x_um, y_um), dtype=np.float64)


@pytest.mark.timeout(900)
async def test_a_compensated_path_of_an_identified_arm(measured: Measured) -> None:
    lines = ["x_mm,y_mm", *(f"{X_MM},{y}" for y in Y_MM)]
    (measured.folder / "path.csv").write_text("\n".join(lines), encoding="utf-8")
    done = catseye("compensate", "result.json", "--path", "path.csv", "-o", "joints.csv", cwd=measured.folder)
    assert done.returncode == 0, done.stderr
    joints = measured.folder / "joints.csv"
    rows = in_true_frame(read_rows(joints), gauge_turn_rad(measured))
    assert len(rows) == len(Y_MM)
    before = [(*one[:2], *other[2:]) for one, other in zip(rows, uncorrected(read_rows(joints)), strict=True)]
    budget = ErrorBudget()
    repeatable = replace(measured.config, budget=replace(ErrorBudget.none(), repeatability_um=10.0))
    left = {}
    for title, config in (
        ("of an arm that only scatters", repeatable),
        ("with all errors of the bench", measured.config),
    ):
        first, last = await true_errors_um(before, config), await true_errors_um(rows, config)
        left[title] = rms(last)
        print(f"\ntrue 2-D error {title}: {rms(first):.0f} → {rms(last):.1f} µm rms")  # noqa: T201  # the figure
        assert rms(first) > 3.0 * rms(last)
    scatter = np.sqrt(2.0) * budget.repeatability_um
    radial = np.sqrt(2.0 * sum(size_um**2 for size_um in budget.radial_um))
    stated = rms(u_um(joints))
    print(f"repeatability {scatter:.1f} µm, radial error motions {radial:.1f} µm, stated u {stated:.1f} µm")  # noqa: T201  # the figure
    only_scatter, everything = left.values()
    # What is stated belongs to the whole map, so a path has one draw of it: twice that is its bound.
    assert scatter * 0.85 < only_scatter < np.hypot(1.15 * scatter, 2.0 * stated)
    assert everything < np.sqrt((1.15 * scatter) ** 2 + radial**2 + (2.0 * stated) ** 2)


def true_along_the_beam_um(config: EmulationConfig, theta40_deg: float) -> dict[tuple[str, int], float]:
    """Return the Fourier coefficients over β of what the bench's J4 adds to a distance, µm."""
    rng = np.random.default_rng([config.seed, 3])
    budget = config.budget
    sizes_um = budget.radial_um
    j4 = [RadialError(rng, size_um) for size_um in sizes_um][-1]
    beam_deg = np.arange(0.0, 360.0, 0.25)
    beam = np.deg2rad(beam_deg)
    added_um = -1e3 * np.real(j4.shift_mm(beam_deg - theta40_deg) * np.exp(-1j * beam))
    waves = {"cos": np.cos, "sin": np.sin}
    return {
        (part, order): 2.0 * float(np.mean(added_um * wave(order * beam)))
        for part, wave in waves.items()
        for order in ORDERS
    }


def test_the_j4_map_matches_the_true_radial_error_motion(measured: Measured) -> None:
    true = true_along_the_beam_um(measured.config, measured.truth["theta40_deg"])
    found = {
        (term["part"], term["order"]): (term["value"], term["u"])
        for term in result_of(measured, "j4.json")["extension"]
    }
    assert found.keys() == true.keys()
    print("\nJ4 map, µm: term, true, identified, u")  # noqa: T201  # the figure
    for (part, order), (value, u) in found.items():
        print(f"  {part} {order}θ4 {true[part, order]:7.2f} {value:7.2f} {u:6.2f}")  # noqa: T201  # the figure
    errors_um = np.array([found[key][0] - true[key] for key in true])
    stated_um = np.array([found[key][1] for key in true])
    size_um = rms(np.array(list(true.values())))
    print(  # noqa: T201  # the figure
        f"errors {rms(errors_um):.2f} µm rms, of terms of {size_um:.2f} µm; over their u "
        f"{rms(errors_um / stated_um):.2f} rms"
    )
    # Independent terms with honest uncertainties exceed this once in 1000 times.
    assert np.sum((errors_um / stated_um) ** 2) < chi2.ppf(0.999, errors_um.size)
    # A map that is not the bench's own is off by its size and more.
    assert rms(errors_um) < 0.5 * size_um
