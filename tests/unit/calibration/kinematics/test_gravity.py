"""Gravity torques against slopes of the potential energy, both against levers by hand and by screws."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.calibration.kinematics.bodies import Point
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.errors import KinematicsError
from catseye.calibration.kinematics.gravity import Load, gravity_torques, potential_energy
from catseye.calibration.kinematics.types import Floats
from tests.unit.calibration.kinematics.chains import NAMES, chain, loads, poses, random_poses
from tests.unit.calibration.kinematics.screws import ARMS

G = 9.80665
TILTED: Point = (3.0, -2.0, -9.0)
HELD: dict[str, tuple[Load, ...]] = {
    "kr210-r2700": (*loads("kr210-r2700"), Load(6, 210.0, (50.0, -100.0, 200.0))),
    "irb120": (*loads("irb120"), Load(6, 3.0, (10.0, -20.0, 50.0))),
    "rh-3frh5515": (Load(1, 5.0, (150.0, 20.0, 400.0)), Load(4, 3.0, (10.0, 0.0, -30.0))),
}
SIGNS = {name: np.array([joint.sign for joint in chain(name).joints]) for name in NAMES}


def slope(arm: Chain, held: tuple[Load, ...], pose: Floats, gravity: Point) -> Floats:
    """Return ∂U/∂q by central differences, J per rad or m."""
    found = []
    for k, joint in enumerate(arm.joints):
        step = np.zeros_like(pose)
        step[0, k] = 0.01
        up, down = (potential_energy(arm, held, pose + way * step, gravity)[0] for way in (1.0, -1.0))
        found.append((up - down) / 0.02 / (math.radians(1.0) if joint.kind == "revolute" else 1e-3))
    return np.array(found)


@pytest.mark.parametrize("name", NAMES)
@given(data=st.data())
def test_torques_are_slopes_of_the_potential_energy(name: str, data: st.DataObject) -> None:
    pose = data.draw(poses(name))
    for gravity in ((0.0, 0.0, -G), TILTED):
        torques = gravity_torques(chain(name), HELD[name], pose, gravity)[0]
        # U up to 20 kJ with 16 digits over 0.02 deg; the third derivative adds 1e-8 of a torque of 8 kN·m.
        assert -SIGNS[name] * torques == pytest.approx(
            slope(chain(name), HELD[name], pose, gravity), abs=1e-4
        )


@pytest.mark.parametrize("name", NAMES)
def test_torques_are_weights_times_levers_about_the_screws(name: str) -> None:
    for pose in random_poses(name, 20):
        torques = gravity_torques(chain(name), HELD[name], pose[None])[0]
        expected = np.zeros(len(pose))
        for load in HELD[name]:
            # Where a load is at rest, moved by the joints in front of it.
            rest = chain(name).frames(np.zeros((1, len(pose))))[load.frame, 0] @ [*load.centre_mm, 1.0]
            place = ARMS[name].motion(pose, load.frame) @ rest
            for k in range(load.frame):
                axis, moved = ARMS[name].axes[k], ARMS[name].motion(pose, k)
                direction = moved[:3, :3] @ axis.direction
                weight = np.array([0.0, 0.0, -G * load.mass_kg])
                lever = (place - moved @ [*axis.point_mm, 1.0])[:3] / 1000.0
                force = np.cross(lever, weight) if axis.turns else weight
                expected[k] += direction @ force
        # A screw points where a positive joint turns, +z of a frame the same or the other way.
        assert SIGNS[name] * torques == pytest.approx(expected, abs=1e-9)


def test_the_stretched_kr210_holds_its_masses_by_hand() -> None:
    arm = chain("kr210-r2700")
    pose = np.array([[0.0, -5.0, 5.0, 0.0, 0.0, 0.0]])
    reach_m = 1.150 * math.cos(math.radians(5.0))
    arm_nm = 231.49 * 0.4949 * math.cos(math.radians(5.0))
    forearm_nm = 173.31 * (reach_m + 0.19737) + 57.53 * (reach_m + 1.16117)
    torques = gravity_torques(arm, loads("kr210-r2700"), pose)[0]
    assert torques[0] == pytest.approx(0.0, abs=1e-9)
    assert torques[1] == pytest.approx(G * (arm_nm + forearm_nm))
    assert torques[2] == pytest.approx(G * (173.31 * 0.19737 + 57.53 * 1.16117))


def test_the_sliding_joint_carries_what_hangs_on_it() -> None:
    arm = chain("rh-3frh5515")
    torques = gravity_torques(arm, HELD["rh-3frh5515"], random_poses("rh-3frh5515", 3))
    assert torques == pytest.approx(np.tile([0.0, 0.0, -3.0 * G, 0.0], (3, 1)), abs=1e-9)


def test_loads_without_a_meaning_are_refused() -> None:
    with pytest.raises(KinematicsError, match="load on frame 2: -1 kg"):
        Load(2, -1.0, (0.0, 0.0, 0.0))
    with pytest.raises(KinematicsError, match="frame 7: the arm has frames 0…6"):
        gravity_torques(chain("irb120"), (Load(7, 1.0, (0.0, 0.0, 0.0)),), np.zeros((1, 6)))
