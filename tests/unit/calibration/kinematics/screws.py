"""Forward kinematics by products of exponentials, written down from the drawings of the arms, with no frame between.

An axis is a direction and a point of it in the base at zero joints; a joint turns or shifts everything behind it.
Only the shape of the arm at zero joints enters, and the exponential of a screw by Rodrigues' formula; no
Denavit-Hartenberg parameter does.
"""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.kinematics.types import Floats

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Axis:
    """A joint of an arm at zero joints: where a positive motion turns about or shifts along."""

    direction: Triple
    point_mm: Triple = (0.0, 0.0, 0.0)
    turns: bool = True

    def motion(self, q: float) -> Floats:
        """Return the transform of a joint's value, deg or mm."""
        moved = np.eye(4)
        x, y, z = self.direction
        if self.turns:
            across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            sine, versine = math.sin(math.radians(q)), 1.0 - math.cos(math.radians(q))
            moved[:3, :3] += sine * across + versine * across @ across
            moved[:3, 3] = self.point_mm - moved[:3, :3] @ self.point_mm
        else:
            moved[:3, 3] = q * np.array(self.direction)
        return moved


@dataclass(frozen=True)
class Arm:
    """Axes, and the flange at zero joints."""

    axes: tuple[Axis, ...]
    flange: Floats

    def motion(self, pose: Floats, joints: int) -> Floats:
        """Return how the first joints of a pose move what is behind them."""
        moved = np.eye(4)
        for axis, q in zip(self.axes[:joints], pose[:joints], strict=True):
            moved = moved @ axis.motion(float(q))
        return moved

    def forward(self, pose: Floats) -> Floats:
        """Return the flange at a pose, deg or mm, shape (joints,)."""
        placed: Floats = self.motion(pose, len(self.axes)) @ self.flange
        return placed


def _flange(columns: tuple[Triple, Triple, Triple], place: Triple) -> Floats:
    made = np.eye(4)
    made[:3, :3] = np.array(columns).T
    made[:3, 3] = place
    return made


FORWARD, UP, LEFT, DOWN = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0)
BACK = (-1.0, 0.0, 0.0)
OUTWARDS = (DOWN, LEFT, FORWARD)
"""x, y and z of a flange that looks forward with its x axis down."""


def kuka(first: float, shoulder: float, upper: float, offset: float, forearm: float, hand: float) -> Arm:
    """Return a KUKA, stretched forward with all axes at 0 and its forearm below the elbow by the offset."""
    elbow, level = shoulder + upper, first - offset
    return Arm(
        (
            Axis(DOWN),
            Axis(LEFT, (shoulder, 0.0, first)),
            Axis(LEFT, (elbow, 0.0, first)),
            Axis(BACK, (elbow, 0.0, level)),
            Axis(LEFT, (elbow + forearm, 0.0, level)),
            Axis(BACK, (elbow + forearm, 0.0, level)),
        ),
        _flange(OUTWARDS, (elbow + forearm + hand, 0.0, level)),
    )


KR210 = kuka(675.0, 350.0, 1150.0, 41.0, 1200.0, 215.0)
KR360 = kuka(1045.0, 500.0, 1300.0, 55.0, 1025.0, 290.0)
IRB120 = Arm(
    (
        Axis(UP),
        Axis(LEFT, (0.0, 0.0, 290.0)),
        Axis(LEFT, (0.0, 0.0, 560.0)),
        Axis(FORWARD, (0.0, 0.0, 630.0)),
        Axis(LEFT, (302.0, 0.0, 630.0)),
        Axis(FORWARD, (302.0, 0.0, 630.0)),
    ),
    _flange(OUTWARDS, (374.0, 0.0, 630.0)),
)
RH3FRH = Arm(
    (Axis(UP), Axis(UP, (325.0, 0.0, 0.0)), Axis(UP, turns=False), Axis(UP, (550.0, 0.0, 0.0))),
    _flange((FORWARD, LEFT, UP), (550.0, 0.0, 200.0)),
)
ARMS = {"kr210-r2700": KR210, "irb120": IRB120, "rh-3frh5515": RH3FRH}
