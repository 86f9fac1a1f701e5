"""Shipped recordings are read as a user's results are, are whole, and can be made again."""

from itertools import islice

import pytest

from catseye.app.results.resolution.result import AnyTest
from catseye.app.results.resolution.shipped import shipped_results
from catseye.procedures.resolution.step_sizes import CYCLE_STEPS, CYCLES, STEPS
from tests.shipped_recordings import JOINTS, POSITIONS, as_filed, made_at
from tests.virtual_bench import ARM


def shipped(joint: str) -> list[AnyTest]:
    return [test for result in shipped_results(ARM) for test in result.tests if test.joint == joint]


@pytest.mark.parametrize("joint", JOINTS)
def test_every_position_has_every_test_and_says_it_is_shipped(joint: str) -> None:
    tests = shipped(joint)
    assert [(test.test, test.direction) for test in tests] == len(POSITIONS) * [
        ("decaying", 1),
        ("decaying", -1),
        ("iso", None),
        ("backlash", None),
    ]
    assert len({test.position for test in tests}) == len(POSITIONS)
    assert all(test.shipped for test in tests)


@pytest.mark.parametrize("joint", JOINTS)
def test_series_are_whole(joint: str) -> None:
    counts = {test.test: len(test.moves) for test in shipped(joint)}
    assert counts["decaying"] == STEPS
    assert counts["backlash"] == 2 * CYCLE_STEPS * CYCLES


def test_shipped_recordings_are_simulated() -> None:
    results = shipped_results(ARM)
    assert len(results) == len(JOINTS)
    assert all(result.provenance is not None and result.provenance.simulated for result in results)


def test_no_other_arm_has_shipped_recordings() -> None:
    assert shipped_results("irb120") == []


def test_a_place_that_is_recorded_again_gives_the_same() -> None:
    here = [test for test in shipped("A1") if test.position == 0.0]
    for made, kept in zip(islice(made_at("A1", "K3"), 2), here[:2], strict=True):
        found = as_filed(kept)
        # Other processors take the square roots of matrices in another way, and draw with them.
        least, again = found.pop("lis_deg"), made.pop("lis_deg")
        assert made == found
        assert again == pytest.approx(least, rel=0.1)
