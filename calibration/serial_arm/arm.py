"""A serial arm as its maker draws it: joints, masses, and the targets that an instrument sees on its flange."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.bodies import Point
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.gravity import STANDARD_GRAVITY, Load, gravity_torques

_NMM_PER_NM = 1e3


@dataclass(frozen=True)
class Target:
    """A point on the flange that an instrument measures.

    Attributes:
        place_mm: in the frame of the flange.
        u_mm: standard uncertainty of each coordinate; 0 where the place is taken as exact, None where nobody knows it
            beforehand.
        turned: a frame of unknown orientation belongs to it; without one its axes are those of the flange.
    """

    name: str
    place_mm: Point
    u_mm: float | None = 0.0
    turned: bool = False


@dataclass(frozen=True)
class Anchor:
    """The fixed end of distances.

    Attributes:
        place_mm: in the frame of the instrument.
        u_mm: standard uncertainty of each coordinate; 0 where the place is taken as exact, None where nobody knows it
            beforehand.
    """

    name: str
    place_mm: Point = (0.0, 0.0, 0.0)
    u_mm: float | None = 0.0


@dataclass(frozen=True)
class Known:
    """What is known of a parameter beforehand, by a drawing's tolerance or a measurement of its own.

    Attributes:
        value: None where it is the nominal one.
        u: its standard uncertainty, in the parameter's unit.
    """

    value: float | None
    u: float


@dataclass(frozen=True)
class SerialArm:
    """The nominal arm.

    Attributes:
        chain: nominal joints.
        loads: masses of links and tool.
        targets: on the flange.
        gravity_m_s2: in the frame of the base.
        known: what is known beforehand of parameters beside nominal values, by name.
    """

    chain: Chain
    loads: tuple[Load, ...]
    targets: tuple[Target, ...]
    gravity_m_s2: Point = STANDARD_GRAVITY
    known: Mapping[str, Known] = field(default_factory=dict)

    def __post_init__(self) -> None:
        names = [target.name for target in self.targets]
        twice = [name for name in names if names.count(name) > 1]
        if twice:
            raise ArgumentError(f"two targets are called {twice[0]}: give each a name of its own")

    @property
    def joint_names(self) -> tuple[str, ...]:
        """From the base outwards."""
        return tuple(joint.name for joint in self.chain.joints)

    def torques_nmm(self, poses: Floats) -> Floats:
        """Return the gravity torques about +z of each joint of the nominal arm; forces along prismatic ones, in N.

        Args:
            poses: joints, deg or mm, shape (n, joints).
        """
        turning = np.array([joint.kind == "revolute" for joint in self.chain.joints])
        torques = gravity_torques(self.chain, self.loads, poses, self.gravity_m_s2)
        return torques * np.where(turning, _NMM_PER_NM, 1.0)

    def with_targets(self, targets: tuple[Target, ...]) -> "SerialArm":
        """Return the arm with other targets on its flange."""
        return replace(self, targets=targets)
