"""Collisions judged another way: bodies as strings of balls, the motion sampled densely, trigonometry by hand.

Nothing of `catseye.calibration.kinematics` is used but the description of the bodies. A string of balls is a little
smaller than the capsule, and samples of a motion miss its worst moment by a little: what is found is never too small.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.kinematics.bodies import Box, Capsule
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import Following
from catseye.procedures.kit.bench import Workspace
from catseye.procedures.scara.bench import Reflector, ScaraBench
from tests.unit.procedures.benches import LINK1_MM, LINK2_MM, WORKSPACE, bench

Floats = NDArray[np.float64]

FLANGE_MM = 200.0
_BALLS_MM = 10.0
_COARSE_MM = 20.0
_FINE_MM = 1.0
_WIDE_J2_DEG = 178.0


@dataclass(frozen=True)
class Plane:
    """A table."""

    name: str
    z_mm: float


@dataclass(frozen=True)
class Fence:
    """The inside of a box."""

    name: str
    box: Box


Obstacle = Capsule | Box | Plane | Fence


@dataclass(frozen=True)
class Verdict:
    """What the oracle saw.

    Attributes:
        distance_mm: least distance of any pair that may meet.
        pair: names of that pair.
    """

    distance_mm: float
    pair: tuple[str, str]


def judged(stations: Floats, scene: ScaraBench) -> Verdict:
    """Return the least distance over a motion.

    Args:
        stations: joints along the motion, straight in between and near together, shape (n, 4).
        scene: bodies and surroundings.
    """
    places = _places(stations)
    found = {pair: float(distances(places, pair).min()) for pair in pairs(scene)}
    pair = min(found, key=lambda two: found[two])
    return Verdict(found[pair], (pair[0].name, pair[1].name))


def refined(way: list[Pose], scene: ScaraBench) -> Verdict:
    """Return the least distance over a way; pairs that come near are looked at closely."""
    coarse, fine = _places(sampled(way, _COARSE_MM)), _places(sampled(way, _FINE_MM))
    worst = judged(sampled(way, _COARSE_MM), scene)
    near = [
        pair
        for pair in pairs(scene)
        if distances(coarse, pair).min() < scene.workspace.clearance_mm + _COARSE_MM
    ]
    closely = [Verdict(float(distances(fine, pair).min()), (pair[0].name, pair[1].name)) for pair in near]
    return min([worst, *closely], key=lambda one: one.distance_mm)


def least_mm(way: list[Pose], pair: tuple[Capsule, Obstacle]) -> float:
    """Return the least distance of a pair over a way."""
    return float(distances(_places(sampled(way, _FINE_MM)), pair).min())


def sampled(way: list[Pose], step_mm: float) -> Floats:
    """Return joints along straight joint moves, no point of the arm moving farther than a step in between."""
    parts = [np.array(way[:1])]
    for start, end in pairwise(way):
        change = np.abs(np.subtract(end, start))
        moved_mm = float(np.radians(change[[0, 1, 3]]) @ [650.0, 325.0, 100.0] + change[2])
        count = max(1, math.ceil(moved_mm / step_mm))
        share = np.arange(1, count + 1)[:, None] / count
        parts.append(np.array(start) + share * np.subtract(end, start))
    return np.vstack(parts)


def with_cut_corners(way: list[Pose], share: float) -> Floats:
    """Return a motion that leaves each leg a share before its target and joins the next one as far behind it."""
    points = np.array(way)
    stations = [points[:1]]
    t = np.linspace(0.0, 1.0, 200)[:, None]
    for before, via, after in zip(points, points[1:], points[2:], strict=False):
        enter, leave = via + share * (before - via), via + share * (after - via)
        stations.append(sampled([_joints(stations[-1][-1]), _joints(enter)], _FINE_MM))
        stations.append((1.0 - t) ** 2 * enter + 2.0 * t * (1.0 - t) * via + t**2 * leave)
    stations.append(sampled([_joints(stations[-1][-1]), _joints(points[-1])], _FINE_MM))
    return np.vstack(stations)


def generated(seed: int, count: int) -> Iterator[tuple[ScaraBench, list[Pose]]]:
    """Yield benches with ways, about half of them with something in the way."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        scene = _scene(rng)
        yield scene, _way(rng, scene)


def _scene(rng: np.random.Generator) -> ScaraBench:
    places = {}
    for number in range(rng.integers(1, 4)):
        radius, angle = rng.uniform(450.0, 800.0), rng.uniform(-math.pi, math.pi)
        places[f"P{number}"] = (radius * math.cos(angle), radius * math.sin(angle))
    boxes = [_box(rng, f"box {number}") for number in range(rng.integers(0, 3))]
    high = float(rng.uniform(560.0, 900.0))
    fence = [Box("fence", (-high, -high, 0.0), (high, high, 800.0))] if rng.random() < 0.3 else []
    head = replace(WORKSPACE.bodies[-1], radius_mm=float(rng.uniform(20.0, 45.0)))
    workspace = replace(
        WORKSPACE,
        bodies=(*WORKSPACE.bodies[:-1], head),
        table_z_mm=float(rng.uniform(0.0, 110.0)),
        stand_radius_mm=float(rng.uniform(8.0, 30.0)),
        keep_out=tuple(boxes),
        keep_in=tuple(fence),
    )
    base = bench(places=places)
    following: Following = "blended" if rng.random() < 0.3 else "stops"
    arm = replace(base.arm, following=following)
    return replace(base, arm=arm, workspace=workspace, j3_mm=float(rng.uniform(0.0, 150.0)))


def _box(rng: np.random.Generator, name: str) -> Box:
    radius, angle = rng.uniform(350.0, 700.0), rng.uniform(-math.pi, math.pi)
    middle = np.array([radius * math.cos(angle), radius * math.sin(angle), rng.uniform(0.0, 500.0)])
    half = rng.uniform(10.0, 80.0, 3)
    return Box(name, tuple(middle - half), tuple(middle + half))


def _way(rng: np.random.Generator, scene: ScaraBench) -> list[Pose]:
    wide = rng.random() < 0.2
    j2_deg = _WIDE_J2_DEG if wide else 145.0
    reach = rng.uniform(10.0, 120.0)
    heights = (0.0, 150.0) if rng.random() < 0.3 else (scene.j3_mm, scene.j3_mm)
    start = np.array(
        [rng.uniform(-170, 170), rng.uniform(-j2_deg, j2_deg), scene.j3_mm, rng.uniform(-180, 180)]
    )
    way = [start]
    for _ in range(rng.integers(1, 6)):
        step = rng.uniform(-reach, reach, 4)
        target = np.clip(way[-1] + step, [-170, -j2_deg, 0, -360], [170, j2_deg, 0, 360])
        target[2] = rng.uniform(*heights)
        way.append(target)
    return [_joints(row) for row in way]


def _joints(row: Floats) -> Pose:
    one, two, three, four = (float(value) for value in row)
    return one, two, three, four


def pairs(scene: ScaraBench) -> list[tuple[Capsule, Obstacle]]:
    """Return the pairs of bodies that may meet, a moving one first."""
    workspace = scene.workspace
    arm = workspace.bodies
    moving = [body for body in arm if body.frame > 0]
    top = FLANGE_MM + scene.j3_mm
    around: list[Obstacle] = [_stand(one, workspace, top) for one in scene.reflectors]
    around += [Box(f"keep-out box {box.name}", box.low_mm, box.high_mm) for box in workspace.keep_out]
    around += [Fence(f"wall of the keep-in box {box.name}", box) for box in workspace.keep_in]
    around.append(Plane("table", workspace.table_z_mm))
    own = [(far, near) for near in arm for far in arm if far.frame - near.frame > 1]
    return [*own, *((body, other) for body in moving for other in around)]


def _stand(reflector: Reflector, workspace: Workspace, top_mm: float) -> Capsule:
    foot = (reflector.x_mm, reflector.y_mm, workspace.table_z_mm)
    return Capsule(
        f"stand of reflector {reflector.name}", 0, foot, (*foot[:2], top_mm), workspace.stand_radius_mm
    )


Places = list[tuple[Floats, Floats, Floats]]
"""For each frame of a SCARA: its origin, shape (n, 1, 3), cosine and sine of its turn, shape (n, 1)."""


def _places(stations: Floats) -> Places:
    one, two, four = np.radians(stations[:, [0, 1, 3]]).T
    zero = np.zeros(len(stations))
    elbow = LINK1_MM * np.column_stack([np.cos(one), np.sin(one), zero])
    tip = elbow + LINK2_MM * np.column_stack([np.cos(one + two), np.sin(one + two), zero])
    tip[:, 2] = FLANGE_MM + stations[:, 2]
    origins = (np.zeros_like(elbow), np.zeros_like(elbow), elbow, tip, tip)
    turns = (zero, one, one + two, one + two, one + two + four)
    return [
        (origin[:, None], np.cos(turn)[:, None], np.sin(turn)[:, None])
        for origin, turn in zip(origins, turns, strict=True)
    ]


def distances(places: Places, pair: tuple[Capsule, Obstacle]) -> Floats:
    """Return the distances of a pair along a motion, shape (n,)."""
    body, other = pair
    share = np.linspace(0.0, 1.0, 1 + math.ceil(math.dist(body.start_mm, body.end_mm) / _BALLS_MM))[:, None]
    balls = _placed(
        places[body.frame], np.array(body.start_mm) + share * np.subtract(body.end_mm, body.start_mm)
    )
    if isinstance(other, Fence):
        gaps = np.minimum(balls - other.box.low_mm, np.subtract(other.box.high_mm, balls)).min(axis=-1)
    elif isinstance(other, Plane):
        gaps = balls[..., 2] - other.z_mm
    elif isinstance(other, Box):
        outside = np.maximum(np.maximum(other.low_mm - balls, balls - np.array(other.high_mm)), 0.0)
        gaps = np.sqrt((outside**2).sum(axis=-1))
    else:
        ends = _placed(places[other.frame], np.array([other.start_mm, other.end_mm]))
        start, along = ends[:, :1], ends[:, 1:] - ends[:, :1]
        foot = ((balls - start) * along).sum(axis=-1) / (along**2).sum(axis=-1)
        off = balls - start - np.clip(foot, 0.0, 1.0)[..., None] * along
        gaps = np.sqrt((off**2).sum(axis=-1)) - other.radius_mm
    return np.asarray(gaps.min(axis=1) - body.radius_mm, dtype=np.float64)


def _placed(place: tuple[Floats, Floats, Floats], points: Floats) -> Floats:
    """Return where points of a body are, mm, shape (n, points, 3)."""
    origin, cos, sin = place
    x, y, z = points.T
    turned = np.stack([x * cos - y * sin, x * sin + y * cos, np.broadcast_to(z, (len(cos), len(z)))], axis=-1)
    return np.asarray(origin + turned, dtype=np.float64)
