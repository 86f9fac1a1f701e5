"""A change of one value alone is found and judged by the whole covariance of the difference."""

import numpy as np
import pytest

from catseye.app.results.scara.changes import Compared, Pattern, beyond, changes_of, largest
from catseye.app.results.scara.shared_errors import NOTHING_SHARED, SharedErrors
from catseye.calibration.core.types import Floats


def single(count: int) -> list[Pattern]:
    return [Pattern(f"v{place}", "mdeg", row) for place, row in enumerate(np.eye(count))]


def compared(difference: Floats) -> Compared:
    weights = np.eye(difference.size)
    return Compared(difference, (weights, weights))


def test_independent_values_are_judged_by_themselves() -> None:
    first, second = np.diag([0.09, 0.16]), np.diag([0.16, 0.09])
    found = changes_of(compared(np.array([1.0, -2.0])), single(2), (first, second), NOTHING_SHARED)
    assert [one.value for one in found] == pytest.approx([1.0, -2.0])
    assert [one.u for one in found] == pytest.approx([0.5, 0.5])
    assert [one.normalised for one in found] == pytest.approx([2.0, -4.0])


def test_what_all_values_have_in_common_hides_no_single_one() -> None:
    """Of values with variance s² + c² and covariance c², one alone is known to s √(1 + 1/(n − 1)) as c grows."""
    count, s, c = 5, 0.3, 100.0
    half = 0.5 * (s**2 * np.eye(count) + c**2)
    found = changes_of(compared(np.full(count, 40.0)), single(count), (half, half), NOTHING_SHARED)
    assert found[0].u == pytest.approx(s * np.sqrt(1.0 + 1.0 / (count - 1)), rel=1e-3)
    # All of them together are no change of any.
    assert max(abs(one.normalised) for one in found) < 1.0
    shifted = np.full(count, 40.0)
    shifted[2] += 3.0
    named = largest(changes_of(compared(shifted), single(count), (half, half), NOTHING_SHARED))
    assert named is not None
    assert named.name == "v2"
    assert named.value == pytest.approx(3.0, abs=0.01)


def test_shared_errors_are_none_of_the_change() -> None:
    moved = np.array([[0.4], [0.0]])
    shared = SharedErrors(("radial",), ((moved, moved),))
    covariance = np.diag([0.25, 0.25])
    found = changes_of(compared(np.array([1.0, 1.0])), single(2), (covariance, covariance), shared)
    assert found[0].u == pytest.approx(np.sqrt(0.5 - 2.0 * 0.16))
    assert found[1].u == pytest.approx(np.sqrt(0.5))


def test_a_gauge_leaves_nothing_to_know_of_the_mean() -> None:
    gauge = np.eye(3) - 1.0 / 3.0
    covariance = 0.5 * gauge
    patterns = [Pattern("mean", "mdeg", np.zeros(3)), Pattern("one", "mdeg", gauge[:, 0])]
    moved = Compared(gauge @ np.array([3.0, 0.0, 0.0]), (gauge, gauge))
    found = changes_of(moved, patterns, (covariance, covariance), NOTHING_SHARED)
    assert [one.name for one in found] == ["one"]
    assert found[0].value == pytest.approx(3.0)


def test_what_is_known_best_is_not_taken_for_unknown() -> None:
    """Of two values of variance 1 and correlation ρ a change of one alone is known to √(1 − ρ²)."""
    rho = 1.0 - 5e-6
    covariance = 0.5 * np.array([[1.0, rho], [rho, 1.0]])
    (found, _) = changes_of(
        compared(np.array([0.02, 0.0])), single(2), (covariance, covariance), NOTHING_SHARED
    )
    assert found.u == pytest.approx(np.sqrt(1.0 - rho**2), rel=1e-6)
    assert found.value == pytest.approx(0.02)
    # Beyond the digits of stored results: eigenvalues 2 and 1e-9, of which the second counts as 2e-6.
    rho = 1.0 - 1e-9
    covariance = 0.5 * np.array([[1.0, rho], [rho, 1.0]])
    (found, _) = changes_of(
        compared(np.array([0.02, 0.0])), single(2), (covariance, covariance), NOTHING_SHARED
    )
    assert found.u == pytest.approx((0.5 / 2.0 + 0.5 / 2e-6) ** -0.5, rel=1e-6)


@pytest.mark.parametrize("unit", [1.0, 1e-6, 1e6])
def test_units_of_values_decide_nothing(unit: float) -> None:
    covariance = 0.5 * unit**2 * np.diag([0.25, 0.25])
    moved = compared(unit * np.array([2.0, 0.0]))
    patterns = [Pattern("one", "", unit * np.array([1.0, 0.0]))]
    (found,) = changes_of(moved, patterns, (covariance, covariance), NOTHING_SHARED)
    assert (found.value, found.u) == pytest.approx((2.0, 0.5))


def test_drawn_differences_have_changes_of_unit_size() -> None:
    rng = np.random.default_rng(4)
    root = rng.normal(size=(6, 6))
    covariance = root @ root.T
    draws = rng.multivariate_normal(np.zeros(6), 2.0 * covariance, 4000)
    sizes = [
        [
            one.normalised
            for one in changes_of(compared(draw), single(6), (covariance, covariance), NOTHING_SHARED)
        ]
        for draw in draws
    ]
    # The mean square of 4000 draws is 1 within four of its standard deviations.
    np.testing.assert_allclose(np.mean(np.square(sizes), axis=0), 1.0, atol=4.0 * np.sqrt(2.0 / 4000))


def test_changes_beyond_a_limit_come_largest_first() -> None:
    covariance = np.diag([0.5, 0.5, 0.5])
    found = changes_of(
        compared(np.array([4.0, 1.0, -5.0])), single(3), (covariance, covariance), NOTHING_SHARED
    )
    assert [one.name for one in beyond(found, 3.5)] == ["v2", "v0"]
    assert beyond(found, None) == []
