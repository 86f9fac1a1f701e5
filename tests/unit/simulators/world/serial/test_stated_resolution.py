"""Least steps and lost motion of drivetrains of one arm as the program states them: the campaign's short form."""

import numpy as np

from tests.campaigns.test_motion_resolution import reversed_once, stated
from tests.short_series import Plan, found_by, held_share

SEED = 7
A1, A3, A5 = 0, 2, 4


def test_least_steps_are_stated_with_intervals_that_hold() -> None:
    found = [one for joint in (A1, A3, A5) for one in stated(SEED, joint)]
    assert abs(np.median([one.steps_off for one in found])) <= 3.0
    assert sum(one.held for one in found) >= 9


def test_short_series_are_stated_with_intervals_that_hold() -> None:
    found = found_by(Plan(), 30, SEED)
    assert abs(np.mean([one.steps_off for one in found])) <= 0.8
    assert held_share(found) >= 0.9


def test_lost_motion_is_within_u_and_valid_for_play() -> None:
    balanced, loaded = reversed_once(SEED, A1), reversed_once(SEED, A3)
    assert max(abs(balanced.z), abs(loaded.z)) < 4.0
    assert (balanced.changes, balanced.valid) == (True, True)
    assert (loaded.changes, loaded.valid) == (False, False)
