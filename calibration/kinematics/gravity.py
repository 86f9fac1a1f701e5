"""Gravity on a serial arm: torques of its joints from the masses of links and tool, and the potential energy.

The torque about an axis is that of the weight of everything behind the joint. Balancers, springs and friction are not
in it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.calibration.kinematics.bodies import Point
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.errors import KinematicsError
from catseye.calibration.kinematics.types import Floats

STANDARD_GRAVITY: Point = (0.0, 0.0, -9.80665)
"""m/s², of an arm that stands on the floor (CGPM 1901)."""

_M_PER_MM = 1e-3


@dataclass(frozen=True)
class Load:
    """A mass, fixed to a frame.

    Attributes:
        frame: number of the frame, 0 for the base.
        mass_kg: zero or more.
        centre_mm: of gravity, in that frame.
    """

    frame: int
    mass_kg: float
    centre_mm: Point

    def __post_init__(self) -> None:
        if not 0.0 <= self.mass_kg < math.inf or not all(map(math.isfinite, self.centre_mm)):
            raise KinematicsError(
                f"load on frame {self.frame}: {self.mass_kg:g} kg at {self.centre_mm} mm: state a finite mass of "
                "zero or more and a finite centre"
            )


def gravity_torques(
    chain: Chain, loads: Sequence[Load], poses: Floats, gravity_m_s2: Point = STANDARD_GRAVITY
) -> Floats:
    """Return what gravity exerts about, or along, +z of each joint.

    That is −∂U/∂θ of the potential energy, with θ the angle of the frame: a drive holds the arm with `-sign` times it
    in the direction of the joint's own value.

    Args:
        loads: links and tool; those on the base do not count.
        poses: joints, deg or mm, shape (n, joints).
        gravity_m_s2: in the base's frame.

    Returns:
        N·m of a revolute joint, N of a prismatic one, shape (n, joints).
    """
    frames = chain.frames(poses)
    found = np.zeros((len(poses), len(chain.joints)))
    mass_kg, moment = 0.0, np.zeros((len(poses), 3))
    for i in range(len(chain.joints), 0, -1):
        for load in _on(chain, loads, i):
            mass_kg += load.mass_kg
            moment += load.mass_kg * _place(frames[i], load)
        origin, axis = frames[i, :, :3, 3], frames[i, :, :3, 2]
        if chain.joints[i - 1].kind == "prismatic":
            found[:, i - 1] = mass_kg * (axis @ np.array(gravity_m_s2))
        else:
            torque = _M_PER_MM * np.cross(moment - mass_kg * origin, gravity_m_s2)
            found[:, i - 1] = np.einsum("ni,ni->n", axis, torque)
    return found


def potential_energy(
    chain: Chain, loads: Sequence[Load], poses: Floats, gravity_m_s2: Point = STANDARD_GRAVITY
) -> Floats:
    """Return the potential energy of the loads, from the origin of the base.

    Arguments are those of `gravity_torques`.

    Returns:
        J, shape (n,).
    """
    frames = chain.frames(poses)
    found = np.zeros(len(poses))
    for i in range(len(chain.joints) + 1):
        for load in _on(chain, loads, i):
            found -= _M_PER_MM * load.mass_kg * (_place(frames[i], load) @ np.array(gravity_m_s2))
    return found


def _on(chain: Chain, loads: Sequence[Load], frame: int) -> list[Load]:
    last = len(chain.joints)
    beyond = [load.frame for load in loads if not 0 <= load.frame <= last]
    if beyond:
        raise KinematicsError(f"load on frame {beyond[0]}: the arm has frames 0…{last}")
    return [load for load in loads if load.frame == frame]


def _place(frame: Floats, load: Load) -> Floats:
    placed: Floats = frame[:, :3, :3] @ np.array(load.centre_mm) + frame[:, :3, 3]
    return placed
