"""Encoders on motors, and where servos come to rest."""

from collections.abc import Sequence

import numpy as np

from catseye.simulators.config import SerialJoint
from catseye.simulators.world.serial.truth import JointTruth, column
from catseye.simulators.world.types import Bools, Floats

_CYCLE_S = 0.004
"""A controller reads its encoders once a cycle."""

_GEAR_RATIO = 100.0
_ENCODER_BITS = 17
"""Both are assumptions of this emulation for a joint whose description states none."""


class Encoders:
    """Encoders of n motors; angles are those of the joints.

    Args:
        joints: gear ratios and resolutions.
        truths: a joint each.
        seed: of their noise, which is a function of bench time alone.
    """

    def __init__(self, joints: Sequence[SerialJoint], truths: Sequence[JointTruth], seed: int) -> None:
        self._ratio = np.array([joint.gear_ratio or _GEAR_RATIO for joint in joints])
        bits = np.array([joint.encoder_bits or _ENCODER_BITS for joint in joints])
        self.count_deg = 360.0 / (self._ratio * 2.0**bits)
        self._noise_deg = self.count_deg * column(truths, "encoder_noise_counts")
        self._error_deg = column(truths, "encoder_error_deg")
        self._seed = seed

    def measured_deg(self, motor_deg: Floats, time_s: float) -> Floats:
        """Return what the controller reads in the cycle of a bench time, shape (n,)."""
        measured: Floats = self.counts(motor_deg, time_s) * self.count_deg
        return measured

    def counts(self, motor_deg: Floats, time_s: float) -> Floats:
        """Return the counts of that cycle, whole numbers from the joints' zeros on, shape (n,)."""
        noise = self._noise_deg * self._noise_at(time_s, 0, motor_deg.size)
        counts: Floats = np.round((motor_deg + self.error_deg(motor_deg) + noise) / self.count_deg)
        return counts

    def error_deg(self, motor_deg: Floats) -> Floats:
        """Return by how much they read too much, but for noise and resolution."""
        error: Floats = self._error_deg * np.sin(np.deg2rad(motor_deg * self._ratio))
        return error

    def torque_noise(self, time_s: float) -> Floats:
        """Return what the current sensors of the motors add in that cycle, as a part of their noise, shape (n,)."""
        return self._noise_at(time_s, 1, self._ratio.size)

    def _noise_at(self, time_s: float, kind: int, count: int) -> Floats:
        cycle = round(time_s / _CYCLE_S)
        generator = np.random.Generator(np.random.Philox(key=self._seed, counter=[0, 0, kind, cycle]))
        return generator.standard_normal(count)


class Servos:
    """Position control of n motors.

    Args:
        truths: a joint each.
        encoders: that close the loops.
        seed: of where they come to rest.
    """

    def __init__(self, truths: Sequence[JointTruth], encoders: Encoders, seed: int) -> None:
        self._encoders = encoders
        self._overtravel_deg = column(truths, "overtravel_deg")
        self._stribeck_deg_s = column(truths, "stribeck_deg_s")
        self._scatter_deg = column(truths, "stop_scatter_deg")
        self._window_deg = column(truths, "stop_window_deg")
        self._rng = np.random.default_rng([seed, 21])

    def stops_deg(self, target_deg: Floats, motor_deg: Floats, speed_deg_s: Floats, wavy: Floats) -> Floats:
        """Return where the motors come to rest.

        Static friction that gives way lets a slow motor pass its target; at speed there is none (Stribeck).

        Args:
            target_deg: as commanded, shape (n,).
            motor_deg: where they stand, shape (n,).
            speed_deg_s: largest on the way, shape (n,).
            wavy: friction at the place as a part of its mean, shape (n,).
        """
        way_deg = target_deg - motor_deg - self._encoders.error_deg(motor_deg)
        sticking = np.exp(-((speed_deg_s / self._stribeck_deg_s) ** 2))
        passed = np.sign(way_deg) * self._overtravel_deg * sticking * wavy
        scatter = self._scatter_deg * self._rng.standard_normal(target_deg.size)
        stops = target_deg - self._encoders.error_deg(target_deg) + passed + scatter
        moves: Bools = np.abs(way_deg) > self._window_deg
        return np.where(moves, stops, motor_deg)
