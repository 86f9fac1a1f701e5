"""Tool and base: where the tool's end is, in the coordinates that TOOL and BASE have chosen (sheet, section 1.9).

A hand of this arm turns about the vertical only: A and B of tool and base do not exist, and Z of a tool counts
upwards, both as in positions of the arm.
"""

from dataclasses import replace

import numpy as np

from catseye.simulators.melfa.values import Position
from catseye.simulators.world.types import Floats

NONE = Position(0.0, 0.0, 0.0, 0.0, 0)
"""Of P_NTOOL and P_NBASE: no tool, no base."""


class Frames:
    """What lies between the flange in the arm's own coordinates and the positions that clients see.

    Args:
        base_places_world: the base's data are the world's place in the arm's coordinates; otherwise they are
            the arm's place in the world.

    Attributes:
        tool: end of the tool, seen from the flange.
        base: data of the last BASE.
    """

    def __init__(self, *, base_places_world: bool) -> None:
        self._base_places_world = base_places_world
        self.tool = NONE
        self.base = NONE

    def seen(self, flange: Position) -> Position:
        """Return where the tool's end is when the flange is there."""
        x_mm, y_mm, z_mm, c_deg = _chained(self._arm, _row(flange), _row(self.tool)).tolist()
        c_deg = 180.0 - (180.0 - c_deg) % 360.0
        return replace(flange, x_mm=x_mm, y_mm=y_mm, z_mm=z_mm, c_deg=c_deg)

    def flange(self, tool: Position) -> Position:
        """Return where the flange has to be for the tool's end to be there."""
        x_mm, y_mm, z_mm, c_deg = self.flanges(_row(tool)).tolist()
        return replace(tool, x_mm=x_mm, y_mm=y_mm, z_mm=z_mm, c_deg=c_deg)

    def flanges(self, tools: Floats) -> Floats:
        """Return the same for rows x, y, z in mm and direction in deg, shape (…, 4)."""
        return _chained(_reversed(self._arm), tools, _reversed(_row(self.tool)))

    @property
    def _arm(self) -> Floats:
        """Place of the arm's coordinates in the world."""
        base = _row(self.base)
        return _reversed(base) if self._base_places_world else base


def _row(position: Position) -> Floats:
    return np.array([position.x_mm, position.y_mm, position.z_mm, position.c_deg])


def _chained(*steps: Floats) -> Floats:
    """Return the place that successive steps lead to, each seen from the one before."""
    reached, *others = steps
    for step in others:
        spot = reached[..., :3] + _turned(step, reached[..., 3])
        reached = np.concatenate([spot, reached[..., 3:] + step[..., 3:]], axis=-1)
    return reached


def _reversed(step: Floats) -> Floats:
    back = np.concatenate([-step[..., :3], -step[..., 3:]], axis=-1)
    return np.concatenate([_turned(back, -step[..., 3]), back[..., 3:]], axis=-1)


def _turned(step: Floats, by_deg: Floats) -> Floats:
    cosine, sine = np.cos(np.deg2rad(by_deg)), np.sin(np.deg2rad(by_deg))
    x_mm, y_mm, z_mm = (step[..., n] for n in range(3))
    ahead, beside = cosine * x_mm - sine * y_mm, sine * x_mm + cosine * y_mm
    return np.stack(np.broadcast_arrays(ahead, beside, z_mm), axis=-1)
