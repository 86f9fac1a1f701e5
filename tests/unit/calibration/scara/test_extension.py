"""Terms beyond the maps: derivatives, recovery from noise-free distances, null directions by name."""

import math

import numpy as np
import pytest

from catseye.calibration.core.errors import UnidentifiableError
from catseye.calibration.scara.distance_model import distance_model
from catseye.calibration.scara.extension import Term, crosstalk, j4_map, periodic, thermal_drift
from tests.unit.calibration.scara.diagnostics.bench import (
    Extra,
    coefficients,
    commands_between,
    commands_on_nodes,
    measured,
    problem,
)
from tests.unit.calibration.scara.paper import MDEG, random_truth

ALL = periodic(1, (36,)) + periodic(2, (50,)) + crosstalk() + j4_map() + thermal_drift()


def test_jacobian_with_terms_agrees_with_differences() -> None:
    points = measured(random_truth(1), commands_between())
    identified = problem(points, terms=ALL).solve()
    model = distance_model(identified.layout, identified.points)
    at = identified.parameters + np.random.default_rng(2).normal(0.0, 1e-3, identified.parameters.size)
    analytic = model.jacobian(at)
    for k in range(at.size):
        step = np.zeros(at.size)
        step[k] = 1e-5
        numeric = (model.residuals(at + step) - model.residuals(at - step)) / 2e-5
        assert np.abs(analytic[:, k] - numeric).max() <= 2e-5, identified.layout.names()[k]


CASES: list[tuple[str, tuple[Term, ...], Extra, dict[str, float]]] = [
    (
        "periodic",
        periodic(1, (36,)) + periodic(2, (50,)),
        Extra(
            theta1=lambda p: 4.0 * MDEG * math.cos(36 * p.theta1) - 2.0 * MDEG * math.sin(36 * p.theta1),
            theta2=lambda p: 3.0 * MDEG * math.sin(50 * p.theta2),
        ),
        {
            "Δθ1 cos 36θ1": 4.0 * MDEG,
            "Δθ1 sin 36θ1": -2.0 * MDEG,
            "Δθ2 cos 50θ2": 0.0,
            "Δθ2 sin 50θ2": 3.0 * MDEG,
        },
    ),
    (
        "crosstalk",
        crosstalk((1,)),
        Extra(
            theta1=lambda p: 5.0 * MDEG * math.cos(p.theta2),
            theta2=lambda p: -3.0 * MDEG * math.sin(p.theta1),
        ),
        {"Δθ1 cos θ2": 5.0 * MDEG, "Δθ1 sin θ2": 0.0, "Δθ2 cos θ1": 0.0, "Δθ2 sin θ1": -3.0 * MDEG},
    ),
    (
        "J4 map",
        j4_map((2, 3)),
        Extra(length=lambda p: 0.011 * math.cos(2 * p.beam) - 0.006 * math.sin(3 * p.beam)),
        {"Δd cos 2θ4": 0.011, "Δd sin 2θ4": 0.0, "Δd cos 3θ4": 0.0, "Δd sin 3θ4": -0.006},
    ),
    (
        "thermal drift",
        thermal_drift(),
        Extra(link1=lambda p: 0.012 * p.share, link2=lambda p: 0.007 * p.share),
        {"ΔL1 t": 0.012, "ΔL2 t": 0.007},
    ),
]


@pytest.mark.parametrize(
    ("terms", "extra", "expected"), [case[1:] for case in CASES], ids=[c[0] for c in CASES]
)
def test_each_kind_of_term_is_recovered_from_noise_free_distances(
    terms: tuple[Term, ...], extra: Extra, expected: dict[str, float]
) -> None:
    truth = random_truth(3)
    identified = problem(measured(truth, commands_between(), extra), terms=terms).solve()
    layout = identified.layout
    found = coefficients(identified.parameters[layout.extension], [term.name for term in terms])
    assert found == pytest.approx(expected, abs=1e-8)
    assert identified.parameters[:2] == pytest.approx([truth.link1_mm, truth.link2_mm], abs=1e-7)
    assert identified.fit.rms_um < 1e-4


def test_periodic_terms_on_nodes_are_refused_with_the_remedy() -> None:
    points = measured(random_truth(4), commands_on_nodes())
    with pytest.raises(UnidentifiableError, match="measure between the nodes") as caught:
        problem(points, terms=periodic(1, (36,)) + periodic(2, (50,))).solve()
    concerned = {name for names in caught.value.null_directions for name in names if name.startswith("Δ")}
    assert {"Δθ1 cos 36θ1", "Δθ1 sin 36θ1", "Δθ2 cos 50θ2"} <= concerned
    assert "Δθ1 sin 36θ1" in str(caught.value)


def test_crosstalk_j4_and_drift_are_separable_on_nodes() -> None:
    points = measured(random_truth(5), commands_on_nodes())
    identified = problem(points, terms=crosstalk() + j4_map() + thermal_drift()).solve()
    assert np.abs(identified.parameters[identified.layout.extension]).max() < 1e-6


def test_a_constant_j4_term_is_refused() -> None:
    points = measured(random_truth(6), commands_between())
    with pytest.raises(UnidentifiableError, match="Δd"):
        problem(points, terms=(Term("length", "theta4", "cos", 0),)).solve()
