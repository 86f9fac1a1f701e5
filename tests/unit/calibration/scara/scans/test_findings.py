"""What a scan finds of its errors: against dense matrices with numerical derivatives, and the solver in memory."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.found_drift import FoundDrift, found_drifts
from catseye.calibration.scara.identification import Identification, identify
from catseye.calibration.scara.points import Points
from catseye.calibration.scara.reversal import SeparatedOrder, separated_orders
from catseye.calibration.scara.scans.scan_identification import identify_scan
from catseye.calibration.scara.scans.source import SlicedPoints
from tests.unit.calibration.scara import paper
from tests.unit.calibration.scara.drifting import course
from tests.unit.calibration.scara.reversal import HALF_TURN, AxisMotion, mounted
from tests.unit.calibration.scara.scans.scan import scan
from tests.unit.calibration.scara.scans.test_shared_errors import (
    EQUAL,
    TRUTH,
    WHITE,
    in_memory,
    rows_of,
    scanned,
    slopes,
    table,
)

ZERO = Contributor("zero", "length", 0.004, "time", orders=3, spectrum=(4.0, 0.5))
WARMTH = Contributor("warmth", "links", 4e-6, "time", orders=2, spectrum=(1.0, 2.0))
AIR = Contributor("air", "scale", 1e-5, "time", orders=2, spectrum=(0.5, 2.0))
KNOWN = Budget((WHITE, ZERO, WARMTH, AIR))
J4 = Contributor("J4", "radial", 0.020, "axis-angle", "j4", spectrum=(1.0, 2.0, 0.5, 1.0, 1.0))
CABLE = Contributor("cable", "length", 0.005, "axis-angle", "j4", orders=3, spectrum=(1.0, 1.0, 1.0))


def drifting(points: Points, rms_mm: float) -> Points:
    """Let the zero rise steadily."""
    rise = np.linspace(-1.0, 1.0, len(points)) * np.sqrt(3.0) * rms_mm
    return replace(points, displacement_mm=points.displacement_mm + rise)


def figures(found: FoundDrift) -> list[float]:
    return [found.change, found.u_change, found.rms, found.u_rms, found.probability]


def processes(points: Points, values: Floats) -> tuple[list[Floats], list[Floats]]:
    """Return what a unit of each order does to the distances, mm, and its standard deviation, for all processes."""
    grown = np.zeros((1, values.size))
    grown[0, :2] = values[:2]
    columns = np.ones((len(points), 1)), slopes(points, values, grown), points.displacement_mm[:, None]
    elapsed = np.arange(len(points)) / (len(points) - 1)
    effects, sizes = [], []
    # Variances fall as 1/k² and add up to u² as stated; orders 2 and 3 are one octave.
    for column, u, ratios in zip(
        columns, (0.004, 4e-6, 1e-5), ((4.0, 0.5, 0.5), (1.0, 2.0), (0.5, 2.0)), strict=True
    ):
        orders = np.arange(1, len(ratios) + 1)
        waves = [[course(k, share) for k in range(1, len(ratios) + 1)] for share in elapsed]
        effects.append(column * np.array(waves))
        falling = 1.0 / orders**2
        sizes.append(u * np.sqrt(np.array(ratios) * falling / falling.sum()))
    return effects, sizes


def dense(points: Points, found: Identification) -> list[list[float]]:
    """Return the figures of all drifts, by matrices of rows by rows."""
    values, n = found.parameters, len(points)
    (effects, sizes), residuals = processes(points, values), rows_of(points, values) - points.displacement_mm
    constraint = np.zeros((1, values.size))
    constraint[0, 2 : 2 + 2 * TRUTH.nodes1_rad.size] = 1.0
    jacobian = slopes(points, values, np.linalg.svd(constraint)[2][1:])
    covariances = [(one * size) @ (one * size).T for one, size in zip(effects, sizes, strict=True)]

    def left(covariance: Floats, columns: Floats) -> Floats:
        inverse = np.linalg.inv(covariance)
        spread = np.linalg.inv(columns.T @ inverse @ columns)
        return np.asarray(inverse - inverse @ columns @ spread @ columns.T @ inverse, dtype=np.float64)

    everything = 0.010**2 * np.eye(n) + sum(covariances)
    off = left(everything, jacobian)
    results = []
    for own, size, covariance in zip(effects, sizes, covariances, strict=True):
        sources = own * size
        mean, spread = -sources.T @ off @ residuals, np.eye(size.size) - sources.T @ off @ sources
        orders = range(1, size.size + 1)
        change = size * np.array([course(k, 1.0) - course(k, 0.0) for k in orders])
        rms = float(np.sqrt(np.sum((size * mean) ** 2)))
        slope = size**2 * mean / rms
        without = everything - covariance
        before, after = (
            float(residuals @ left(without, columns) @ residuals)
            for columns in (jacobian, np.hstack([jacobian, own]))
        )
        dof = n - jacobian.shape[1] - size.size
        ratio = (before - after) / size.size / (after / dof)
        results.append(
            [
                *grown(
                    change,
                    sources,
                    residuals,
                    left(everything - np.outer(sources[:, 0], sources[:, 0]), jacobian),
                ),
                rms,
                float(np.sqrt(slope @ spread @ slope)),
                float(stats.f.sf(ratio, size.size, dof)),
            ]
        )
    return results


def grown(change: Floats, sources: Floats, residuals: Floats, off: Floats) -> tuple[float, float]:
    """Return a change and its uncertainty, where the steady source is a further parameter.

    Args:
        off: inverse covariance of the rows without that source, off the model's columns.
    """
    steady, others = sources[:, 0], sources[:, 1:]
    variance = 1.0 / float(steady @ off @ steady)
    size = -variance * float(steady @ off @ residuals)
    pull = others.T @ off @ steady
    means = -others.T @ off @ (residuals + size * steady)
    known = np.eye(pull.size) - others.T @ off @ others
    # What the others are follows from the size of the steady one.
    along = change[0] - change[1:] @ pull
    u = float(np.sqrt(variance * along**2 + change[1:] @ known @ change[1:]))
    return float(change[0] * size + change[1:] @ means), u


@pytest.mark.parametrize("solve", [in_memory, scanned])
def test_found_drifts_match_dense_matrices(solve: Callable[[Points, Budget], Identification]) -> None:
    points = drifting(table(12), 0.002)
    found = solve(points, KNOWN)
    assert found.fit.variance_ratio == 1.0
    for one, expected in zip(found_drifts(found), dense(points, found), strict=True):
        # Derivatives from differences of lengths of 1e3 mm, rounded to 1e-13 mm, over steps of 1e-5.
        assert figures(one)[:4] == pytest.approx(expected[:4], rel=EQUAL, abs=EQUAL * expected[3])
        assert figures(one)[4] == pytest.approx(expected[4], rel=10.0 * EQUAL)


def test_a_scan_finds_the_drifts_of_all_its_rows() -> None:
    """Three of four rows are left out of the points that a scan keeps."""
    points = drifting(scan(TRUTH, 12_000, noise_mm=0.01, sigma_mm=0.01), 0.005)
    learning = Budget(tuple(replace(one, spectrum=()) for one in (ZERO, WARMTH)))
    ours, theirs = scanned(points, learning, 1_700), in_memory(points, learning)
    assert len(ours.points) < len(points) / 2
    for scans, whole in zip(found_drifts(ours), found_drifts(theirs), strict=True):
        assert figures(scans) == pytest.approx(figures(whole), rel=EQUAL, abs=EQUAL * whole.u_change)
    zero, warmth = found_drifts(ours)
    assert zero.significant
    assert not warmth.significant


def numbers(found: SeparatedOrder) -> list[float]:
    return [found.cosine_mm, found.sine_mm, found.u_mm, *found.u_parts_mm]


def turned(mounts: list[float]) -> tuple[tuple[SeparatedOrder, ...], tuple[SeparatedOrder, ...]]:
    """Return the orders that a scan, and the same table in memory, separate."""
    motion = AxisMotion.drawn(np.random.default_rng(6), 0.015, 0.010)
    points = mounted(paper.random_truth(6), motion.longer, mounts, 0.002, 6)
    budget = Budget((Contributor("repeatability", "position", 0.002), J4, CABLE))
    nodes = np.deg2rad(paper.NODES1_DEG), np.deg2rad(paper.NODES2_DEG)
    places = paper.NOMINAL_REFLECTORS
    summed = identify_scan(
        SlicedPoints(points, 300), "error-map", *nodes, 325.0, 225.0, places, budget
    ).identified
    whole = identify(points, "error-map", *nodes, 325.0, 225.0, places, budget)
    # A scan has no test of the lack of fit, which would widen what is found in memory.
    assert whole.fit.variance_ratio == 1.0
    return separated_orders(summed), separated_orders(whole)


def test_a_scan_separates_the_orders_of_j4() -> None:
    """In memory they are tested against the motion itself."""
    ours, theirs = turned([0.0, HALF_TURN])
    names = [(one.contributor, one.order) for one in ours]
    assert names == [("J4", 2), ("J4", 4), ("J4", 6), ("cable", 1), ("cable", 3)]
    assert names == [(one.contributor, one.order) for one in theirs]
    for scans, whole in zip(ours, theirs, strict=True):
        assert numbers(scans) == pytest.approx(numbers(whole), rel=EQUAL, abs=EQUAL * whole.u_mm)


def test_a_scan_in_one_mounting_separates_nothing() -> None:
    assert turned([0.0, 0.0]) == ((), ())
