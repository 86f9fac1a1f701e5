"""The room of a SCARA as a laser tracker sees it: a retroreflector at the end of the arm, and the column."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Final

import numpy as np

from catseye.simulators.config import EmulationConfig
from catseye.simulators.world.bench import Bench
from catseye.simulators.world.serial.tracker import LaserTracker
from catseye.simulators.world.types import Bools, Floats

ON_THE_ARM: Final = "arm"
"""Nest of the only retroreflector: on the axis of J4."""

_LEVELLED_DEG: Final = 3e-4
"""How well an inclination sensor levels a tracker: an assumption of this emulation, 1 arc second."""


class ScaraRoom:
    """What stands around the tracker; the frame of the room is that of the arm's base.

    Args:
        bench: of the arm.
        config: how thick the column is.
    """

    def __init__(self, bench: Bench, config: EmulationConfig) -> None:
        self._bench = bench
        self._column_mm = config.column_radius_mm

    @property
    def nests(self) -> Mapping[str, object]:
        """The one on the arm; nobody takes its retroreflector away."""
        return MappingProxyType({ON_THE_ARM: None})

    @property
    def standstill_s(self) -> float:
        """Bench time at which the present or last motion of the arm ends, s."""
        return self._bench.standstill_s

    def places_mm(self, names: Iterable[str], times_s: Floats) -> Floats:
        """Return where it really is at bench times, shape (names, m, 3)."""
        return np.array([self._bench.end_mm(times_s) for _ in names])

    def seen(self, name: str, station_mm: Floats, times_s: Floats) -> Bools:
        """Return whether the column leaves the line of sight free at bench times, shape (m,)."""
        (places,) = self.places_mm([name], times_s)
        start, way = station_mm[..., :2], (places - station_mm)[..., :2]
        length2 = np.maximum(np.einsum("mk,mk->m", way, way), np.finfo(np.float64).tiny)
        along = np.clip(-np.einsum("mk,mk->m", start, way) / length2, 0.0, 1.0)
        return np.asarray(np.linalg.norm(start + along[:, None] * way, axis=1) > self._column_mm)


def levelled_tracker(bench: Bench, config: EmulationConfig) -> LaserTracker:
    """Return a tracker beside a SCARA, which somebody has levelled and whose beam follows the arm."""
    survey = replace(config.survey, base_seen=None, leans_deg=_LEVELLED_DEG)
    tracker = LaserTracker(ScaraRoom(bench, config), replace(config, survey=survey), lambda: bench.time_s)
    tracker.lead(ON_THE_ARM)
    return tracker
