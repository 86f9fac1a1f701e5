"""Errors of one axis: its angular positioning deviation with play, and its radial error motion."""

from dataclasses import dataclass

import numpy as np

from catseye.simulators.world.types import Floats, Plane

_TO_RAD = np.pi / 180.0


@dataclass(frozen=True)
class JointMap:
    """Angular positioning deviation of one joint at nodes, for both directions of approach.

    Attributes:
        nodes_rad: command angles of the nodes, rad, strictly increasing, shape (m,).
        positive_rad: deviation (actual minus command) when approached upwards, rad, shape (m,).
        negative_rad: the same when approached downwards, rad, shape (m,).

    Raises:
        ValueError: the lengths differ, or the nodes do not increase.
    """

    nodes_rad: Floats
    positive_rad: Floats
    negative_rad: Floats

    def __post_init__(self) -> None:
        sizes = {self.nodes_rad.shape, self.positive_rad.shape, self.negative_rad.shape}
        if len(sizes) != 1 or self.nodes_rad.ndim != 1 or self.nodes_rad.size == 0:
            raise ValueError("nodes and both tables need one and the same length, at least 1")
        if not np.all(np.diff(self.nodes_rad) > 0.0):
            raise ValueError("nodes must increase strictly")


class FlankTable:
    """Deviation of one joint for every state of its play.

    The deviation is mid + q half: q = 1 is the table of positive approach, q = -1 that of negative approach.
    Angles are command angles in deg; outside its nodes the table is held constant.
    """

    def __init__(self, table: JointMap) -> None:
        mid = (table.positive_rad + table.negative_rad) / 2.0
        half = (table.positive_rad - table.negative_rad) / 2.0
        self._nodes_deg = np.rad2deg(table.nodes_rad)
        self._tables = mid + 1j * half
        self._half_rad = half

    def deviation_rad(self, theta_deg: Floats, play: Floats) -> Floats:
        """Return the deviations, rad, for command angles and states of the play (-1...1)."""
        both = np.interp(theta_deg, self._nodes_deg, self._tables)
        deviation: Floats = both.real + play * both.imag
        return deviation

    def width_deg(self, theta_deg: Floats) -> Floats:
        """Return the distances between the two tables at command angles, deg."""
        half = np.interp(theta_deg, self._nodes_deg, self._half_rad)
        width: Floats = np.abs(half) * (2.0 / _TO_RAD)
        return width


_CURVE_DEG = np.linspace(0.0, 360.0, 721)
_ORDERS = np.arange(1, 6)
_TURNS = np.exp(1j * _ORDERS[:, None] * np.deg2rad(_CURVE_DEG))


class RadialError:
    """Radial error motion of one axis: a smooth closed curve over a turn, harmonics 1 to 5.

    What turns with the axis once a turn is none of it but an eccentricity: links, tables and the beam's origin are
    those of the mean axis. The first harmonic goes round the other way, twice a turn as the link sees it.

    Args:
        rms_um: rms of x and of y over a turn.
    """

    def __init__(self, rng: np.random.Generator, rms_um: float) -> None:
        weights = rng.uniform(0.5, 1.0, _ORDERS.size) / _ORDERS
        weights *= rms_um * 1e-3 * np.sqrt(2.0) / np.linalg.norm(weights)
        phases = rng.uniform(0.0, 2.0 * np.pi, (2, _ORDERS.size))
        phases[1, 0] = phases[0, 0] + 0.5 * np.pi
        x_mm, y_mm = ((weights * np.exp(1j * phases)) @ _TURNS).imag
        self._curve_mm = x_mm + 1j * y_mm

    def shift_mm(self, theta_deg: Floats) -> Plane:
        """Return the shifts, mm, at command angles in deg."""
        shift: Plane = np.interp(theta_deg % 360.0, _CURVE_DEG, self._curve_mm).astype(np.complex128)
        return shift
