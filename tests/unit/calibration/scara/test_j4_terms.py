"""A J4 map beside a stated radial error motion of J4: the map is what J4 did, and u says how well that is known."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor, Kind
from catseye.calibration.scara.budget_effects import effects
from catseye.calibration.scara.extension import Term, j4_map
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.uncertainty import draw_estimates
from tests.unit.calibration.scara.diagnostics.bench import Extra, Pose, commands_on_nodes, measured, problem
from tests.unit.calibration.scara.paper import random_truth

TRUTH = random_truth(8)
WHITE_MM = 0.004
RADIAL = Contributor("radial error motion of J4", "radial", 0.01, "axis-angle", "j4")
BUDGET = Budget((Contributor("readings", "length", WHITE_MM), RADIAL))


@dataclass(frozen=True)
class Motion:
    """Displacement of the J4 axis in the frame of link 2: Fourier coefficients of x and y, orders 1…5, mm."""

    cosine: list[list[float]]
    sine: list[list[float]]

    @classmethod
    def drawn(cls, seed: int) -> "Motion":
        values = np.random.default_rng(seed).normal(0.0, 0.01 / math.sqrt(5.0), (2, 2, 5)).tolist()
        return cls(*values)

    def longer(self, beam: float) -> float:
        """Return by how much it lengthens a beam that leaves J4 at an angle against link 2."""
        x, y = (
            sum(
                a * math.cos(k * beam) + b * math.sin(k * beam)
                for k, (a, b) in enumerate(zip(one, other, strict=True), start=1)
            )
            for one, other in zip(self.cosine, self.sine, strict=True)
        )
        return -x * math.cos(beam) - y * math.sin(beam)

    def coefficient(self, term: Term) -> float:
        """Return the amplitude of a term in it, by the mean over 64 angles."""
        wave = math.cos if term.part == "cos" else math.sin
        angles = [2.0 * math.pi * i / 64 for i in range(64)]
        return 2.0 * sum(self.longer(angle) * wave(term.order * angle) for angle in angles) / 64


def identified(motion: Motion, seed: int, terms: tuple[Term, ...] = j4_map()) -> Identification:
    def length(pose: Pose) -> float:
        return motion.longer(pose.beam)

    points = measured(TRUTH, commands_on_nodes(), Extra(length=length), noise_mm=WHITE_MM, seed=seed)
    return replace(problem(points, terms=terms), budget=BUDGET).solve()


def test_coefficients_and_links_lie_within_their_uncertainties() -> None:
    maps, links = [], []
    for seed in range(20):
        motion = Motion.drawn(seed)
        found = identified(motion, 100 + seed)
        extension, u = found.layout.extension, found.standard_uncertainty
        true = np.array([motion.coefficient(term) for term in found.layout.terms])
        maps.append((found.parameters[extension] - true) / u[extension])
        links.append((found.parameters[:2] - [TRUTH.link1_mm, TRUTH.link2_mm]) / u[:2])
        # White scatter alone: √(2 / 1056) of it, several times that for orders that other parameters resemble.
        assert u[extension].max() < 5.0 * WHITE_MM * math.sqrt(2.0 / 1056.0)
    # 200 values and 40: standard deviations known to 5 % and 11 %.
    assert float(np.sqrt(np.mean(np.square(maps)))) == pytest.approx(1.0, abs=0.16)
    assert float(np.sqrt(np.mean(np.square(links)))) == pytest.approx(1.0, abs=0.35)


def test_the_first_order_still_makes_the_second_link_uncertain() -> None:
    """It lengthens beams as a longer L2 does, and no map can distinguish the two."""
    with_map = identified(Motion.drawn(1), 1)
    assert with_map.standard_uncertainty[1] > 4.0 * WHITE_MM / math.sqrt(1056.0)


@pytest.mark.parametrize("kind", ["radial", "length"])
def test_a_contributors_remainder_lacks_the_maps_orders(kind: Kind) -> None:
    contributor = replace(RADIAL, kind=kind)
    terms = j4_map((2, 4))
    found = identified(Motion.drawn(2), 2, terms)
    geometry = found.model.geometry(found.parameters)
    angle = np.arctan2(-geometry.unit[:, 1], -geometry.unit[:, 0])
    angle = angle - found.points.commands.theta1_rad - found.points.commands.theta2_rad
    series = np.column_stack(
        [np.ones(angle.size), *(f(k * angle) for k in range(1, 7) for f in (np.cos, np.sin))]
    )
    without = replace(geometry, layout=replace(geometry.layout, terms=()))
    whole = effects(contributor, without)
    rest = effects(contributor, geometry)
    before, after = coefficients(series, whole), coefficients(series, rest)
    held = [3, 4, 7, 8]
    assert np.abs(before[held]).max() > 1e-4
    assert after[held] == pytest.approx(np.zeros_like(after[held]), abs=1e-12)
    free = [i for i in range(13) if i not in held]
    assert after[free] == pytest.approx(before[free], abs=1e-12)


def coefficients(series: Floats, columns: Floats) -> Floats:
    """Return the series that columns are, shape (terms, columns)."""
    found, _, _, _ = np.linalg.lstsq(series, columns, rcond=None)
    assert series @ found == pytest.approx(columns, abs=1e-12)
    return np.asarray(found, dtype=np.float64)


def test_draws_agree() -> None:
    found = identified(Motion.drawn(3), 3)
    spread = draw_estimates(found, 1500, 1).std(axis=0, ddof=1)
    # Standard deviations of 1500 draws are known to 1.8 %.
    extension = found.layout.extension
    assert spread[extension] == pytest.approx(found.standard_uncertainty[extension], rel=0.08)
