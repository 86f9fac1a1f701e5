"""The beam from the arm to the reflectors: who is hit, how far, what blocks it."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from catseye.simulators.config import EmulationConfig
from catseye.simulators.world.arm import BeamPoses
from catseye.simulators.world.beam_path import BeamPath
from catseye.simulators.world.mount import Mount
from catseye.simulators.world.types import Bools, Floats, Ints, Plane

Reflectors = Mapping[str, tuple[float, float]]
"""True places of the reflectors' centres by name, (x, y), mm."""

NOBODY = -1
"""Index of the reflector when no beam returns."""

_FAR_MM = 1e9
"""Stands for the miss of a reflector behind the beam, among those in place."""


@dataclass(frozen=True)
class Sight:
    """What the beam meets at several bench times, shape (n,) each.

    Attributes:
        time_s: bench times, s.
        index: reflector that returns the beam, NOBODY without a return.
        length_mm: projection of the way from the start of the beam to that reflector on the beam, mm; of the
            nearest reflector ahead that is in place, by miss, without a return.
        miss_mm: distance of that reflector's centre from the beam's line, mm.
        nearest: index of that reflector.
    """

    time_s: Floats
    index: Ints
    length_mm: Floats
    miss_mm: Floats
    nearest: Ints

    def last(self) -> "Sight":
        """Return the last look alone, shape (1,)."""
        return Sight(
            self.time_s[-1:], self.index[-1:], self.length_mm[-1:], self.miss_mm[-1:], self.nearest[-1:]
        )


class Optics:
    """Reflectors in their nests, base column and faults in the way of the beam.

    The beam leaves at the angle of the arm's last axis and of the mount on it; it starts beside that axis by a
    lateral offset and rises by its pitch; its length is
    measured along the beam, so the cosine errors of miss and pitch are in it. A reflector returns the beam when
    it is in place, the miss is within its acceptance, it lies ahead, the beam comes within its field, and
    neither the column nor a fault stands between. The acceptance is that of a full signal; it shrinks with what
    dirt leaves of it, since the level at its edge, exp(-2), is the least that a counter counts with.

    Args:
        start_height_mm: height of the arm at bench time 0.

    Attributes:
        mount: how the beam lies.
        path: what stands in its way.
    """

    def __init__(self, reflectors: Reflectors, config: EmulationConfig, start_height_mm: float) -> None:
        self.names = list(reflectors)
        self._nests = np.array([complex(*place_mm) for place_mm in reflectors.values()])
        self._centres = self._nests.copy()
        self._in_place = np.ones(len(self.names), dtype=np.bool_)
        self._in_place[1:] = not config.one_reflector
        self._nest_mm = config.nest_um * 1e-3
        self._placings = np.random.default_rng([config.seed, 14])
        facing_deg = {place.name: place.facing_deg for place in config.reflectors}
        self._facing = np.array(
            [
                _facing(facing_deg.get(name), centre)
                for name, centre in zip(self.names, self._centres, strict=True)
            ]
        )
        self._acceptance_mm = config.acceptance_mm
        self._least_cosine = np.cos(np.deg2rad(config.field_half_angle_deg))
        self._column_radius_mm = config.column_radius_mm
        self.mount = Mount(config, start_height_mm)
        self.path = BeamPath()

    @property
    def in_place(self) -> list[str]:
        """Names of the nests with a reflector in them."""
        return [name for name, here in zip(self.names, self._in_place, strict=True) if here]

    def move_reflector(self, name: str, shift_mm: complex) -> None:
        """Shift a reflector's nest, and the reflector in it.

        Raises:
            KeyError: there is no reflector of that name.
        """
        if name not in self.names:
            raise KeyError(name)
        self._nests[self.names.index(name)] += shift_mm
        self._centres[self.names.index(name)] += shift_mm

    def remove_all_but(self, names: Collection[str]) -> None:
        """Take the reflectors out of all other nests."""
        self._in_place &= np.isin(self.names, list(names))

    def put(self, names: Collection[str]) -> None:
        """Put reflectors into nests; one that is in place already stays as it sits."""
        for k, name in enumerate(self.names):
            if name in names and not self._in_place[k]:
                x, y = self._placings.standard_normal(2)
                self._centres[k] = self._nests[k] + complex(x, y) * self._nest_mm
                self._in_place[k] = True

    def look(self, poses: BeamPoses) -> Sight:
        """Return what the beam meets in each pose."""
        mount = self.mount
        beam = np.exp(1j * (poses.beam_rad + mount.turn_rad))
        origin = poses.axis_mm + 1j * mount.offset_mm * beam
        relative = (self._centres - origin[:, None]) * np.conj(beam)[:, None]
        along = relative.real
        lift = (poses.height_mm - mount.height_mm)[:, None]
        rise, run = math.sin(mount.pitch_rad), math.cos(mount.pitch_rad)
        length = along * run - lift * rise - mount.ahead_mm
        miss = np.hypot(relative.imag, along * rise + lift * run)
        returns = (miss <= self._reach_mm()) & (along > 0.0) & self._in_place
        if returns.any():
            returns &= self._in_field(beam) & ~self._behind_column(origin, beam, along)
            returns[self.path.blocked(poses.time_s)] = False
        candidates = np.where(along > 0.0, miss, _FAR_MM)
        candidates[:, ~self._in_place] = np.inf
        return _choose(poses, returns, length, miss, candidates)

    def level(self, miss_mm: float) -> float:
        """Return the signal level, 0...1, of a beam that returns with a miss."""
        return float(self.path.clearness * np.exp(-2.0 * (miss_mm / self._acceptance_mm) ** 2))

    def _reach_mm(self) -> float:
        """Return the largest miss at which the level is that of the acceptance's edge; below 0 for none."""
        left = 1.0 + math.log(self.path.clearness) / 2.0 if self.path.clearness > 0.0 else -math.inf
        return self._acceptance_mm * math.sqrt(left) if left >= 0.0 else -1.0

    def _in_field(self, beam: Plane) -> Bools:
        back: Bools = (-beam[:, None] * np.conj(self._facing)).real >= self._least_cosine
        return back

    def _behind_column(self, origin: Plane, beam: Plane, along: Floats) -> Bools:
        nearest = np.clip(-(origin * np.conj(beam)).real[:, None], 0.0, along)
        behind: Bools = np.abs(origin[:, None] + nearest * beam[:, None]) < self._column_radius_mm
        return behind


def _facing(facing_deg: float | None, centre: complex) -> complex:
    if facing_deg is None:
        return -centre / abs(centre) if centre else 1.0 + 0.0j
    return complex(np.exp(1j * np.deg2rad(facing_deg)))


def _choose(poses: BeamPoses, returns: Bools, length: Floats, miss: Floats, candidates: Floats) -> Sight:
    hit: Bools = np.any(returns, axis=1)
    # Of several reflectors in the beam the first one stops it; without any, the nearest miss is of interest.
    rank = np.where(hit[:, None], np.where(returns, length, np.inf), candidates)
    best = rank.argmin(axis=1)
    rows = np.arange(best.size)
    seen = length[rows, best] + poses.white_mm
    return Sight(poses.time_s, np.where(hit, best, NOBODY), seen, miss[rows, best], best)
