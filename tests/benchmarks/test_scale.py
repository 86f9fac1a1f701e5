"""Scans: three million distances with nodes every degree, growth with points and nodes, digits that squares cost."""

import csv
import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy import linalg, sparse
from scipy.optimize import least_squares

from catseye.app.files.columns import table_blocks
from catseye.app.results.scara.points import POINTS
from catseye.app.results.scara.spooled_points import RECORD
from catseye.calibration.core.least_squares import factorise
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.distance_model import distance_model
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.points import Points
from catseye.calibration.scara.scans.passes import sparse_rows
from catseye.calibration.scara.scans.scan_identification import ScanIdentification, identify_scan
from catseye.calibration.scara.scans.source import SlicedPoints
from tests.unit.calibration.scara.scans.scan import NAMES, NOMINAL_REFLECTORS, Arm, arm, scan

ROOT = Path(__file__).parents[2]

FRESH = """
import json, sys, time
from pathlib import Path
import numpy as np
from catseye.app.results.scara.table_budget import SeenTable
from tests.unit.calibration.scara.scans.scan import NOMINAL_REFLECTORS, arm
from catseye.app.cell.scara.uncertainty import Uncertainty
from catseye.calibration.scara.budget import Budget
from catseye.app.results.scara.spooled_points import SpooledPoints
from catseye.calibration.scara.scans.scan_identification import identify_scan

file, rows, names, paths = sys.argv[1], int(sys.argv[2]), *map(json.loads, sys.argv[3:5])
truth, shared = arm(1, float(sys.argv[5])), sys.argv[6] == "shared"
source = SpooledPoints(
    open(file, "rb"), tuple(names), tuple(map(tuple, paths)), True, rows, SeenTable(Path(file))
)
budget = Budget(Uncertainty().budget.systematic) if shared else None
start_s, cpu_s = time.perf_counter(), time.process_time()
found = identify_scan(
    source, "error-map", truth.nodes1_rad, truth.nodes2_rad, 325.0, 225.0, NOMINAL_REFLECTORS, budget
).identified
wall_s, cpu_s = time.perf_counter() - start_s, time.process_time() - cpu_s
# What the kernel reports of this process alone; getrusage includes the one that started it.
peak_kb = next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmHWM"))
u = found.standard_uncertainty[: truth.parameters().size]
error = (found.parameters[: u.size] - truth.parameters()) / u
print(json.dumps({
    "wall_s": wall_s, "cpu_s": cpu_s,
    "peak_mb": peak_kb / 1e3,
    "parameters": found.fit.n_parameters, "passes": found.fit.iterations,
    "chi2": found.fit.chi2_reduced, "normalised": float(np.sqrt(np.mean(error**2))),
}))
"""


def timed_s(work: Callable[[], object]) -> float:
    start_s = time.perf_counter()
    work()
    return time.perf_counter() - start_s


def solved(points: Points, truth: Arm) -> ScanIdentification:
    nodes = truth.nodes1_rad, truth.nodes2_rad
    return identify_scan(SlicedPoints(points), "error-map", *nodes, 325.0, 225.0, NOMINAL_REFLECTORS)


def points_csv(points: Points, path: Path) -> None:
    commands = points.commands
    columns = (
        [NAMES[i] for i in points.reflector],
        [points.dead_paths[i][1] for i in points.dead_path],
        np.rad2deg(commands.theta1_rad).tolist(),
        np.rad2deg(commands.theta2_rad).tolist(),
        commands.direction1.tolist(),
        commands.direction2.tolist(),
        points.displacement_mm.tolist(),
    )
    with path.open("w") as out:
        out.write("reflector,segment,theta1_deg,theta2_deg,direction1,direction2,displacement_mm,sigma_mm\n")
        out.writelines(",".join(map(str, row)) + ",0.01\n" for row in zip(*columns, strict=True))


def spool(points: Points, path: Path) -> None:
    """Append distances to a file as the program keeps them while it solves."""
    records = np.zeros(len(points), dtype=RECORD)
    for name in ("theta1_rad", "theta2_rad", "direction1", "direction2"):
        records[name] = getattr(points.commands, name)
    for name in ("displacement_mm", "sigma_mm", "dead_path", "reflector"):
        records[name] = getattr(points, name)
    with path.open("ab") as out:
        records.tofile(out)


def solved_afresh(path: Path, rows: int, points: Points, step_deg: float, budget: str) -> dict[str, float]:
    """Solve the first rows of a file in a process of their own."""
    arguments = [
        str(path),
        str(rows),
        json.dumps(NAMES),
        json.dumps(points.dead_paths),
        str(step_deg),
        budget,
    ]
    answer = subprocess.run(
        [sys.executable, "-c", FRESH, *arguments], cwd=ROOT, capture_output=True, text=True, check=True
    )
    figures: dict[str, float] = json.loads(answer.stdout)
    return figures


def test_three_million_distances_with_nodes_every_degree(tmp_path: Path) -> None:
    rows = 3_000_000
    points = scan(arm(1, 1.0), rows, noise_mm=0.01, sigma_mm=0.01)
    spool(points, tmp_path / "points")
    figures = solved_afresh(tmp_path / "points", rows, points, 1.0, "white")
    print(  # noqa: T201  # the figure
        f"\n3 000 000 distances, {figures['parameters']} free parameters: {figures['wall_s']:.1f} s "
        f"({figures['cpu_s']:.1f} s of one core, aim 10), peak {figures['peak_mb']:.0f} MB (limit 1000), "
        f"{figures['passes']} passes, χ²/dof {figures['chi2']:.4f}, rms normalised error {figures['normalised']:.2f}"
    )
    assert figures["peak_mb"] <= 1000.0
    assert 0.9 < figures["normalised"] < 1.1


def test_an_hour_at_ten_kilohertz_with_its_budget(tmp_path: Path) -> None:
    rows, parts, step_deg = 3_000_000, 12, 2.5
    for part in range(parts):
        points = scan(arm(1, step_deg), rows, noise_mm=0.01, sigma_mm=0.01, seed=part)
        spool(points, tmp_path / "points")
    few, few_white = (
        solved_afresh(tmp_path / "points", rows, points, step_deg, kind) for kind in ("shared", "white")
    )
    many = solved_afresh(tmp_path / "points", parts * rows, points, step_deg, "shared")
    ratio = many["cpu_s"] / few["cpu_s"]
    print(  # noqa: T201  # the figure
        f"\n36 000 000 distances with the shared errors of the default budget, {many['parameters']} free parameters: "
        f"{many['cpu_s']:.0f} s of one core, {ratio:.1f} times 3 000 000 of them (limit 12), "
        f"{many['cpu_s'] / few_white['cpu_s']:.0f} times 3 000 000 without shared sources; "
        f"peak {many['peak_mb']:.0f} MB (limit 500)"
    )
    assert ratio <= 12.0
    assert many["peak_mb"] <= 500.0


def test_a_row_costs_a_fraction_of_what_it_costs_scipy() -> None:
    truth, rows = arm(1, 2.5), 60_000
    points = scan(truth, rows, noise_mm=0.01, sigma_mm=0.01)
    layout = Layout(
        "error-map", truth.nodes1_rad, truth.nodes2_rad, points.reflector_names, points.dead_paths
    )
    model, basis = distance_model(layout, points), layout.gauge_basis()
    start = model.start(325.0, 225.0, NOMINAL_REFLECTORS)
    weights = np.full(rows, 100.0)

    def residuals(parameters: Floats) -> Floats:
        return np.asarray(model.residuals(parameters) * weights, dtype=np.float64)

    def jacobian(parameters: Floats) -> "sparse.csr_matrix[np.float64]":
        return sparse.csr_matrix(sparse_rows(model, model.beams(parameters), parameters, weights).matrix())

    # The peer gets the analytic Jacobian, sparse; the gauge it leaves to the damping of LSMR.
    def peer() -> Floats:
        answer = least_squares(
            residuals,
            start,
            jacobian,
            method="trf",
            tr_solver="lsmr",
            x_scale="jac",
            xtol=1e-12,
            ftol=1e-12,
            gtol=1e-12,
            max_nfev=200,
        )
        return np.asarray(answer.fun, dtype=np.float64)

    pairs = [(timed_s(lambda: solved(points, truth)), timed_s(peer)) for _ in range(3)]
    ours_s, peer_s = (statistics.median(column) for column in zip(*pairs, strict=True))
    ratio = statistics.median(b / a for a, b in pairs)
    theirs, ours = peer(), model.residuals(solved(points, truth).identified.parameters) * weights
    excess = float(theirs @ theirs - ours @ ours)
    print(  # noqa: T201  # the figure
        f"\n60 000 rows, {basis.shape[1]} parameters: ours {1e6 * ours_s / rows:.2f} µs a row, scipy least_squares "
        f"(trf, lsmr, sparse Jacobian) {1e6 * peer_s / rows:.1f} µs a row, ratio {ratio:.1f} (limit 3); "
        f"its χ² is {excess:+.2g} above ours"
    )
    # χ² of 60 000 rows: both stand at the same minimum.
    assert abs(excess) < 1e-2
    assert ratio >= 3.0


def quickest_solve_s(points: Points, truth: Arm) -> float:
    """Return the time of the quickest of two rounds: other processes can only slow one down."""
    return min(timed_s(lambda: solved(points, truth)) for _ in range(2))


def exponent(sizes: list[int], times_s: list[float]) -> float:
    """Return the power of the size that a time grows with, by least squares of the logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(times_s), 1)[0])


def test_solving_time_is_linear_in_points_and_square_in_nodes() -> None:
    truth = arm(1, 2.0)
    rows = [200_000, 400_000, 800_000, 1_600_000]
    by_rows = []
    for count in rows:
        points = scan(truth, count, noise_mm=0.01, sigma_mm=0.01)
        by_rows.append(quickest_solve_s(points, truth))
    free, by_nodes = [], []
    for step_deg in (5.0, 2.5, 1.25, 0.625):
        finer = arm(1, step_deg)
        points = scan(finer, 100_000, noise_mm=0.01, sigma_mm=0.01)
        by_nodes.append(quickest_solve_s(points, finer))
        free.append(solved(points, finer).identified.fit.n_parameters)
    power_rows, power_nodes = exponent(rows, by_rows), exponent(free, by_nodes)
    steepest = float(np.log(by_nodes[-1] / by_nodes[-2]) / np.log(free[-1] / free[-2]))
    print("\n| distances | free parameters | time, s | µs a distance |\n|---:|---:|---:|---:|")  # noqa: T201  # the table
    for count, time_s in zip(rows, by_rows, strict=True):
        print(f"| {count} | 352 | {time_s:.2f} | {1e6 * time_s / count:.2f} |")  # noqa: T201  # the table
    for parameters, time_s in zip(free, by_nodes, strict=True):
        print(f"| 100000 | {parameters} | {time_s:.2f} | {1e6 * time_s / 1e5:.2f} |")  # noqa: T201  # the table
    print(  # noqa: T201  # the figure
        f"time ~ distances^{power_rows:.2f} (limit 1.1), ~ parameters^{power_nodes:.2f}, at the finest nodes "
        f"^{steepest:.2f} (limit 2)"
    )
    assert power_rows <= 1.1
    assert max(power_nodes, steepest) <= 2.0


def triangle_in_blocks(points: Points, layout: Layout, parameters: Floats, basis: Floats) -> Floats:
    """Return the triangle of a QR decomposition of the weighted Jacobian, block by block: nothing is squared."""
    triangle: Floats = np.zeros((0, basis.shape[1]))
    for block in SlicedPoints(points, 4_000).blocks():
        assert block.sigma_mm is not None
        rows = (distance_model(layout, block).jacobian(parameters) / block.sigma_mm[:, None]) @ basis
        whole = linalg.qr(np.vstack([triangle, rows]), mode="r")[0]
        triangle = np.asarray(whole[: basis.shape[1]], dtype=np.float64)
    return triangle


def test_squaring_costs_digits_of_the_uncertainty_only() -> None:
    truth = arm(1, 2.5)
    points = scan(truth, 100_000, noise_mm=0.01, sigma_mm=0.01)
    found = solved(points, truth).identified
    basis = found.layout.gauge_basis()
    factor = factorise(triangle_in_blocks(points, found.layout, found.parameters, basis))
    u = np.sqrt(np.diag(basis @ factor.covariance() @ basis.T))
    relative = float(np.abs(found.standard_uncertainty / u - 1.0).max())
    model = distance_model(found.layout, points)
    right = basis.T @ (model.jacobian(found.parameters).T @ model.residuals(found.parameters)) / 0.01**2
    left_mm = np.abs(basis @ (factor.covariance() @ right))
    condition = factor.singular_values[0] / factor.singular_values[-1]
    print(  # noqa: T201  # the figure
        f"\nQR in blocks against normal equations, {basis.shape[1]} parameters, condition {condition:.2g}: standard "
        f"uncertainties differ by {relative:.1g} (the square of the condition times ε is "
        f"{condition**2 * np.finfo(float).eps:.1g}), the estimate by {(left_mm / u).max():.1g} of its uncertainty"
    )
    # Uncertainties are taken at the last pass, one step of less than 1e-8 mm from the estimate.
    assert relative < 1e-7
    assert float((left_mm / u).max()) < 1e-6


def by_csv(path: Path) -> int:
    """Read a table as the standard library does: every row a list, every number a float; nothing is checked."""
    with path.open(newline="") as file:
        rows = csv.reader(file)
        next(rows)
        return sum(len([row[0], row[1], *map(float, row[2:])]) for row in rows)


def test_checked_reading_costs_no_more_than_the_csv_module(tmp_path: Path) -> None:
    rows, table = 100_000, tmp_path / "points.csv"
    points_csv(scan(arm(1, 2.0), rows, noise_mm=0.01), table)
    taken = [
        (
            timed_s(lambda: [len(columns) for _, columns in table_blocks(table, POINTS, NAMES)]),
            timed_s(lambda: by_csv(table)),
        )
        for _ in range(3)
    ]
    ours_s, peer_s = (min(column) for column in zip(*taken, strict=True))
    print(  # noqa: T201  # the figure
        f"\nreading CSV, checked: {rows / ours_s / 1e6:.2f} million rows a second (target 0.3), csv.reader with "
        f"floats and no check {rows / peer_s / 1e6:.2f}: {ours_s / peer_s:.2f} of its time (limit 2)"
    )
    assert ours_s <= 2.0 * peer_s
