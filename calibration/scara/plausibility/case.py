"""Distances with what was known of the arm before: what is judged, corrected and solved again."""

from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.points import Points

Free = Literal["scale", "links"]
"""What nothing was known of: the scale of the displacements, the lengths of the links."""

MOST_ROWS: Final = 1500
"""More distances say no more about a mistake."""

MANY_ROWS: Final = 20_000
"""A jump has to leave some distances on either side of it."""

FEW_ROWS: Final = 500
"""More distances say no more about a wrong guess or another solution."""

_SIGMA_MM: Final = 0.02
"""Standard uncertainty of distances that state none, or less; only its ratio to the bounds counts."""

_DISTRUSTED_MM: Final = 100.0
"""Standard uncertainty of distances that are not to move an arm far."""

_SEED: Final = 1

_EXACT: Final = 1e-9


@dataclass(frozen=True)
class Case:
    """Distances, and what was known of the arm and the reflectors before.

    Attributes:
        points: n distances.
        nodes_rad: nodes of both maps; empty for a mere offset of J2.
        links_mm: nominal lengths.
        places_mm: rough places of points.reflector_names, mm, shape (reflectors, 2).
        free: what nothing was known of.
        rows: which of all distances they are, from 0, shape (n,); None for all of them.
    """

    points: Points
    nodes_rad: tuple[Floats, Floats]
    links_mm: tuple[float, float]
    places_mm: Floats
    free: Free | None = None
    rows: Ints | None = None

    def number(self, row: int) -> int:
        """Return which of all distances a row is, from 0."""
        return row if self.rows is None else int(self.rows[row])

    @property
    def weights(self) -> Floats:
        """Reciprocal standard uncertainties, 1/mm, shape (n,).

        Distances that claim to be better than any arm is known would outweigh what is known of it.
        """
        sigma = self.points.sigma_mm
        return 1.0 / np.maximum(_SIGMA_MM, np.zeros(len(self.points)) if sigma is None else sigma)

    @property
    def without_maps(self) -> "Case":
        """The same with links, an offset of J2 and reflectors only: few unknowns, soon solved."""
        return replace(self, nodes_rad=(np.zeros(0), np.zeros(0)))

    @property
    def distrusted(self) -> "Case":
        """The same with distances so uncertain that the arm stays near what was known of it."""
        sigma = np.full(len(self.points), _DISTRUSTED_MM)
        return replace(self, points=replace(self.points, sigma_mm=sigma))

    def thinned(self, most: int) -> "Case":
        """Return the case of some of the distances, in measuring order."""
        size = len(self.points)
        if size <= most:
            return self
        # At random: every k-th row may be one and the same node of a grid.
        rows = np.sort(np.random.default_rng(_SEED).choice(size, most, replace=False))
        kept = self.points.rows(rows)
        paths, number = np.unique(kept.dead_path, return_inverse=True)
        kept = replace(
            kept,
            dead_path=number.astype(np.int64),
            dead_paths=tuple(kept.dead_paths[path] for path in paths),
        )
        return replace(self, points=kept, rows=rows if self.rows is None else self.rows[rows])

    def of_points(self, points: Points) -> "Case":
        """Return the case of other distances, with nodes that enclose their commands."""
        commands = points.commands
        nodes = (
            _enclosing(self.nodes_rad[0], commands.theta1_rad),
            _enclosing(self.nodes_rad[1], commands.theta2_rad),
        )
        return replace(self, points=points, nodes_rad=nodes)


def _enclosing(nodes_rad: Floats, angles_rad: Floats) -> Floats:
    """Return nodes that enclose angles: as they are, mirrored, or as many spread evenly; none remain none."""
    if not nodes_rad.size:
        return nodes_rad
    low, high = float(angles_rad.min()), float(angles_rad.max())
    for nodes in (nodes_rad, -nodes_rad[::-1]):
        if nodes[0] - _EXACT <= low and high <= nodes[-1] + _EXACT:
            return nodes
    return np.linspace(low, high + (0.0 if high > low else _EXACT), max(nodes_rad.size, 2))
