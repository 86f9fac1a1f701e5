"""A laser tracker beside the bench: an independent instrument with a frame of its own."""

import cmath

import numpy as np

TRACKER_U_MM = 0.0075
"""Standard uncertainty of a coordinate, mm: half of the 15 µm that an AT960-XR is specified with."""


class Tracker:
    """Measures positions with noise, in its own frame."""

    def __init__(self, seed: int) -> None:
        self._noise = np.random.default_rng([seed, 9])
        turn_deg, x_mm, y_mm = self._noise.normal(0.0, (2.0, 300.0, 300.0))
        self._turn = cmath.exp(1j * float(np.deg2rad(turn_deg)))
        self._shift_mm = complex(x_mm, y_mm)
        self.u_mm = TRACKER_U_MM

    def measure(self, xy_mm: tuple[float, float]) -> tuple[float, float]:
        """Return the coordinates of a place in the robot's frame, as the tracker sees it, mm."""
        noise_x, noise_y = self._noise.normal(0.0, self.u_mm, 2)
        seen = self._turn * complex(*xy_mm) + self._shift_mm + complex(noise_x, noise_y)
        return seen.real, seen.imag
