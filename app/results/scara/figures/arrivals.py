"""Repeated arrivals at poses from above: what each beam sees of them, and the ellipse that follows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.app.results.figures import Axis, Figure, Level, Mark, Panel, Points, Role, Shape, columns
from catseye.calibration.core.types import Floats

_ACROSS: Final = 3
"""Panels in a row."""

_COVERAGE: Final = 3.0
"""Half axes of the ellipse, in standard deviations: as RP has them."""


@dataclass(frozen=True)
class Seen:
    """Arrivals at a pose along one beam.

    Attributes:
        pose: number of the pose.
        reflector: name of the reflector.
        direction_rad: of the beam, from the pose to the reflector.
        longer_um: distance of each arrival less their mean, shape (n,).
    """

    pose: int
    reflector: str
    direction_rad: float
    longer_um: Floats

    @property
    def place_um(self) -> Floats:
        """Where the arm stood along the beam: a longer distance is farther from the reflector, shape (n, 2)."""
        beam = np.array([np.cos(self.direction_rad), np.sin(self.direction_rad)])
        return np.asarray(-self.longer_um[:, None] * beam, dtype=np.float64)


def arrivals_from_above(seen: Sequence[Seen], covariance_um2: Mapping[int, Floats]) -> Figure:
    """Return a panel for each pose.

    Args:
        covariance_um2: of the position by pose, shape (2, 2); what is missing is not known.
    """
    names = list(dict.fromkeys(one.reflector for one in seen))
    poses = sorted({one.pose for one in seen})
    largest = max(float(np.abs(one.longer_um).max()) for one in seen)
    shapes = {pose: _ellipse(covariance) for pose, covariance in covariance_um2.items()}
    reach = 1.1 * max([largest, *(max(one.half) for one in shapes.values()), 1e-3])
    panels: list[Panel | None] = [_panel(pose, seen, names, shapes.get(pose), reach) for pose in poses]
    panels += [None] * (-len(panels) % min(_ACROSS, len(panels)))
    across = min(_ACROSS, len(panels))
    rows = tuple(tuple(panels[first : first + across]) for first in range(0, len(panels), across))
    caption = (
        "Arrivals from above, less their mean: a beam sees what lies along it, and the beams were measured one after "
        "the other, so each arrival is a point on the line of its beam. Dashed: three standard deviations in the "
        "plane, where they are known."
    )
    return Figure("arrivals-plane", "Arrivals from above", caption, rows, aspect=0.42 * len(rows))


def _panel(
    pose: int, seen: Sequence[Seen], names: Sequence[str], ellipse: Shape | None, reach: float
) -> Panel:
    marks: list[Mark] = [Level(0.0, Role.AXIS), Level(0.0, Role.AXIS, vertical=True)]
    marks += [] if ellipse is None else [ellipse]
    marks += [
        Points(*columns(one.place_um), names.index(one.reflector), f"to {one.reflector}", size=3.5, each=True)
        for one in seen
        if one.pose == pose
    ]
    x, y = (Axis(f"{name} / µm", low=-reach, high=reach) for name in "xy")
    return Panel(f"pose {pose}", x, y, tuple(marks), equal=True)


def _ellipse(covariance_um2: Floats) -> Shape:
    values, vectors = np.linalg.eigh(covariance_um2)
    one, two = (_COVERAGE * float(np.sqrt(max(value, 0.0))) for value in values)
    turn_deg = float(np.rad2deg(np.arctan2(vectors[1, 0], vectors[0, 0])))
    return Shape((0.0, 0.0), (one, two), Role.EXPECTED, "3 S in the plane", dashed=True, turn_deg=turn_deg)
