"""Chains of tests: the shipped arms, and poses within their ranges."""

from functools import cache

import numpy as np
from hypothesis import strategies as st

from catseye.app.cell.arm import shipped_arm
from catseye.app.cell.serial_arm import chain_of, loads_of
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.gravity import Load
from catseye.calibration.kinematics.joint_ranges import ranges_of
from catseye.calibration.kinematics.types import Floats

NAMES = ("kr210-r2700", "irb120", "rh-3frh5515")
SIX = NAMES[:2]


@cache
def chain(name: str) -> Chain:
    return chain_of(shipped_arm(name))


@cache
def loads(name: str) -> tuple[Load, ...]:
    return loads_of(shipped_arm(name))


def random_poses(name: str, count: int, seed: int = 1) -> Floats:
    low, high = ranges_of(chain(name))
    return np.random.default_rng(seed).uniform(low, high, (count, len(low)))


def poses(name: str) -> st.SearchStrategy[Floats]:
    """Draw a pose within the ranges, shape (1, joints)."""
    ends = zip(*ranges_of(chain(name)), strict=True)
    joints = st.tuples(*(st.floats(float(low), float(high), width=32) for low, high in ends))
    return joints.map(lambda q: np.clip(np.array([q], dtype=np.float64), *ranges_of(chain(name))))


def miss(found: Floats, wanted: Floats) -> tuple[float, float]:
    """Return the largest differences of transforms: mm, and of the elements of rotations."""
    apart = np.abs(found - wanted)
    return float(apart[..., :3, 3].max(initial=0.0)), float(apart[..., :3, :3].max(initial=0.0))
