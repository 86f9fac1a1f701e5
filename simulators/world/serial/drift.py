"""Slow motion of what stands in the room."""

import numpy as np

from catseye.simulators.world.serial.frames import frames_of
from catseye.simulators.world.serial.optics import Wander
from catseye.simulators.world.types import Floats

_PERIODS_S = (3600.0, 8.0 * 3600.0)


class Drift:
    """Slow displacement and rotation of what stands in the room, 0 at bench time 0.

    Args:
        rms_um: of each coordinate.
        rms_urad: of each angle.
    """

    def __init__(self, rng: np.random.Generator, rms_um: float, rms_urad: float) -> None:
        self._waves = [
            Wander(rng, rms, _PERIODS_S) for rms in (*(1e-3 * rms_um,) * 3, *(1e-6 * rms_urad,) * 3)
        ]
        self._first = np.array([wave.at(np.zeros(1))[0] for wave in self._waves])

    def at(self, times_s: Floats) -> Floats:
        """Return it as frames at bench times, shape (m, 4, 4)."""
        moved = np.stack([wave.at(times_s) for wave in self._waves], axis=-1) - self._first
        return frames_of(moved[:, :3], moved[:, 3:])
