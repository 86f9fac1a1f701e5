"""From motors to links: torsion, play and friction with pre-sliding, for several joints at once.

The twist of a transmission follows from the torque that it carries: torsion, and the play that the torque crosses
when its sign changes. It carries what holds the link against gravity, and the friction behind it, which has a memory:
after a reversal it grows over the pre-sliding length (Dahl, A solid friction model, 1968), and at rest some of it
creeps away.
On a way in one direction all of it is closed, so results do not depend on the steps in which it is followed.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.simulators.world.serial.truth import JointTruth
from catseye.simulators.world.types import Bools, Floats

_HALVINGS = 48
"""Bring a bracket of 0.1 deg below 1e-15 deg."""

_WAVES = (3.0, 19.0)
"""Waves of the friction in one turn of a joint: one wide as a sector of its range, one as what its rollers leave."""

_SLOW = 8.0
"""Half of the creep takes so many times longer than the other half."""


@dataclass(frozen=True)
class Drive:
    """Where drives stand and what they hold, shape (n,) or (m, n) each.

    Attributes:
        motor_deg: angle of the motor over the gear ratio.
        link_deg: angle of the link.
        hold_nm: torque that holds the link against gravity.
        friction_nm: friction behind the transmission, positive while the link turns forwards.
    """

    motor_deg: Floats
    link_deg: Floats
    hold_nm: Floats
    friction_nm: Floats


class Drivetrains:
    """Transmissions of n joints.

    Args:
        truths: a joint each; copies of one joint are several of its trials.
    """

    def __init__(self, truths: Sequence[JointTruth]) -> None:
        self._stiffness = _column(truths, "stiffness_nm_per_deg")
        self._half_play = _column(truths, "play_deg") / 2.0
        self._engagement = _column(truths, "engagement_nm")
        self._friction = _column(truths, "link_friction_nm")
        self._waviness = _column(truths, "friction_waviness")
        self._phases = np.deg2rad([truth.friction_phases_deg for truth in truths]).T
        self._presliding = _column(truths, "presliding_deg")
        self._creep = _column(truths, "creep")
        self._creep_s = _column(truths, "creep_s")

    def twist_deg(self, torque_nm: Floats) -> Floats:
        """Return how far the motor is ahead of the link under a torque."""
        play_deg = self._half_play * np.tanh(torque_nm / self._engagement)
        twist: Floats = torque_nm / self._stiffness + play_deg
        return twist

    def at_rest(self, motor_deg: Floats, hold_nm: Floats) -> Drive:
        """Return drives that rest without friction."""
        return Drive(motor_deg, motor_deg - self.twist_deg(hold_nm), hold_nm, np.zeros_like(motor_deg))

    def wavy(self, link_deg: Floats) -> Floats:
        """Return the friction at places as a part of its mean."""
        turns = np.deg2rad(link_deg)
        waves = [np.sin(count * turns + phase) for count, phase in zip(_WAVES, self._phases, strict=True)]
        wavy: Floats = 1.0 + self._waviness * np.sum(waves, axis=0)
        return wavy

    def driven(self, start: Drive, motor_deg: Floats, hold_nm: Floats) -> Drive:
        """Return drives after a way in one direction.

        Args:
            start: where it begins.
            motor_deg: where the motors stand, shape (n,) or (m, n).
            hold_nm: what holds the links there, same shape.
        """
        slack_deg = motor_deg - start.link_deg - self.twist_deg(hold_nm + start.friction_nm)
        sense = np.where(slack_deg < 0.0, -1.0, 1.0)
        most_nm = sense * self._friction * self.wavy(start.link_deg)

        def friction(link_deg: Floats) -> Floats:
            slid = np.maximum(sense * (link_deg - start.link_deg), 0.0)
            grown: Floats = most_nm + (start.friction_nm - most_nm) * np.exp(-slid / self._presliding)
            return grown

        ends = [motor_deg - self.twist_deg(hold_nm + force) for force in (start.friction_nm, most_nm)]
        low, high = np.minimum(*ends), np.maximum(*ends)
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            ahead: Bools = middle + self.twist_deg(hold_nm + friction(middle)) > motor_deg
            low, high = np.where(ahead, low, middle), np.where(ahead, middle, high)
        return Drive(motor_deg, middle, hold_nm, friction(middle))

    def rested(self, start: Drive, rest_s: Floats) -> Drive:
        """Return drives after a rest: friction creeps, and the torsion that it held turns the links on.

        Args:
            start: when they came to rest.
            rest_s: how long, shape (n,) or (m, n).
        """
        left = 0.5 * (np.exp(-rest_s / self._creep_s) + np.exp(-rest_s / (_SLOW * self._creep_s)))
        friction_nm = start.friction_nm * (1.0 - self._creep * (1.0 - left))
        link_deg = start.motor_deg - self.twist_deg(start.hold_nm + friction_nm)
        return Drive(start.motor_deg + 0.0 * rest_s, link_deg, start.hold_nm + 0.0 * rest_s, friction_nm)


def _column(truths: Sequence[JointTruth], name: str) -> Floats:
    return np.array([getattr(truth, name) for truth in truths], dtype=np.float64)
