"""What changes during a measurement of an arm that is written down here: its zero drifts, or its links warm up.

Arms, radial error motions and scatter are those of the campaign between the nodes, the budget is a cell's default. A
drift is first-order autoregressive, 20 µm rms; its correlation falls to 1/e over 5 to 400 rows of some
1100. Links grow by 11.5 ppm. Path points are where the arm stands when the measurement is over.

`CATSEYE_DRIFT_SETS` sets how many arms [60].
"""

import os
from dataclasses import dataclass, replace

import numpy as np
import pytest

from catseye.app.cell.scara.uncertainty import Uncertainty
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.found_drift import found_drifts
from catseye.calibration.scara.identification import identify
from catseye.calibration.scara.points import Points
from catseye.calibration.scara.prediction import predict
from tests.campaigns.test_between_nodes import SEQUENCE, Arm, commands_of, path
from tests.unit.calibration.scara.drifting import autoregressive
from tests.unit.calibration.scara.paper import NAMES, NODES1_DEG, NODES2_DEG, NOMINAL_REFLECTORS

SETS = int(os.environ.get("CATSEYE_DRIFT_SETS", "60"))
DRIFT_MM = 0.020
GROWTH = 11.5e-6
BUDGET = Uncertainty().budget
STILL = replace(BUDGET, contributors=tuple(one for one in BUDGET.contributors if one.correlation != "time"))


class Changing(Arm):
    """An arm whose links grow steadily while it is measured, about those of its truth."""

    def __init__(self, seed: int, growth: float, drift_rows: float | None, steady_mm: float) -> None:
        super().__init__(seed, 0.0)
        self._mean, self._growth, self._drift_rows = self.truth, growth, drift_rows
        self._steady_mm = steady_mm

    def at(self, elapsed: float) -> None:
        """Let the links be as they are after a share of the measurement."""
        share = 1.0 + self._growth * (elapsed - 0.5)
        self.truth = replace(
            self._mean, link1_mm=self._mean.link1_mm * share, link2_mm=self._mean.link2_mm * share
        )

    def distances(self) -> Points:
        count = len(SEQUENCE) * len(NAMES)
        lengths, places = [], [complex(*xy) for xy in self.truth.reflectors.tolist()]
        for i in range(count):
            self.at(i / (count - 1))
            place, c = places[i // len(SEQUENCE)], SEQUENCE[i % len(SEQUENCE)]
            stands = self.stands(c.theta1_deg, c.theta2_deg, c.direction1, c.direction2, place)
            lengths.append(abs(stands - place))
        drift: Floats | float = 0.0
        if self._drift_rows is not None:
            drift = autoregressive(self.rng, DRIFT_MM, self._drift_rows, count)
        reflector = np.repeat(np.arange(len(NAMES)), len(SEQUENCE))
        dead_paths = tuple((name, 0) for name in NAMES)
        return Points(
            commands_of(SEQUENCE * len(NAMES)),
            reflector,
            reflector.copy(),
            np.array(lengths) + drift + self._steady_mm * np.linspace(-0.5, 0.5, count),
            None,
            NAMES,
            dead_paths,
        )


@dataclass(frozen=True)
class Judged:
    """Errors over u of parameters and path coordinates, u of the parameters, and what was found."""

    parameters: Floats
    path: Floats
    u: Floats
    found: tuple[str, ...]


def judged(
    seed: int, growth: float, drift_rows: float | None, *, steady_mm: float = 0.0, still: bool = False
) -> Judged:
    arm, way = Changing(seed, growth, drift_rows, steady_mm), path()
    nodes = np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)
    budget = STILL if still else BUDGET
    found = identify(arm.distances(), "error-map", *nodes, 325.0, 225.0, NOMINAL_REFLECTORS, budget)
    arm.at(0.5)
    true = arm.truth.table_vector()
    u = found.standard_uncertainty[: true.size]
    arm.at(1.0)
    predicted = predict(found.arm, commands_of(way), 325.0, 225.0)
    stood = np.array([arm.stands(c.theta1_deg, c.theta2_deg, c.direction1, c.direction2, None) for c in way])
    # The program's map has the mean 0 at its nodes; so has the true one.
    off = predicted.position_mm - np.column_stack([stood.real, stood.imag])
    return Judged(
        (found.parameters[: true.size] - true) / u,
        np.ravel(off / predicted.u_mm),
        u,
        tuple(one.contributor.kind for one in found_drifts(found) if one.significant),
    )


def covered(errors: list[Floats]) -> float:
    return float(np.mean(np.abs(np.concatenate(errors)) < 1.96))


def rms(errors: list[Floats]) -> float:
    return float(np.sqrt(np.mean(np.square(np.concatenate(errors)))))


@pytest.mark.timeout(60 + 20 * SETS)
@pytest.mark.parametrize("rows", [5.0, 20.0, 80.0, 400.0])
def test_a_drift_is_flagged_or_stays_covered(rows: float) -> None:
    """Where most of a drift is faster than the highest order, the flag is what counts."""
    sets = [judged(seed, 0.0, rows) for seed in range(SETS)]
    flagged = sum("length" in one.found for one in sets) / SETS
    parameters, points = covered([one.parameters for one in sets]), covered([one.path for one in sets])
    z = rms([one.parameters for one in sets])
    print(  # noqa: T201  # the figure
        f"\nAR(1) of {rows:g} rows, {SETS} arms: parameters {100 * parameters:.1f} %, path {100 * points:.1f} % in "
        f"95 % intervals, z {z:.2f}, flagged {100 * flagged:.0f} %"
    )
    assert (parameters >= 0.93 and points >= 0.93) or flagged >= 0.95


@pytest.mark.timeout(60 + 20 * SETS)
@pytest.mark.parametrize("steady_mm", [0.1, 0.5])
def test_a_steady_drift_of_the_zero_stays_covered(steady_mm: float) -> None:
    sets = [judged(seed, 0.0, None, steady_mm=steady_mm) for seed in range(SETS)]
    parameters, points = covered([one.parameters for one in sets]), covered([one.path for one in sets])
    print(  # noqa: T201  # the figure
        f"\nzero drifts steadily by {steady_mm:g} mm, {SETS} arms: parameters {100 * parameters:.1f} %, path "
        f"{100 * points:.1f} % in 95 % intervals"
    )
    assert parameters >= 0.93
    assert points >= 0.93


@pytest.mark.timeout(60 + 20 * SETS)
def test_warming_links_stay_covered() -> None:
    sets = [judged(seed, GROWTH, None) for seed in range(SETS)]
    parameters, points = covered([one.parameters for one in sets]), covered([one.path for one in sets])
    flagged = sum("links" in one.found for one in sets)
    print(  # noqa: T201  # the figure
        f"\nlinks grow by 11.5 ppm, {SETS} arms: parameters {100 * parameters:.1f} %, path {100 * points:.1f} % in "
        f"95 % intervals, flagged {flagged}"
    )
    assert parameters >= 0.93
    assert points >= 0.93


@pytest.mark.timeout(60 + 30 * SETS)
def test_where_nothing_changes_nothing_is_lost() -> None:
    sets = [judged(seed, 0.0, None) for seed in range(SETS)]
    before = [judged(seed, 0.0, None, still=True) for seed in range(SETS)]
    z, z_before = (rms([one.parameters for one in each]) for each in (sets, before))
    errors, errors_before = (rms([one.parameters * one.u for one in each]) for each in (sets, before))
    grown = float(np.mean([one.u / other.u for one, other in zip(sets, before, strict=True)]))
    flagged = sum(bool(one.found) for one in sets)
    print(  # noqa: T201  # the figure
        f"\nnothing changes, {SETS} arms: z {z:.3f} (without the contributors {z_before:.3f}), errors "
        f"{errors / errors_before:.3f} and u {grown:.3f} of those without, flagged {flagged}"
    )
    assert 0.95 <= z <= 1.05
    assert grown < 1.05
    assert errors < 1.03 * errors_before
    assert flagged <= max(1, SETS // 20)
