"""A diagnosis of a long table against one identification of it."""

import time
from collections.abc import Callable
from dataclasses import replace

from catseye.app.cell.scara.uncertainty import Uncertainty
from catseye.calibration.scara.diagnostics.diagnosis import diagnose
from catseye.calibration.scara.diagnostics.problem import Problem
from tests.unit.calibration.scara.scans.scan import NOMINAL_REFLECTORS, arm, scan

ROWS = 60_000
LIMIT = 5.0


def timed_s(work: Callable[[], object]) -> float:
    start_s = time.perf_counter()
    work()
    return time.perf_counter() - start_s


def test_a_diagnosis_costs_less_than_five_identifications() -> None:
    truth = arm(1, 20.0)
    points = replace(scan(truth, ROWS, noise_mm=0.01), sigma_mm=None)
    nodes, budget = (truth.nodes1_rad, truth.nodes2_rad), Uncertainty().budget
    posed = Problem(points, "error-map", *nodes, 325.0, 225.0, NOMINAL_REFLECTORS, budget)
    before_s = timed_s(posed.solve)
    whole_s = timed_s(lambda: diagnose(posed))
    once_s = (before_s + timed_s(posed.solve)) / 2.0
    print(  # noqa: T201  # the figure
        f"\n{ROWS} distances: diagnosis {whole_s:.1f} s, identification {once_s:.1f} s, "
        f"ratio {whole_s / once_s:.1f} (limit {LIMIT:g})"
    )
    assert whole_s <= LIMIT * once_s
