"""An IRB 120 with the errors that the six-axis paper found (Tables VI and VII), a second way: by screws.

Every axis is a line in the world at zero joints, laid out once from the printed parameters; a pose is a product of
exponentials about these lines. Gravity torques are numerical derivatives of the potential energy of the masses of
Table IV, which move by the same exponentials. Nothing of the calibration room is used.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NOMINAL = np.array(
    [
        # α_deg, a_mm, θ_deg at zero, d_mm (Table II)
        [0.0, 0.0, 0.0, 290.0],
        [-90.0, 0.0, -90.0, 0.0],
        [0.0, 270.0, 0.0, 0.0],
        [-90.0, 70.0, 0.0, 302.0],
        [90.0, 0.0, 0.0, 0.0],
        [-90.0, 0.0, 180.0, 72.0],
    ]
)

FOUND = np.array(
    [
        # Table VII; its torque terms are in COMPLIANCE.
        [0.0, 0.0, 0.0, 290.0],
        [-90.006, 0.134, -89.909, 0.0],
        [-0.011, 270.236, 0.054, 0.006],
        [-90.009, 70.138, -0.027, 302.246],
        [89.984, -0.061, 0.067, -0.067],
        [-89.969, 0.022, 179.913, 72.050],
    ]
)

COMPLIANCE = np.array([0.0, 0.032e-6, 0.130e-6, 0.605e-6, 0.419e-6, 0.647e-6])
"""rad/(N·mm), Table VII."""

BASE = np.array([-0.075, -0.096, 0.103, 0.003, 0.008, -0.033])
"""mm and deg, Table VI."""

NESTS = np.array([[0.0, 0.0, 125.0], [115.0, 0.0, 215.0], [0.0, 150.0, 125.0]])
"""About those of section 2.1, mm in the flange."""

MASSES = ((2, 4.2, (140.0, 0.0, 0.0)), (4, 5.0, (0.0, 0.0, -193.6)), (6, 2.7, (50.0, 25.0, 100.0)))
"""Frame, kg, centre in it: Table IV with the tool of section 2.1."""

LOW = np.array([-90.0, 0.0, -80.0, -150.0, -90.0, -180.0])
HIGH = np.array([90.0, 110.0, 70.0, 150.0, 90.0, 180.0])

_GRAVITY_N_PER_KG = 9.80665


def _about_x(deg: float) -> Array:
    c, s = np.cos(np.deg2rad(deg)), np.sin(np.deg2rad(deg))
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def _about_y(deg: float) -> Array:
    c, s = np.cos(np.deg2rad(deg)), np.sin(np.deg2rad(deg))
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def _about_z(deg: float) -> Array:
    c, s = np.cos(np.deg2rad(deg)), np.sin(np.deg2rad(deg))
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def placed(rotation: Array, place_mm: Array) -> Array:
    """Return a homogeneous transform."""
    made = np.eye(4)
    made[:3, :3], made[:3, 3] = rotation, place_mm
    return made


def _exponential(line: Array, angle_rad: Array) -> Array:
    """Return turns about the z axis of a frame (Rodrigues), shape (n, 4, 4)."""
    (x, y, z), point = line[:3, 2], line[:3, 3]
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, versine = np.sin(angle_rad)[:, None, None], 1.0 - np.cos(angle_rad)[:, None, None]
    made = np.zeros((len(angle_rad), 4, 4))
    made[:, :3, :3] = np.eye(3) + sine * across + versine * (across @ across)
    made[:, :3, 3] = point - made[:, :3, :3] @ point
    made[:, 3, 3] = 1.0
    return made


@dataclass(frozen=True)
class TrueArm:
    """An arm of printed parameters, with compliance.

    Attributes:
        table: α_deg, a_mm, θ_deg at zero, d_mm of each joint.
        compliance: rad/(N·mm) of each joint.
        base: x, y, z in mm; angles about x, y, z in deg, R = Rz·Ry·Rx.
        wave_deg: amplitude of an error of one period a turn, of each joint.
    """

    table: Array = field(default_factory=lambda: FOUND)
    compliance: Array = field(default_factory=lambda: COMPLIANCE)
    base: Array = field(default_factory=lambda: BASE)
    wave_deg: Array = field(default_factory=lambda: np.zeros(6))

    def zero_frames(self) -> list[Array]:
        """Return base and joints at zero."""
        rotation = _about_z(self.base[5]) @ _about_y(self.base[4]) @ _about_x(self.base[3])
        frames = [placed(rotation, self.base[:3])]
        for alpha, a, theta, d in self.table:
            shifted = placed(_about_x(alpha), np.array([a, 0.0, 0.0]))
            turned = placed(_about_z(theta), np.array([0.0, 0.0, d]))
            frames.append(frames[-1] @ shifted @ turned)
        return frames

    def moved(self, q_rad: Array, joints: int, frames: list[Array]) -> Array:
        """Return how the first joints move what is behind them, shape (n, 4, 4)."""
        motion = np.tile(np.eye(4), (len(q_rad), 1, 1))
        for i in range(joints):
            motion = motion @ _exponential(frames[i + 1], q_rad[:, i])
        return motion

    def flange(self, poses_deg: Array) -> Array:
        """Return the flange at poses, compliance included, shape (n, 4, 4)."""
        frames = self.zero_frames()
        wave = self.wave_deg * np.sin(np.deg2rad(poses_deg))
        q_rad = np.deg2rad(poses_deg + wave) + self.compliance * torques_nmm(poses_deg)
        return self.moved(q_rad, 6, frames) @ frames[6]

    def nests(self, poses_deg: Array, nest: NDArray[np.int64]) -> Array:
        """Return where nests are at poses, mm, shape (n, 3)."""
        places = np.column_stack([NESTS[nest], np.ones(len(nest))])
        return np.asarray((self.flange(poses_deg) @ places[:, :, None])[:, :3, 0])


DRAWN = TrueArm(NOMINAL, np.zeros(6), np.zeros(6))


def torques_nmm(poses_deg: Array) -> Array:
    """Return gravity torques about +z of each joint of the nominal arm: minus the slope of the potential energy."""
    frames = DRAWN.zero_frames()

    def energy(q_rad: Array) -> Array:
        height = np.zeros(len(q_rad))
        for frame, mass, centre in MASSES:
            place = DRAWN.moved(q_rad, frame, frames) @ (frames[frame] @ np.append(centre, 1.0))
            height += mass * _GRAVITY_N_PER_KG * place[:, 2]
        return height

    at, step = np.deg2rad(poses_deg), 1e-4
    slopes = [(energy(at + step * e) - energy(at - step * e)) / (2.0 * step) for e in np.eye(6)]
    return -np.column_stack(slopes)


def random_poses(count: int, seed: int) -> Array:
    """Return poses within the ranges of the paper, deg."""
    return np.random.default_rng(seed).uniform(LOW, HIGH, (count, 6))
