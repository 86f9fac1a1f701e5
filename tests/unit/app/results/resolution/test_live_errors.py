"""Step errors while a series goes on, against the rule of the resolution paper worked out step by step."""

import numpy as np
import pytest

from catseye.app.protocol.run_events import LiveStepData
from catseye.app.results.resolution.live_errors import live_errors

RATIO = 1.072267


def steps(errors: list[float], *, first: int = 1, below_from: int = 1000) -> list[LiveStepData]:
    found = []
    for place, error in enumerate(errors):
        number = first + place
        command = 0.1 / RATIO ** (number - 1)
        found.append(
            LiveStepData(
                series="A1+ at K1",
                number=number,
                count=109,
                command=command,
                measured=command * (1.0 + error / 100.0),
                position=0.0,
                unit="deg",
                error_percent=error,
                band_percent=10.0,
                torque_nm=None,
                below=number >= below_from,
            )
        )
    return found


def mean_of(errors: list[float], place: int) -> float:
    window = errors[max(place - 5, 0) : place + 6]
    return sum(window) / len(window)


def test_the_mean_takes_five_neighbours_on_either_side() -> None:
    errors = [float((7 * n) % 11) - n for n in range(30)]
    found = live_errors(steps(errors)).mean_percent
    assert found == pytest.approx([mean_of(errors, place) for place in range(30)])


def test_the_spread_is_that_about_the_mean() -> None:
    errors = [float((7 * n) % 11) - n for n in range(30)]
    squares = [(error - mean_of(errors, place)) ** 2 for place, error in enumerate(errors)]
    expected = [mean_of(squares, place) ** 0.5 for place in range(30)]
    assert live_errors(steps(errors)).spread_percent == pytest.approx(expected)


def test_the_least_step_is_where_the_mean_leaves_the_band() -> None:
    errors = [0.0] * 20 + [-40.0] * 20
    # The mean is -40 k / 11 with k large errors in its window: k = 2 is within 10 %, k = 3 is not.
    last = next(place for place in range(40) if abs(mean_of(errors, place)) > 10.0) - 1
    assert live_errors(steps(errors)).least == pytest.approx(0.1 / RATIO**last)
    assert last == 16


def test_who_came_late_is_told_no_least_step() -> None:
    assert live_errors(steps([0.0] * 20, first=30)).least is None


def test_who_could_not_keep_up_is_told_no_least_step() -> None:
    seen = steps([0.0] * 20)
    assert live_errors([*seen[:7], *seen[9:]]).least is None


def test_steps_below_the_instrument_are_in_no_mean() -> None:
    errors = [1.0] * 20 + [500.0] * 5
    found = live_errors(steps(errors, below_from=21))
    assert found.mean_percent is not None
    assert found.mean_percent[:20] == pytest.approx([1.0] * 20)
    assert np.isnan(found.mean_percent[20:]).all()
    assert found.below.tolist() == [False] * 20 + [True] * 5


@pytest.mark.parametrize("commands", [[0.1, 0.1, 0.1], [0.1, -0.1, 0.05], [0.1, 0.05, -0.02]])
def test_steps_that_do_not_decrease_have_no_mean(commands: list[float]) -> None:
    made = [
        each.model_copy(update={"command": command})
        for each, command in zip(steps([1.0, 2.0, 3.0]), commands, strict=True)
    ]
    assert live_errors(made).mean_percent is None
