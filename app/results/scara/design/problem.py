"""A cell file as a problem of optimal design: what is measured, seen from where, and what shall be small."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from catseye.app.errors import UsageError
from catseye.calibration.core.design.criteria import CriterionName
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.arm import arm_design
from catseye.calibration.scara.budget import Budget
from catseye.calibration.scara.design.candidates import Floor
from catseye.calibration.scara.design.criterion import Criterion
from catseye.calibration.scara.design.sight import Rules, Sight, Way, sight_of
from catseye.calibration.scara.design.study import Study
from catseye.calibration.scara.errors import OutOfReachError
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.points import Commands
from catseye.calibration.scara.prediction import inside_range
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.motion.approach import Command, Waypoint, bidirectional_sequence, with_take_up
from catseye.procedures.scara.path.path_plan import path_points
from catseye.procedures.scara.path.tracked_path import PathPoint

PAPER_MM = ((650.0, -400.0), (680.0, 0.0), (640.0, 380.0))
"""Reflectors of the SCARA paper."""

_FEWEST_SEEN = 0.8
"""Share of the commands below which a place is no candidate: what it does not see also breaks the beam."""

_SAMPLE_DEG = 2.5
"""Joint travel between two looks along the way."""

_MOST_OF_IT = 0.8
"""Share of the paper's path that has to lie inside the nodes for it to stand for a cell's work."""

_MOST_COMMANDS = 20_000
"""More take hours, and show nothing about places that fewer do not."""

_RING = 2.0
"""Radius of the floor where none is given, in reaches of the arm."""


@dataclass(frozen=True)
class Wish:
    """What a user asks for.

    Attributes:
        criterion: what is made small.
        path: commands on which the uncertainty counts; None for the paper's path or the whole workspace.
        floor_mm: x from, to, y from, to; None for a ring around the arm.
        keep_out_mm: radius about the J1 axis that is kept free; None for the arm's reach and what turns with J4.
        apart_mm: smallest distance between two reflectors.
        breaks: how often the beam to a reflector may be given up.
        systematic: the criterion includes what does not average out.
    """

    criterion: CriterionName = "A"
    path: Commands | None = None
    floor_mm: tuple[float, float, float, float] | None = None
    keep_out_mm: float | None = None
    apart_mm: float = 100.0
    breaks: int = 4
    systematic: bool = True


@dataclass(frozen=True)
class Problem:
    """Everything a design is made from.

    Attributes:
        bench: the cell.
        sequence: commands in measuring order.
        study: the arm and these commands.
        way: of the arm through them.
        rules: what a place has to meet.
        floor: where places lie.
        criterion: what is made small.
        path_text: what the path of the criterion is.
        systematic: the criterion includes what does not average out.
    """

    bench: ScaraBench
    sequence: tuple[Command, ...]
    study: Study
    way: Way
    rules: Rules
    floor: Floor
    criterion: Criterion
    path_text: str
    systematic: bool

    def sight(self, xy_mm: Floats, facing_deg: float | None = None) -> Sight:
        """Look at the measurement from a place; without a facing, from its best one."""
        facing = None if facing_deg is None else float(np.deg2rad(facing_deg))
        return sight_of(np.asarray(xy_mm, dtype=np.float64), self.way, self.rules, facing)

    def with_criterion(self, name: CriterionName) -> Criterion:
        """Return another criterion of the same study and path."""
        return replace(self.criterion, name=name)


def problem_of(bench: ScaraBench, budget: Budget, wish: Wish) -> Problem:
    """Return the problem that a cell and a wish make.

    Raises:
        UsageError: the floor is empty, no command of the path lies inside the nodes, distances would be exact, or
            the nodes make too many commands.
    """
    if not any(one.u > 0.0 for one in budget.white):
        raise UsageError(
            "no contributor of [uncertainty] differs from reading to reading, so that one distance would be exact: "
            'state the repeatability of the robot (correlation = "reading")'
        )
    commands = 4 * len(bench.nodes1_deg) * len(bench.nodes2_deg)
    if commands > _MOST_COMMANDS:
        raise UsageError(
            f"{len(bench.nodes1_deg)} and {len(bench.nodes2_deg)} nodes make {commands} commands, and a design is "
            f"worked out for {_MOST_COMMANDS} at most: give a cell file with fewer nodes over the same range, every "
            "5° say; places that are good for them are good for a scan with finer ones"
        )
    sequence = bidirectional_sequence(bench.nodes1_deg, bench.nodes2_deg)
    layout = Layout("error-map", np.deg2rad(bench.nodes1_deg), np.deg2rad(bench.nodes2_deg), (), ())
    study = Study(layout, bench.link1_mm, bench.link2_mm, commands_of(sequence), budget)
    rules = _rules(bench, wish)
    path, text = _path(bench, study, wish.path)
    gradient = study.gradient(arm_design(layout, path))
    criterion = Criterion(wish.criterion, layout.arm_size, gradient.reshape(-1, gradient.shape[2]))
    way = _way(with_take_up(sequence, bench.take_up_deg), bench)
    floor = _floor(bench, wish)
    return Problem(bench, sequence, study, way, rules, floor, criterion, text, wish.systematic)


def commands_of(sequence: Sequence[Command | PathPoint]) -> Commands:
    """Return commands as columns."""
    theta = np.deg2rad([[command.theta1_deg, command.theta2_deg] for command in sequence])
    directions = np.array([[command.direction1, command.direction2] for command in sequence], dtype=np.int64)
    return Commands(theta[:, 0], theta[:, 1], directions[:, 0], directions[:, 1])


def with_reflectors(bench: ScaraBench, sights: tuple[Sight, ...]) -> ScaraBench:
    """Return the bench with other reflectors, P1, P2 … in the order given."""
    return replace(
        bench,
        reflectors=tuple(
            Reflector(
                f"P{k}",
                float(sight.xy_mm[0]),
                float(sight.xy_mm[1]),
                float(np.round(np.rad2deg(sight.facing_rad), 1)),
            )
            for k, sight in enumerate(sights, 1)
        ),
    )


def _rules(bench: ScaraBench, wish: Wish) -> Rules:
    optics = bench.optics
    low, high = np.deg2rad(bench.j4_limits_deg)
    free_mm = bench.link1_mm + bench.link2_mm + max(optics.beam_min_mm, _beside_the_axis_mm(bench))
    return Rules(
        column_radius_mm=optics.column_radius_mm + optics.column_margin_mm,
        field_half_angle_rad=float(np.deg2rad(optics.field_half_angle_deg)),
        beam_range_mm=(optics.beam_min_mm, optics.beam_max_mm),
        j4_limits_rad=(float(low), float(high)),
        theta40_rad=float(np.deg2rad(optics.theta40_deg)),
        keep_out_mm=free_mm if wish.keep_out_mm is None else wish.keep_out_mm,
        apart_mm=wish.apart_mm,
        fewest_seen=_FEWEST_SEEN,
        most_breaks=wish.breaks,
    )


def _beside_the_axis_mm(bench: ScaraBench) -> float:
    """Return how near to the J4 axis a reflector can stand whichever way the interferometer is turned."""
    workspace = bench.workspace
    turning = [body for body in workspace.bodies if body.frame == len(workspace.chain.joints)]
    farthest = max(
        (math.hypot(*end[:2]) + body.radius_mm for body in turning for end in (body.start_mm, body.end_mm)),
        default=0.0,
    )
    return farthest + workspace.stand_radius_mm + workspace.clearance_mm


def _floor(bench: ScaraBench, wish: Wish) -> Floor:
    if wish.floor_mm is None:
        radius = _RING * (bench.link1_mm + bench.link2_mm)
        return Floor((-radius, radius), (-radius, radius), radius)
    x0, x1, y0, y1 = wish.floor_mm
    if x0 > x1 or y0 > y1:
        raise UsageError(f"--floor {x0:g},{x1:g},{y0:g},{y1:g} is empty: give X0 <= X1 and Y0 <= Y1")
    return Floor((x0, x1), (y0, y1))


def _way(stops: tuple[Waypoint, ...], bench: ScaraBench) -> Way:
    theta = np.deg2rad([[stop.theta1_deg, stop.theta2_deg] for stop in stops])
    travel = np.abs(np.diff(theta, axis=0)).max(axis=1)
    parts = np.maximum(1, np.ceil(travel / np.deg2rad(_SAMPLE_DEG))).astype(int)
    legs = [
        start + np.arange(1, count + 1)[:, None] / count * (end - start)
        for start, end, count in zip(theta[:-1], theta[1:], parts, strict=True)
    ]
    dense = np.vstack([theta[:1], *legs])
    at = np.concatenate([[0], np.cumsum(parts)])
    measured = np.array([stop.command is not None for stop in stops])
    return Way(dense, forward(dense[:, 0], dense[:, 1], bench.link1_mm, bench.link2_mm), at[measured])


def _path(bench: ScaraBench, study: Study, given: Commands | None) -> tuple[Commands, str]:
    """Return the commands of the path inside the nodes, and what it is."""
    arm = study.arm(np.zeros((study.basis.shape[1], study.basis.shape[1])))
    if given is not None:
        inside = inside_range(arm, given)
        if not inside.any():
            raise UsageError(
                "no row of the path lies inside the nodes of the cell file's [measurement]: choose another path, or "
                "add nodes that enclose it; a map is never extrapolated"
            )
        left_out = int((~inside).sum())
        text = "the given path" + (
            f" without {left_out} row{'s' if left_out > 1 else ''} outside of the nodes" if left_out else ""
        )
        return given.select(inside), text
    paper = _paper_path(bench)
    if paper is not None:
        inside = inside_range(arm, paper)
        if inside.mean() >= _MOST_OF_IT:
            part = "" if inside.all() else ", as far as it lies inside the nodes"
            return paper.select(inside), f"the line X = 200 mm, Y = −500…500 mm, both ways{part}"
    return workspace(bench, 2), "the whole workspace, all directions of approach"


def _paper_path(bench: ScaraBench) -> Commands | None:
    try:
        points = path_points(bench, 200.0, (-500.0, 500.0), 25.0, "right")
    except OutOfReachError:
        return None
    return commands_of(points)


def workspace(bench: ScaraBench, parts: int) -> Commands:
    """Return a grid over the nodes, each interval in equal parts, with all four directions of approach."""
    one, two = (_finer(np.deg2rad(nodes), parts) for nodes in (bench.nodes1_deg, bench.nodes2_deg))
    theta1, theta2, direction1, direction2 = (
        column.ravel() for column in np.meshgrid(one, two, [1, -1], [1, -1], indexing="ij")
    )
    return Commands(theta1, theta2, direction1.astype(np.int64), direction2.astype(np.int64))


def _finer(nodes: Floats, parts: int) -> Floats:
    shares = np.arange(parts) / parts
    between = nodes[:-1, None] + shares * np.diff(nodes)[:, None]
    return np.append(between.ravel(), nodes[-1])
