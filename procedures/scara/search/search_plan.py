"""From where to look for each reflector."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.scara.planar import forward, wrap_rad
from catseye.calibration.scara.pointing import beam_direction, visible
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.motion.clear_way import require_clear_way, way_refusal
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.motion.tracking import aimed_j4

Floats = NDArray[np.float64]

_GRID = 13
"""Angles of each joint that a search pose is chosen from."""

_SEPARATION_MARGIN_DEG = 2.0
"""Two reflectors seen from a pose have to be further apart than the scan and this."""


@dataclass(frozen=True)
class SearchPose:
    """A pose from which a reflector is looked for.

    Attributes:
        reflector: what is looked for, at its rough place.
        theta1_deg: J1.
        theta2_deg: J2.
        j4_deg: rough aim, inside the limits.
        beam_mm: rough length of the beam.
    """

    reflector: Reflector
    theta1_deg: float
    theta2_deg: float
    j4_deg: float
    beam_mm: float

    def turned(self, half_range_deg: float, bench: ScaraBench) -> tuple[Pose, Pose]:
        """Return the joints at both ends of a scan of J4, at the height of the cell file."""
        low, high = bench.j4_limits_deg
        first, last = max(low, self.j4_deg - half_range_deg), min(high, self.j4_deg + half_range_deg)
        j3_mm = bench.j3_mm
        return (self.theta1_deg, self.theta2_deg, j3_mm, first), (
            self.theta1_deg,
            self.theta2_deg,
            j3_mm,
            last,
        )


@dataclass(frozen=True)
class Jogging:
    """The technician turns J4 until the beam is back.

    Attributes:
        largest_deg: largest turn of one answer.
        auto_centre: once the beam is back the program centres it.
    """

    largest_deg: float
    auto_centre: bool


@dataclass(frozen=True)
class SearchPlan:
    """The whole search.

    Attributes:
        bench: what it was made from.
        reflectors: what is looked for.
        poses: in order.
        further: poses to look from if the aim would not hold, each with a free way to and from all others.
        jogging: how the technician looks for the beam; None for scans.
        half_range_deg: how far J4 turns to either side at the first pose.
        later_half_range_deg: the same once a reflector has been seen and θ40 is known roughly.
        command_positions_mm: for each reflector, where the arm stands at the commands that see it, shape (n, 2).
    """

    bench: ScaraBench
    reflectors: tuple[Reflector, ...]
    poses: tuple[SearchPose, ...]
    further: tuple[SearchPose, ...]
    jogging: Jogging | None
    half_range_deg: float
    later_half_range_deg: float
    command_positions_mm: tuple[Floats, ...]


def plan_search(
    bench: ScaraBench,
    poses: int = 8,
    half_range_deg: float = 6.0,
    rough_place_mm: float = 20.0,
    most_poses: int | None = None,
    jogging: Jogging | None = None,
) -> SearchPlan:
    """Choose poses spread over the workspace for every reflector.

    Args:
        poses: poses for each reflector, at least 4.
        half_range_deg: how far off the beam's zero direction and the rough places together may be, deg.
        rough_place_mm: how far off a rough place may be, mm; sets the range of the later scans.
        most_poses: poses for each reflector with those that are added until the aim holds; None: three times poses.
        jogging: how the technician looks for the beam; None for scans.

    Raises:
        PlanError: a reflector can be seen from too few nodes, or two reflectors stand in one direction.
    """
    if poses < 4:
        raise PlanError(f"a search needs at least 4 poses a reflector, not {poses}")
    most = 3 * poses if most_poses is None else most_poses
    if most < poses:
        raise PlanError(f"most_poses = {most} is below poses = {poses}: raise it or ask for fewer poses")
    nodes = np.deg2rad([[one, two] for one in bench.nodes1_deg for two in bench.nodes2_deg])
    candidates = _grid(bench)
    chosen: list[SearchPose] = []
    further: list[SearchPose] = []
    positions = []
    for reflector in bench.reflectors:
        positions.append(_positions(_seen(nodes, bench, reflector), bench))
        seen = _seen(candidates, bench, reflector)
        usable = seen[_apart(seen, bench, reflector, half_range_deg)]
        if len(usable) < poses:
            raise PlanError(
                f"reflector {reflector.name} at ({reflector.x_mm:g}, {reflector.y_mm:g}) mm can be told from the "
                f"others at only {len(usable)} of {len(candidates)} poses, {poses} are needed: check its place, the "
                "column and its field, or ask for fewer poses or a smaller half_range_deg"
            )
        order = usable[_spread(_positions(usable, bench), min(most, len(usable)))]
        chosen += [_aimed_pose(pose, bench, reflector) for pose in order[:poses]]
        spare = [_pose(pose, bench, reflector, bench.j4_limits_deg) for pose in order[poses:]]
        further += [pose for pose in spare if pose is not None]
    require_clear_way([end for pose in chosen for end in pose.turned(half_range_deg, bench)], bench)
    nearest = min(pose.beam_mm for pose in chosen)
    later = min(half_range_deg, float(np.rad2deg(2.0 * rough_place_mm / nearest)))
    return SearchPlan(
        bench,
        bench.reflectors,
        tuple(chosen),
        _freely_reached(further, chosen, half_range_deg, bench),
        jogging,
        half_range_deg,
        later,
        tuple(positions),
    )


def _freely_reached(
    further: list[SearchPose], chosen: list[SearchPose], half_range_deg: float, bench: ScaraBench
) -> tuple[SearchPose, ...]:
    """Return the poses that have a free way to and from all others: nobody knows yet in which order they come."""
    kept: list[SearchPose] = []
    for pose in further:
        here = pose.turned(half_range_deg, bench)
        others = [other.turned(half_range_deg, bench) for other in (*chosen, *kept)]
        if way_refusal([end for other in others for end in (*other, *here)], bench) is None:
            kept.append(pose)
    return tuple(kept)


def looking_poses(
    bench: ScaraBench,
    reflector: Reflector,
    half_range_deg: float,
    at_deg: tuple[float, float] | None = None,
) -> tuple[SearchPose, ...]:
    """Return every pose from which a reflector is seen alone, its scan inside the limits of J4.

    Args:
        half_range_deg: how far J4 turns to either side.
        at_deg: J1 and J2 of the only pose to consider; None for poses all over the range of the nodes.
    """
    candidates = _grid(bench) if at_deg is None else np.deg2rad([at_deg])
    seen = _seen(candidates, bench, reflector)
    low, high = bench.j4_limits_deg
    within = (low + half_range_deg, high - half_range_deg)
    usable = seen[_apart(seen, bench, reflector, half_range_deg)]
    poses = [_pose(pose, bench, reflector, within) for pose in usable]
    return tuple(pose for pose in poses if pose is not None)


def measured_distances_mm(bench: ScaraBench) -> tuple[float, float]:
    """Return the shortest and the longest beam at the nodes of a measurement, mm.

    Raises:
        PlanError: no reflector is seen from any node.
    """
    nodes = np.deg2rad([[one, two] for one in bench.nodes1_deg for two in bench.nodes2_deg])
    lengths = np.concatenate(
        [
            np.hypot(*(reflector.xy_mm - _positions(_seen(nodes, bench, reflector), bench)).T)
            for reflector in bench.reflectors
        ]
    )
    if not lengths.size:
        raise PlanError("no reflector is seen from any node: check places, column and field in the cell file")
    return float(lengths.min()), float(lengths.max())


def _grid(bench: ScaraBench) -> Floats:
    """Return poses all over the range of the nodes, rad, shape (n, 2)."""
    first, second = (
        np.linspace(nodes[0], nodes[-1], _GRID) for nodes in (bench.nodes1_deg, bench.nodes2_deg)
    )
    return np.deg2rad(np.stack(np.meshgrid(first, second, indexing="ij"), axis=-1).reshape(-1, 2))


def _positions(theta_rad: Floats, bench: ScaraBench) -> Floats:
    return forward(theta_rad[:, 0], theta_rad[:, 1], bench.link1_mm, bench.link2_mm)


def _seen(nodes: Floats, bench: ScaraBench, reflector: Reflector) -> Floats:
    optics = bench.optics
    flags = visible(
        _positions(nodes, bench),
        reflector.xy_mm,
        float(np.deg2rad(reflector.facing_deg)),
        optics.column_radius_mm + optics.column_margin_mm,
        float(np.deg2rad(optics.field_half_angle_deg)),
        (optics.beam_min_mm, optics.beam_max_mm),
    )
    return nodes[flags]


def _apart(
    theta_rad: Floats, bench: ScaraBench, reflector: Reflector, half_range_deg: float
) -> NDArray[np.bool_]:
    """Return from which poses no other reflector stands inside the scan."""
    positions = _positions(theta_rad, bench)
    own = beam_direction(positions, reflector.xy_mm)
    apart = np.ones(len(theta_rad), dtype=np.bool_)
    # A single cat's eye that is carried about leaves the other nests empty.
    others = () if bench.optics.one_reflector else bench.reflectors
    for other in others:
        if other != reflector:
            off = np.abs(wrap_rad(beam_direction(positions, other.xy_mm) - own))
            apart &= np.rad2deg(off) > half_range_deg + _SEPARATION_MARGIN_DEG
    return apart


def _spread(positions_mm: Floats, count: int) -> list[int]:
    """Return rows that lie far from one another: each next one is the farthest from those chosen."""
    chosen = [int(np.argmax(np.hypot(*(positions_mm - positions_mm.mean(axis=0)).T)))]
    while len(chosen) < count:
        gaps = np.hypot(*np.moveaxis(positions_mm[:, None, :] - positions_mm[chosen], -1, 0)).min(axis=1)
        chosen.append(int(np.argmax(gaps)))
    return chosen


def _pose(
    theta_rad: Floats, bench: ScaraBench, reflector: Reflector, j4_limits_deg: tuple[float, float]
) -> SearchPose | None:
    j4_deg = _inside(float(np.rad2deg(wrap_rad(aimed_j4(theta_rad, bench, reflector)))), j4_limits_deg)
    if j4_deg is None:
        return None
    beam = reflector.xy_mm - _positions(theta_rad[None, :], bench)[0]
    theta1_deg, theta2_deg = (float(angle) for angle in np.rad2deg(theta_rad))
    return SearchPose(reflector, theta1_deg, theta2_deg, j4_deg, float(np.hypot(*beam)))


def _aimed_pose(theta_rad: Floats, bench: ScaraBench, reflector: Reflector) -> SearchPose:
    pose = _pose(theta_rad, bench, reflector, bench.j4_limits_deg)
    if pose is None:
        low, high = bench.j4_limits_deg
        j4_deg = float(np.rad2deg(wrap_rad(aimed_j4(theta_rad, bench, reflector))))
        raise PlanError(
            f"J4 = {j4_deg:.1f}° plus any whole turn is outside its limits {low:g}°…{high:g}°: widen "
            "[robot.limits_deg] j4 or move the reflector"
        )
    return pose


def _inside(j4_deg: float, limits_deg: tuple[float, float]) -> float | None:
    low, high = limits_deg
    turned = (j4_deg + turn for turn in (0.0, 360.0, -360.0))
    return next((value for value in turned if low <= value <= high), None)
