"""Random poses all over the ranges of the shipped arms: joints are found for every one, and they reach it."""

import os

import numpy as np
import pytest

from catseye.calibration.kinematics.inverse import inverse_kinematics
from catseye.calibration.kinematics.joint_ranges import ranges_of, within
from tests.unit.calibration.kinematics.chains import NAMES, chain, miss, random_poses
from tests.unit.calibration.kinematics.screws import ARMS

POSES = int(os.environ.get("CATSEYE_POSES", "100000"))
SEED = 20261123
BY_SCREWS = 2000
"""Poses that are also calculated by products of exponentials; the others by the chain that these agree with."""


@pytest.mark.parametrize("name", NAMES)
def test_random_poses_are_all_found_again(name: str) -> None:
    arm, wide = chain(name), random_poses(name, POSES, SEED)
    targets = arm.flange(wide)
    solved = inverse_kinematics(arm, targets, np.mean(ranges_of(arm), axis=0))
    found = solved.required()
    assert within(found, *ranges_of(arm)).all()
    worst_mm, worst = miss(arm.flange(found), targets)
    few = min(BY_SCREWS, POSES)
    screws_mm, screws = miss(np.array([ARMS[name].forward(q) for q in found[:few]]), targets[:few])
    print(  # noqa: T201  # the figure
        f"\n{name}: {POSES} poses, seed {SEED}: 0 refused, {len(solved.singular)} singular; "
        f"largest misses {worst_mm:.1e} mm and {worst:.1e}, by screws {screws_mm:.1e} mm and {screws:.1e}"
    )
    assert max(worst_mm, screws_mm) < 1e-6
    assert max(worst, screws) < 1e-8
