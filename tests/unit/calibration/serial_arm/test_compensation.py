"""Compensated commands bring an arm, computed by screws, to where the program meant."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.serial_arm.compensation import compensate, with_approach
from catseye.calibration.serial_arm.geometry import Geometry
from catseye.calibration.serial_arm.identification import identify_arm
from catseye.calibration.serial_arm.parameters import Parameter, Reversal
from tests.unit.calibration.serial_arm.nominal import irb120, measured
from tests.unit.calibration.serial_arm.true_arm import BASE, DRAWN, NESTS, TrueArm, random_poses

STANDING = TrueArm(base=np.zeros(6))
"""The true arm in the frame of its own base."""


@pytest.fixture(scope="module")
def geometry() -> Geometry:
    return identify_arm(irb120(), measured(random_poses(38, 1)), "geometric+compliance").geometry


def tool() -> Floats:
    made = np.eye(4)
    made[:3, 3] = NESTS[1]
    return made


def test_true_arm_reaches_what_the_program_means(geometry: Geometry) -> None:
    poses = random_poses(50, 11)
    nest = np.ones(50, dtype=np.int64)
    found = compensate(geometry, poses, tool())
    reached = [one for one in range(50) if one not in {named.row for named in found.refused}]
    assert len(reached) >= 45
    missed = STANDING.nests(found.joints[reached], nest[reached]) - DRAWN.nests(poses[reached], nest[reached])
    assert np.abs(missed).max() < 1e-5


def test_uncorrected_error_is_that_of_the_true_arm(geometry: Geometry) -> None:
    poses, nest = random_poses(20, 12), np.ones(20, dtype=np.int64)
    missed = np.linalg.norm(STANDING.nests(poses, nest) - DRAWN.nests(poses, nest), axis=1)
    assert compensate(geometry, poses, tool()).uncorrected_mm == pytest.approx(missed, abs=1e-6)


def test_pose_at_the_end_of_a_range_is_refused(geometry: Geometry) -> None:
    poses = np.array([[165.0, 20.0, 0.0, 30.0, 40.0, 50.0], [-165.0, 20.0, 0.0, 30.0, 40.0, 50.0]])
    found = compensate(geometry, poses)
    assert len(found.refused) == 1
    assert "outside -165…165 deg" in found.refused[0].reason
    assert np.isnan(found.joints[found.refused[0].row]).all()


def test_singular_pose_is_refused(geometry: Geometry) -> None:
    found = compensate(geometry, np.array([[0.0, 30.0, 10.0, 0.0, 0.0, 0.0]]))
    assert "close to a singular one" in found.refused[0].reason


def test_base_of_the_paper_is_not_part_of_the_commands(geometry: Geometry) -> None:
    assert geometry.base[:3, 3] == pytest.approx(BASE[:3], abs=1e-6)
    turned = compensate(geometry, np.array([[0.0, 30.0, -10.0, 20.0, 40.0, 60.0]])).joints[0, 0]
    # The base of Table VI is turned by 0.033°, which the commands must not make up for.
    assert abs(turned) < 0.02


PLAY_DEG = 0.1


def test_commands_make_up_for_play_by_side(geometry: Geometry) -> None:
    # A joint with play stands half of it further on from below, and half of it short from above.
    play = Parameter("J2.reversal_deg", "deg", Reversal(1), 0.0)
    loose = replace(
        geometry, parameters=(*geometry.parameters, play), values=np.append(geometry.values, PLAY_DEG)
    )
    poses = random_poses(20, 13)
    sides = np.where(np.random.default_rng(13).random(poses.shape) < 0.5, 1.0, -1.0)
    nest = np.ones(20, dtype=np.int64)
    found = compensate(loose, poses, tool(), sides)
    kept = np.flatnonzero(np.isfinite(found.joints).all(axis=1))
    stood = found.joints + 0.5 * PLAY_DEG * sides * (np.arange(6) == 1)
    missed = STANDING.nests(stood[kept], nest[kept]) - DRAWN.nests(poses[kept], nest[kept])
    assert len(kept) >= 16
    # Gravity's torque is that of the command, which differs from where the arm stands by half the play.
    assert np.abs(missed).max() < 2e-3


def chain() -> Chain:
    return irb120().chain


def test_approach_beyond_a_range_is_refused(geometry: Geometry) -> None:
    poses = np.array([[0.0, 30.0, -10.0, 20.0, 40.0, 60.0], [-163.0, 20.0, 0.0, 30.0, 40.0, 50.0]])
    found = compensate(geometry, poses)
    assert not found.refused
    led = with_approach(chain(), found, np.ones_like(poses), 5.0)
    assert [one.row for one in led.refused] == [1]
    assert "its approach from 5 on its side: J1 would be at" in led.refused[0].reason
    assert np.isnan(led.joints[1]).all()
    from_above = np.where(np.arange(6) == 0, -1.0, 1.0) * np.ones((2, 1))
    assert not with_approach(chain(), found, from_above, 5.0).refused
