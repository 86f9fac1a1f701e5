"""The paper's rule, against the same in plain words."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.least_step import first_grown, moving_mean, steps_within

ERRORS = arrays.arrays(np.float64, st.integers(1, 40), elements=st.floats(-50.0, 50.0) | st.just(np.nan))


@given(ERRORS)
def test_each_mean_is_of_eleven_neighbours_that_are_there(errors: Floats) -> None:
    for k, found in enumerate(moving_mean(errors)):
        window = [e for e in errors[max(0, k - 5) : k + 6] if not np.isnan(e)]
        assert np.isnan(found) if not window else np.isclose(found, sum(window) / len(window))


@given(ERRORS, st.floats(1.0, 40.0))
def test_the_first_step_beyond_the_threshold_ends_the_count(errors: Floats, threshold: float) -> None:
    count = 0
    while count < errors.size and abs(errors[count]) <= threshold:
        count += 1
    assert steps_within(errors, threshold) == count


def test_many_runs_are_judged_at_once() -> None:
    errors = np.array([[1.0, 2.0, 11.0, 1.0], [12.0, 1.0, 1.0, 1.0], [1.0, -9.0, 9.0, 10.0]])
    assert steps_within(errors, 10.0).tolist() == [2, 0, 4]


@pytest.mark.parametrize(
    ("sizes", "grown"),
    [
        ([4.0, 3.0, 2.0], None),
        ([4.0, 3.0, 3.0, 2.0, 2.0], None),
        ([4.0, 3.0, 3.0, 3.0], 2),
        ([4.0, 4.0], 1),
        ([4.0, 3.0, 3.5, 2.0], 2),
    ],
)
def test_a_size_may_repeat_once(sizes: list[float], grown: int | None) -> None:
    assert first_grown(np.array(sizes)) == grown
