"""Harmonics that a fit leaves: amplitude, uncertainty and false-alarm probability of each order, and its aliases."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.arguments import require_count
from catseye.calibration.core.projection import Addition, additions
from catseye.calibration.core.significance import Judged, adjusted
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.scara.diagnostics.projection import DistanceProjection, angles_rad, mounts_rad
from catseye.calibration.scara.extension import Source, Target

_AT_ONCE = 20
"""Orders that are projected together: more of them take more memory, fewer more time."""

_MOST_ANGLES = 1000
"""So many different angles, evenly chosen, distinguish all orders that are looked at."""

_SAME = 1.0 - 1e-9
"""Two orders whose waves at the commands correlate more than this are one."""

SERIES: tuple[tuple[Target, Source], ...] = (
    ("theta1", "theta1"),
    ("theta2", "theta2"),
    ("theta1", "theta2"),
    ("theta2", "theta1"),
    ("length", "theta4"),
)
"""What may vary with which angle: each joint with its own, with the other's, the distance with the beam's."""


@dataclass(frozen=True)
class Harmonic(Judged):
    """One order of one series.

    Attributes:
        target: what varies: a joint's angle or the distance.
        source: angle that it varies with.
        order: multiple of the angle.
        aliases: higher orders that take the same values at the commands.
        amplitude: rad for a joint, mm for the distance.
        u: standard uncertainty of each of both parts, along the wave found.
        explained_um: standard deviation of a distance that it would explain, µm.
        probability: that chance alone gives an order this clear among all that were looked at.
    """

    target: Target
    source: Source
    order: int
    aliases: tuple[int, ...]
    amplitude: float
    u: float
    explained_um: float
    probability: float


@dataclass(frozen=True)
class HarmonicSeries:
    """All orders of one series.

    Attributes:
        target: what varies.
        source: angle that it varies with.
        harmonics: orders that the model leaves, ascending.
        absorbed: orders that the model takes up at these commands, so that nothing can be said of them.
    """

    target: Target
    source: Source
    harmonics: tuple[Harmonic, ...]
    absorbed: tuple[int, ...]


def harmonic_series(
    projection: DistanceProjection, nominal_mm: tuple[float, float], reflectors_mm: Floats, orders: int = 120
) -> list[HarmonicSeries]:
    """Return orders 1 … `orders` of every series; of orders that are one at the commands the lowest stands for all.

    Args:
        projection: the fit, on the space that its model cannot reach.
        nominal_mm: nominal links, mm.
        reflectors_mm: places that the beam was aimed at, mm, shape (reflectors, 2).
    """
    require_count(orders, "orders")
    angles = angles_rad(projection.points, nominal_mm, reflectors_mm)
    found = [_series(projection, target, source, angles[source], orders) for target, source in SERIES]
    tests = sum(len(one.harmonics) for one in found)
    return [replace(one, harmonics=tuple(_corrected(h, tests) for h in one.harmonics)) for one in found]


def _corrected(one: Harmonic, tests: int) -> Harmonic:
    return replace(one, probability=adjusted(one.probability, tests))


def _series(
    projection: DistanceProjection, target: Target, source: Source, angle_rad: Floats, orders: int
) -> HarmonicSeries:
    gain = projection.geometry.turn_mm
    factor = {"theta1": gain[:, 0], "theta2": gain[:, 1]}.get(target, np.cos(mounts_rad(projection.points)))
    harmonics, absorbed = [], []
    # Turned half a turn, the interferometer sees the other side of what J4's axis does.
    # A distance owes its first order of θ4 to dead path, L2 and the mean of the J2 map: nothing of it is left.
    groups = aliased_orders(angle_rad, range(2 if target == "length" else 1, orders + 1))
    for first in range(0, len(groups), _AT_ONCE):
        some = groups[first : first + _AT_ONCE]
        columns = factor[:, None] * np.hstack([_wave(angle_rad, order) for order, _ in some])
        for (order, aliases), found in zip(some, additions(projection, columns, 2), strict=True):
            if found is None:
                absorbed += [order, *aliases]
            else:
                harmonics.append(_harmonic(found, (target, source), (order, aliases)))
    return HarmonicSeries(target, source, tuple(harmonics), tuple(sorted(absorbed)))


def _harmonic(found: Addition, series: tuple[Target, Source], order: tuple[int, tuple[int, ...]]) -> Harmonic:
    amplitude = float(np.hypot(*found.coefficients))
    along = found.coefficients / amplitude if amplitude > 0.0 else np.array([1.0, 0.0])
    return Harmonic(
        *series,
        *order,
        amplitude=amplitude,
        u=float(np.sqrt(along @ found.covariance @ along)),
        explained_um=found.explained_um,
        probability=found.probability,
    )


def _wave(angle_rad: Floats, order: int) -> Floats:
    wave = np.column_stack([np.cos(order * angle_rad), np.sin(order * angle_rad)])
    wave[np.abs(wave) < 1e-11] = 0.0
    return wave


def aliased_orders(angle_rad: Floats, orders: Sequence[int]) -> list[tuple[int, tuple[int, ...]]]:
    """Return orders that differ at the commands, each with those that take the same values there.

    Args:
        angle_rad: command angles, rad, shape (n,).
        orders: to distinguish, ascending.

    Returns:
        The lowest order of each group and its aliases; an order that is constant at the commands is none.
    """
    distinct = angle_rad[np.unique(np.round(angle_rad, 9), return_index=True)[1]]
    distinct = distinct[:: -(-distinct.size // _MOST_ANGLES)]
    bases = [_basis(distinct, order) for order in orders]
    groups: list[tuple[int, Floats, list[int]]] = []
    for order, basis in zip(orders, bases, strict=True):
        if basis.shape[1] == 0:
            continue
        known = next((group for group in groups if _same(group[1], basis)), None)
        if known is None:
            groups.append((order, basis, []))
        else:
            known[2].append(order)
    return [(order, tuple(aliases)) for order, _, aliases in groups]


def _basis(angle_rad: Floats, order: int) -> Floats:
    """Return an orthonormal basis of what an order adds to a constant, shape (angles, 0…2)."""
    wave = _wave(angle_rad, order)
    centred = wave - wave.mean(axis=0)
    left, values, _ = np.linalg.svd(centred, full_matrices=False)
    known: Bools = values > 1e-8 * np.sqrt(angle_rad.size)
    return np.asarray(left[:, known], dtype=np.float64)


def _same(one: Floats, other: Floats) -> bool:
    if one.shape[1] != other.shape[1]:
        return False
    return bool(np.linalg.svd(one.T @ other, compute_uv=False)[-1] > _SAME)
