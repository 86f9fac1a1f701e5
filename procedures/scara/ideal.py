"""The beam of an ideal SCARA: which reflector returns it, and by how much it misses on a way.

Geometry of its own: it looks at a plan from outside and would not see the planner's mistakes with the planner's eyes.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.ideal import Hit, IdealBeam, Watched
from catseye.procedures.scara.bench import Reflector, ScaraBench

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class _Sight:
    """The ways from the J4 axis to a reflector, shape (n,) each.

    Attributes:
        x: where the axis is, mm.
        y: where the axis is, mm.
        dx: from there to the reflector, mm.
        dy: from there to the reflector, mm.
        world: direction of the beam, rad.
    """

    x: Floats
    y: Floats
    dx: Floats
    dy: Floats
    world: Floats

    def ahead_mm(self) -> Floats:
        """Return how far ahead the reflector lies, along the beam, mm."""
        return self.dx * np.cos(self.world) + self.dy * np.sin(self.world)

    def column_gap_mm(self) -> Floats:
        """Return how near the line from arm to reflector comes to the J1 axis, mm."""
        squared = np.maximum(self.dx**2 + self.dy**2, 1e-12)
        share = np.clip(-(self.x * self.dx + self.y * self.dy) / squared, 0.0, 1.0)
        return np.hypot(self.x + share * self.dx, self.y + share * self.dy)


class ScaraBeam(IdealBeam):
    """An ideal arm with a beam.

    Args:
        bench: links, optics and places, as well as they are known.
    """

    def __init__(self, bench: ScaraBench) -> None:
        self._bench = bench
        self._reflectors = {reflector.name: reflector for reflector in bench.reflectors}

    @property
    def max_miss_mm(self) -> float:
        """Largest miss that plans allow themselves."""
        return self._bench.optics.max_miss_mm

    @property
    def acceptance_mm(self) -> float:
        """Largest miss at which the cat's eye returns the beam."""
        return self._bench.optics.acceptance_mm

    def hit(self, pose: Pose) -> Hit | None:
        """Return the nearest reflector that returns the beam at a pose."""
        poses = np.array([pose], dtype=np.float64)
        hits = [
            Hit(one.name, float(self._sight(poses, one).ahead_mm()[0]))
            for one in self._bench.reflectors
            if bool(self.returns(poses, one)[0])
        ]
        return min(hits, key=lambda hit: hit.length_mm, default=None)

    def watch(self, poses: Floats, target: str) -> Watched:
        """Return how well the beam keeps to a reflector over poses, shape (n, 4)."""
        reflector = self._reflectors[target]
        kept = bool(self.returns(poses, reflector).all())
        if not np.ptp(poses[:, :2], axis=0).any():
            # Whoever turns J4 alone means to aim beside the reflector, or to find its edge.
            return Watched(kept, None)
        return Watched(kept, float(self.miss_mm(poses, reflector).max()))

    def miss_mm(self, poses: Floats, reflector: Reflector) -> Floats:
        """Return the distance of a reflector's centre from the beam, mm, shape (n,).

        The beam begins at the J4 axis: a reflector behind it is as far away as the axis. It is level, and at the
        reflectors' height where J3 stands as the cell file has it.
        """
        return self._missed_mm(poses, self._sight(poses, reflector))

    def returns(self, poses: Floats, reflector: Reflector) -> Bools:
        """Return at which poses a reflector returns the beam, past the column and inside its field, shape (n,)."""
        optics = self._bench.optics
        sight = self._sight(poses, reflector)
        back_deg = np.rad2deg(np.arctan2(-sight.dy, -sight.dx))
        off_deg = np.abs((back_deg - reflector.facing_deg + 180.0) % 360.0 - 180.0)
        free = sight.column_gap_mm() > optics.column_radius_mm
        hit = self._missed_mm(poses, sight) <= optics.acceptance_mm
        return np.asarray(hit & free & (off_deg <= optics.field_half_angle_deg), dtype=np.bool_)

    def tool_mm(self, poses: Floats) -> Floats:
        """Return where the J4 axis is in the plane, mm, shape (n, 2)."""
        return np.column_stack(self._tool(poses))

    def _tool(self, poses: Floats) -> tuple[Floats, Floats]:
        one, both = np.deg2rad(poses[:, 0]), np.deg2rad(poses[:, 0] + poses[:, 1])
        link1_mm, link2_mm = self._bench.link1_mm, self._bench.link2_mm
        x = link1_mm * np.cos(one) + link2_mm * np.cos(both)
        y = link1_mm * np.sin(one) + link2_mm * np.sin(both)
        return x, y

    def _missed_mm(self, poses: Floats, sight: _Sight) -> Floats:
        aside = sight.dy * np.cos(sight.world) - sight.dx * np.sin(sight.world)
        above = poses[:, 2] - self._bench.j3_mm
        apart = np.hypot(sight.dx, sight.dy)
        return np.where(sight.ahead_mm() > 0.0, np.hypot(aside, above), apart)

    def _sight(self, poses: Floats, reflector: Reflector) -> _Sight:
        x, y = self._tool(poses)
        world = np.deg2rad(poses[:, 0] + poses[:, 1] + poses[:, 3] + self._bench.optics.theta40_deg)
        return _Sight(x, y, reflector.x_mm - x, reflector.y_mm - y, world)
