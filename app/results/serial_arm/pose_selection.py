"""Choosing the poses of a calibration: rules from arm and tool, the choice, and what is said of it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from catseye.app.cell.arm import ArmDescription
from catseye.app.cell.bodies import capsules_of
from catseye.app.cell.serial_arm import point_of
from catseye.app.cell.tool import ToolDescription
from catseye.app.errors import UsageError
from catseye.app.files.csv_text import csv_text
from catseye.app.results.figures import Axis, Figure, Level, Panel, Points, Role
from catseye.app.results.model import Block, Column, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import COUNT, THREE_DIGITS, fixed
from catseye.app.results.origin import origin_now
from catseye.app.results.serial_arm.nominal_arm import serial_arm_of
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.kinematics.bodies import Point
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.joint_ranges import ranges_of
from catseye.calibration.serial_arm.design.candidates import (
    Candidates,
    Rules,
    Sight,
    draw_candidates,
    information_rows,
)
from catseye.calibration.serial_arm.design.exchange import Selection, growth, select
from catseye.calibration.serial_arm.design.observability import Index
from catseye.calibration.serial_arm.identification import ModelName

Progress = Callable[[str, float, float, str], None]
"""Part of the work, done, of how much, and what is going on."""


@dataclass(frozen=True)
class Asked:
    """What is to be chosen.

    Attributes:
        count: of poses.
        candidates: that are drawn.
        index: of observability.
        model: whose parameters the poses are to show.
        starts: random choices to begin with.
        station_mm: the instrument in the frame of the arm's base; None: it sees the targets everywhere.
        limits: narrower ranges by joint, deg or mm.
        approach: by how much below each joint begins its last move.
        with_bodies: the bodies of the arm's description count.
    """

    count: int
    candidates: int = 5000
    index: Index = "O1"
    model: ModelName = "geometric+compliance"
    starts: int = 3
    seed: int = 1
    station_mm: Point | None = None
    cone_deg: float = 30.0
    limits: dict[str, tuple[float, float]] = field(default_factory=dict)
    approach: float = 5.0
    with_bodies: bool = True


@dataclass(frozen=True)
class ChosenPoses:
    """The poses.

    Attributes:
        joints: deg or mm, shape (count, joints).
        targets: name of the target to measure at each.
        counts: numbers of poses, and the index that each reaches.
        parameters: that the poses show.
    """

    asked: Asked
    units: tuple[str, ...]
    joints: Floats
    targets: tuple[str, ...]
    selection: Selection
    drawn: int
    parameters: tuple[str, ...]
    counts: Ints
    values: Floats

    def csv(self) -> str:
        """Return a poses CSV."""
        header = ["pose", *(f"q{k}_{unit}" for k, unit in enumerate(self.units, 1)), "target"]
        body = (
            [f"P{k}", *(f"{q:.4f}" for q in joints), target]
            for k, (joints, target) in enumerate(zip(self.joints.tolist(), self.targets, strict=True), 1)
        )
        return csv_text(header, body)

    def document(self) -> dict[str, Any]:
        """Return the JSON output."""
        return {
            "index": self.asked.index,
            "value": self.selection.value,
            "count": self.asked.count,
            "candidates": self.asked.candidates,
            "drawn": self.drawn,
            "exchanges": self.selection.exchanges,
            "parameters": list(self.parameters),
            "index_of_count": [
                {"count": int(count), "value": float(value)}
                for count, value in zip(self.counts, self.values, strict=True)
            ],
        }


def select_poses(
    description: ArmDescription, tool: ToolDescription, asked: Asked, progress: Progress
) -> ChosenPoses:
    """Choose poses.

    Raises:
        UsageError: the tool has no target, or a limit names no joint.
        InsufficientPointsError: too few poses for the model, or hardly a pose keeps the rules.
    """
    if not tool.target:
        raise UsageError(f"the tool {tool.name} has no [[target]]: state what the instrument measures")
    arm = serial_arm_of(description, tool)
    rules = _rules(description, tool, arm.chain, asked)
    tried = draw_candidates(
        arm,
        rules,
        asked.candidates,
        asked.seed,
        lambda n, of: progress("candidates", n, of, f"{n} of {of}"),
    )
    rows, names = information_rows(arm, tried, asked.model)
    chosen = select(
        rows,
        asked.count,
        asked.index,
        asked.starts,
        asked.seed,
        lambda n, of, best: progress("exchange", n, of, f"start {n} of {of}, {asked.index} {best:.4g}"),
    )
    counts = _counts(asked.count, len(names), len(rows))
    values = np.zeros(len(counts))
    for k, number in enumerate(counts.tolist()):
        values[k : k + 1] = growth(rows, counts[k : k + 1], asked.index, asked.seed)
        progress("index", k + 1, len(counts), f"{number} poses, {asked.index} {values[k]:.4g}")
    return ChosenPoses(
        asked,
        tuple(joint.unit for joint in description.joint),
        tried.joints[chosen.chosen],
        _named(tool, tried, chosen),
        chosen,
        tried.drawn,
        names,
        counts,
        values,
    )


def selection_report(found: ChosenPoses, arm: str) -> Report:
    """Return what is said of a choice."""
    asked = found.asked
    said = Statement(
        Sign.GOOD,
        f"{asked.count} poses of {asked.candidates} candidates, {asked.index} {found.selection.value:.4g} after "
        f"{found.selection.exchanges} exchanges; they show {len(found.parameters)} parameters of the "
        f"model {asked.model}.",
    )
    advice = (
        "Drive to each pose from lower joints, as the choice assumes, and measure the target that it names."
    )
    columns = (
        Column("count", "poses", "", COUNT),
        Column("value", asked.index, "", THREE_DIGITS),
        Column("share", "of the chosen number's", "", fixed(2)),
    )
    rows = tuple(
        (int(count), float(value), float(value / found.selection.value))
        for count, value in zip(found.counts, found.values, strict=True)
    )
    table = Table("growth", "Index against the number of poses, one start each", columns, rows)
    blocks: list[Block] = [said, Statement(Sign.NEUTRAL, advice), table, growth_figure(found)]
    return Report(f"Poses for {arm}", origin_now(), (section("poses", "Poses", blocks, brief=True),))


def growth_figure(found: ChosenPoses) -> Figure:
    """Return the index against the number of poses."""
    marks = (
        Points(found.counts.astype(np.float64), found.values, Role.CHOSEN, found.asked.index, joined=True),
        Level(float(found.asked.count), Role.COMMAND, vertical=True, dash="dashed"),
    )
    panel = Panel("", Axis("number of poses"), Axis(f"index {found.asked.index}"), marks)
    return Figure("growth", "Index against the number of poses", "Index against poses.", ((panel,),))


def _rules(description: ArmDescription, tool: ToolDescription, chain: Chain, asked: Asked) -> Rules:
    names = [joint.name for joint in description.joint]
    low, high = ranges_of(chain)
    for name, ends in asked.limits.items():
        if name not in names:
            raise UsageError(f"--limit {name}: the arm has the joints {', '.join(names)}")
        low[names.index(name)], high[names.index(name)] = ends
    normals = tuple(None if one.normal is None else point_of(one.normal) for one in tool.target)
    return Rules(
        capsules_of(description.body, chain) if asked.with_bodies else (),
        None if asked.station_mm is None else Sight(asked.station_mm, normals, asked.cone_deg),
        asked.approach,
        low=low,
        high=high,
    )


def _counts(count: int, parameters: int, candidates: int) -> Ints:
    """Return numbers of poses from what the parameters need to twice the chosen number."""
    fewest = -(-parameters // 3)
    wanted = np.array([fewest, fewest + 4, (fewest + count) // 2, count, 3 * count // 2, 2 * count])
    return np.unique(wanted[(wanted >= fewest) & (wanted <= candidates)])


def _named(tool: ToolDescription, tried: Candidates, chosen: Selection) -> tuple[str, ...]:
    names: Sequence[str] = [one.name for one in tool.target]
    return tuple(names[k] for k in tried.target[chosen.chosen])
