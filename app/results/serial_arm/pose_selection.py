"""Choosing the poses of a calibration: rules from arm and tool, the choice, and what is said of it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from catseye.app.files.csv_text import csv_text
from catseye.app.results.model import Block, Column, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import COUNT, THREE_DIGITS, fixed
from catseye.app.results.origin import origin_now
from catseye.app.results.serial_arm.pose_setup import Asked, PoseSetup
from catseye.app.results.serial_arm.selection_document import ADVICE, IndexOfCount, SelectionDocument
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.serial_arm.design.candidates import DIGITS, draw_candidates
from catseye.calibration.serial_arm.design.exchange import Selection, fewest_poses, growth, select
from catseye.calibration.serial_arm.design.pose_rows import PoseRows, pose_rows

Progress = Callable[[str, float, float, str], None]
"""Part of the work, done, of how much, and what is going on."""


@dataclass(frozen=True)
class ChosenPoses:
    """The poses.

    Attributes:
        joints: deg or mm, shape (count, joints).
        targets: names of the targets to measure at each.
        counts: numbers of poses, and the index that each reaches.
        parameters: that the poses show.
    """

    asked: Asked
    units: tuple[str, ...]
    joints: Floats
    targets: tuple[tuple[str, ...], ...]
    selection: Selection
    drawn: int
    parameters: tuple[str, ...]
    counts: Ints
    values: Floats

    def csv(self) -> str:
        """Return a poses CSV, a row a target that is measured."""
        header = ["pose", *(f"q{k}_{unit}" for k, unit in enumerate(self.units, 1)), "target"]
        body = (
            [f"P{k}", *(f"{q:.{DIGITS}f}" for q in joints), target]
            for k, (joints, targets) in enumerate(zip(self.joints.tolist(), self.targets, strict=True), 1)
            for target in targets
        )
        return csv_text(header, body)

    def document(self) -> SelectionDocument:
        """Return the JSON output."""
        return SelectionDocument(
            index=self.asked.index,
            value=self.selection.value,
            count=self.asked.count,
            measurements=sum(map(len, self.targets)),
            candidates=self.asked.candidates,
            drawn=self.drawn,
            exchanges=self.selection.exchanges,
            starts=self.asked.starts,
            model=self.asked.model,
            parameters=self.parameters,
            index_of_count=tuple(
                IndexOfCount(count=int(count), value=float(value))
                for count, value in zip(self.counts, self.values, strict=True)
            ),
        )


def select_poses(setup: PoseSetup, asked: Asked, progress: Progress) -> ChosenPoses:
    """Choose poses.

    Raises:
        InsufficientPointsError: too few poses for the model, or hardly a pose keeps the rules.
    """
    tried = draw_candidates(
        setup.arm,
        setup.rules,
        asked.candidates,
        asked.seed,
        lambda n, of: progress("candidates", n, of, f"{n} of {of}"),
    )
    shown = pose_rows(setup.arm, tried.joints, tried.targets, asked.model, frames=setup.frames)
    chosen = select(
        shown.rows,
        asked.count,
        asked.index,
        asked.starts,
        asked.seed,
        lambda n, of, best: progress("exchange", n, of, f"start {n} of {of}, {asked.index} {best:.4g}"),
        shown.known,
    )
    counts, values = _growth(shown, asked, progress)
    names = [one.name for one in setup.arm.targets]
    return ChosenPoses(
        asked,
        setup.units,
        tried.joints[chosen.chosen],
        tuple(tuple(names[k] for k in own if k >= 0) for own in tried.targets[chosen.chosen].tolist()),
        chosen,
        tried.drawn,
        shown.names,
        counts,
        values,
    )


def _growth(shown: PoseRows, asked: Asked, progress: Progress) -> tuple[Ints, Floats]:
    """Return numbers of poses, and the index that each reaches."""
    counts = _counts(asked.count, fewest_poses(shown.rows, shown.known), len(shown.rows))
    values = np.zeros(len(counts))
    for k, number in enumerate(counts.tolist()):
        values[k : k + 1] = growth(shown.rows, counts[k : k + 1], asked.index, asked.seed, shown.known)
        progress("index", k + 1, len(counts), f"{number} poses, {asked.index} {values[k]:.4g}")
    return counts, values


def selection_report(found: ChosenPoses, arm: str) -> Report:
    """Return what is said of a choice."""
    known = found.document()
    columns = (
        Column("count", "poses", "", COUNT),
        Column("value", known.index, "", THREE_DIGITS),
        Column("share", "of the chosen number's", "", fixed(2)),
    )
    rows = tuple((one.count, one.value, one.value / known.value) for one in known.index_of_count)
    table = Table("growth", "Index against the number of poses, one start each", columns, rows)
    said = (Statement(Sign.GOOD, known.text), Statement(Sign.NEUTRAL, ADVICE))
    blocks: list[Block] = [*said, table, known.figure()]
    return Report(f"Poses for {arm}", origin_now(), (section("poses", "Poses", blocks, brief=True),))


def _counts(count: int, fewest: int, candidates: int) -> Ints:
    """Return numbers of poses from what the parameters need to twice the chosen number."""
    wanted = np.array([fewest, fewest + 4, (fewest + count) // 2, count, 3 * count // 2, 2 * count])
    return np.unique(wanted[(wanted >= fewest) & (wanted <= candidates)])
