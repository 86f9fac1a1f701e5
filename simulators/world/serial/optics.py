"""Retroreflectors on a serial arm in the beam of an interferometer on a tripod: what they return, and how long it is.

The angular one carries two prisms. Turned by θ about the axis that beam and prisms are square to, it makes one of two
beams longer by S sin θ (resolution paper, section 2.2); about any other axis it does not. Both kinds lose the beam as
they shift across it or turn out of it.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from catseye.simulators.config import ArmOptics
from catseye.simulators.world.types import Floats

Kind = Literal["angular", "linear"]


@dataclass(frozen=True)
class Mounting:
    """A retroreflector, fastened to a frame of the arm, and the beam that was led to it.

    Attributes:
        kind: what it measures.
        frame: number of the joint that carries it, from 1.
        beam: direction of the beam, away from the laser, in the base.
        axis: axis about which an angular one is to turn; across the beam.
        home: frame of the joint when it was mounted, shape (4, 4).
        place_mm: of the retroreflector's centre in that frame, with a last 1, shape (4,).
    """

    kind: Kind
    frame: int
    beam: Floats
    axis: Floats
    home: Floats
    place_mm: Floats

    @cached_property
    def across(self) -> Floats:
        """Direction from one prism to the other when it was mounted."""
        return np.cross(self.beam, self.axis)


@dataclass(frozen=True)
class Return:
    """What comes back from a retroreflector, shape (m,) each.

    Attributes:
        length_mm: change of the measured length, from the dead path of a linear retroreflector on.
        miss: 0 for a full signal, 1 where it is lost.
    """

    length_mm: Floats
    miss: Floats


def mount_angular(
    frame: int, home: Floats, axis: Floats, axis_point_mm: Floats, lever_mm: float, offset_mm: float
) -> Mounting:
    """Return an angular retroreflector beside the axis of a joint, with a level beam where the axis allows one.

    Args:
        frame: number of the joint.
        home: its frame.
        axis: its direction.
        axis_point_mm: a point on it.
        lever_mm: distance of the retroreflector's centre from the axis, across the beam.
        offset_mm: of that centre along the beam; at 0 it stands, as it should (section 2.2), in the plane through the
            axis that is square to the beam.
    """
    beam = _square_to(axis)
    across = np.cross(beam, axis)
    centre = axis_point_mm + lever_mm * across + offset_mm * beam
    return Mounting("angular", frame, beam, axis, home, np.linalg.solve(home, np.append(centre, 1.0)))


def mount_linear(frame: int, home: Floats, direction: Floats, place_mm: Floats) -> Mounting:
    """Return a linear retroreflector at a place in a joint's frame, with a beam along a direction of the base."""
    return Mounting("linear", frame, direction, _square_to(direction), home, np.append(place_mm, 1.0))


def returned(
    mounting: Mounting, frames: Floats, tilts_rad: Floats, spacing_mm: float, optics: ArmOptics
) -> Return:
    """Return what comes back from a retroreflector.

    Args:
        frames: of the joint that carries it, shape (m, 4, 4).
        tilts_rad: of the beam, about the across direction and about the axis, shape (2,).
        spacing_mm: true distance of the prisms.
    """
    aslant = mounting.beam + tilts_rad[0] * mounting.axis + tilts_rad[1] * mounting.across
    beam = aslant / np.linalg.norm(aslant)
    moved_mm = (frames @ mounting.place_mm - mounting.home @ mounting.place_mm)[:, :3]
    turns = frames[:, :3, :3] @ mounting.home[:3, :3].T
    if mounting.kind == "angular":
        length_mm = spacing_mm * (turns @ mounting.across) @ beam
    else:
        length_mm = optics.distance_mm + moved_mm @ beam
    shift_mm = np.linalg.norm(moved_mm - np.outer(moved_mm @ beam, beam), axis=1)
    cosine = np.clip((np.trace(turns, axis1=1, axis2=2) - 1.0) / 2.0, -1.0, 1.0)
    parts = (
        shift_mm / optics.shift_limit_mm,
        np.rad2deg(np.arccos(cosine)) / optics.angle_limit_deg,
        np.full(len(frames), 1e3 * np.linalg.norm(tilts_rad) / optics.tilt_limit_mrad),
    )
    return Return(length_mm, np.linalg.norm(parts, axis=0))


class Wander:
    """A random function of bench time: waves with periods spread evenly on a logarithmic scale.

    Args:
        rms: its rms, in any unit.
        periods_s: shortest and longest.
    """

    def __init__(self, rng: np.random.Generator, rms: float, periods_s: tuple[float, float]) -> None:
        count = 12
        low, high = np.log(periods_s)
        self._rates = 2.0 * np.pi / np.exp(rng.uniform(low, high, count))
        self._phases = rng.uniform(0.0, 2.0 * np.pi, count)
        self._amplitude = rms * np.sqrt(2.0 / count)

    def at(self, times_s: Floats) -> Floats:
        """Return its values at bench times, same shape."""
        waves = np.sin(times_s[..., None] * self._rates + self._phases)
        total: Floats = waves.sum(axis=-1) * self._amplitude
        return total


def _square_to(direction: Floats) -> Floats:
    """Return a direction across another one, level where that is possible."""
    up, forwards = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    upright = bool(np.abs(direction @ up) > 0.99)
    square = forwards - (forwards @ direction) * direction if upright else np.cross(up, direction)
    found: Floats = square / np.linalg.norm(square)
    return found
