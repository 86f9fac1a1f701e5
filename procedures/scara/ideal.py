"""The beam of an ideal SCARA: which reflector returns it, and by how much it misses on a way.

Geometry of its own: it looks at a plan from outside and would not see the planner's mistakes with the planner's eyes.
"""

import numpy as np
from numpy.typing import NDArray

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.ideal import Hit, IdealBeam, Watched
from catseye.procedures.scara.bench import Reflector, ScaraBench

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


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
            Hit(one.name, self._along_mm(poses, one))
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
        dx, dy, world = self._sight(poses, reflector)
        ahead = dx * np.cos(world) + dy * np.sin(world)
        aside = dy * np.cos(world) - dx * np.sin(world)
        above = poses[:, 2] - self._bench.j3_mm
        return np.where(ahead > 0.0, np.hypot(aside, above), np.hypot(dx, dy))

    def returns(self, poses: Floats, reflector: Reflector) -> Bools:
        """Return at which poses a reflector returns the beam, past the column and inside its field, shape (n,)."""
        optics = self._bench.optics
        dx, dy, _ = self._sight(poses, reflector)
        back_deg = np.rad2deg(np.arctan2(-dy, -dx))
        off_deg = np.abs((back_deg - reflector.facing_deg + 180.0) % 360.0 - 180.0)
        free = self._column_gap_mm(poses, dx, dy) > optics.column_radius_mm
        hit = self.miss_mm(poses, reflector) <= optics.acceptance_mm
        return np.asarray(hit & free & (off_deg <= optics.field_half_angle_deg), dtype=np.bool_)

    def tool_mm(self, poses: Floats) -> Floats:
        """Return where the J4 axis is in the plane, mm, shape (n, 2)."""
        one, both = np.deg2rad(poses[:, 0]), np.deg2rad(poses[:, 0] + poses[:, 1])
        link1_mm, link2_mm = self._bench.link1_mm, self._bench.link2_mm
        x = link1_mm * np.cos(one) + link2_mm * np.cos(both)
        y = link1_mm * np.sin(one) + link2_mm * np.sin(both)
        return np.column_stack([x, y])

    def _along_mm(self, poses: Floats, reflector: Reflector) -> float:
        """Return the length of the beam at the first pose, measured along it as a counter does."""
        dx, dy, world = self._sight(poses, reflector)
        return float(dx[0] * np.cos(world[0]) + dy[0] * np.sin(world[0]))

    def _sight(self, poses: Floats, reflector: Reflector) -> tuple[Floats, Floats, Floats]:
        """Return the way to a reflector, mm, and the beam's direction, rad, shape (n,) each."""
        x, y = self.tool_mm(poses).T
        world = np.deg2rad(poses[:, 0] + poses[:, 1] + poses[:, 3] + self._bench.optics.theta40_deg)
        return reflector.x_mm - x, reflector.y_mm - y, world

    def _column_gap_mm(self, poses: Floats, dx: Floats, dy: Floats) -> Floats:
        """Return how near the line from arm to reflector comes to the J1 axis, mm, shape (n,)."""
        x, y = self.tool_mm(poses).T
        share = np.clip(-(x * dx + y * dy) / np.maximum(dx**2 + dy**2, 1e-12), 0.0, 1.0)
        return np.asarray(np.hypot(x + share * dx, y + share * dy), dtype=np.float64)
