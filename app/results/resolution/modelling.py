"""Joint models from results of motion resolution, and what is said of them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np

from catseye.app.cluster.share import Share, map_quick
from catseye.app.errors import MeasurementRejectedError, UsageError
from catseye.app.results.document import Document
from catseye.app.results.model import Column, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import COUNT, Format, counted, listed
from catseye.app.results.origin import origin_now
from catseye.app.results.resolution.naming import title
from catseye.app.results.resolution.result import AnyTest, ResolutionResult, read_resolution
from catseye.calibration.resolution.measured_steps import FEWEST, MeasuredSteps
from catseye.calibration.resolution.tables import JointTable

_MANY: Final = 6
"""Models of which none is tried here first, where others may fit them: each takes half a second."""


@dataclass(frozen=True)
class JointData:
    """What is known of one joint in one direction.

    Attributes:
        steps: measured ones.
        reversals: lost motion by position, deg or mm, valid ones only.
    """

    steps: MeasuredSteps
    reversals: dict[float, float]


@dataclass(frozen=True)
class ModelledArm:
    """Tables of an arm.

    Attributes:
        arm: its name.
        data: what each table is made of.
        tables: in the same order.
        simulated: a result is one of emulated devices.
        warnings: what a user of the tables has to know.
    """

    arm: str
    data: tuple[JointData, ...]
    tables: tuple[JointTable, ...]
    simulated: bool
    warnings: tuple[str, ...]


def model_arm(
    paths: Sequence[Path], share: Share, done: Callable[[int, int], None] | None = None
) -> ModelledArm:
    """Return the tables that results give.

    Args:
        paths: of results, all of one arm.
        share: who fits the models.
        done: is called with the number of finished models and of all.

    Raises:
        UsageError: a file is no result, they are of several arms, a test does not say where it was made, or all its
            steps are longer by a mistake that its evaluation names.
        MeasurementRejectedError: no joint has enough steps.
    """
    results = [(path, read_resolution(path)) for path in paths]
    arm = _arm_of(results)
    data = _joint_data(results)
    few = [one for one in data if one.steps.commands.size < FEWEST]
    enough = [one for one in data if one.steps.commands.size >= FEWEST]
    if not enough:
        raise MeasurementRejectedError(
            f"no joint has {FEWEST} steps with an error: give results of decaying tests of whole series"
        )
    carried_out = share.map if len(enough) >= _MANY else partial(map_quick, share)
    tables = carried_out(_table_of, enough, None if done is None else lambda n: done(n, len(enough)))
    return ModelledArm(
        arm,
        tuple(enough),
        tuple(tables),
        any(result.provenance is not None and result.provenance.simulated for _, result in results),
        (*_shipped(results), *_without_least_step(results), *_warnings(few, tables)),
    )


def _table_of(data: JointData) -> JointTable:
    # Imported by whoever fits: it takes longer than a model.
    from catseye.calibration.resolution.joint_model import JointModel, table_of

    return table_of(JointModel(data.steps), data.reversals)


def _arm_of(results: Sequence[tuple[Path, ResolutionResult]]) -> str:
    (first, result), *others = results
    for path, other in others:
        if other.arm != result.arm:
            raise UsageError(
                f"{path} is of the arm {other.arm}, and {first} of {result.arm}: make tables of one arm at a time"
            )
    return result.arm


def _joint_data(results: Sequence[tuple[Path, ResolutionResult]]) -> list[JointData]:
    """Return what the tests say, by joint and direction in their first order."""
    rows: dict[tuple[str, int], list[tuple[float, float, float]]] = {}
    reversals: dict[str, dict[float, list[float]]] = {}
    for path, test in ((path, test) for path, result in results for test in result.tests):
        if test.test == "decaying":
            _require_scale(path, test)
            direction, position = test.direction, _position(path, test)
            if direction is None:
                raise UsageError(f"{path}: a decaying test of {test.joint} states no direction: 1 or -1")
            rows.setdefault((test.joint, direction), []).extend(
                (position, abs(move.command), move.error_percent)
                for move in test.moves
                if move.error_percent is not None and move.judged
            )
        elif test.reversal is not None and test.reversal.valid:
            of_joint = reversals.setdefault(test.joint, {})
            of_joint.setdefault(_position(path, test), []).append(max(test.reversal.value, 0.0))
    return [
        JointData(
            MeasuredSteps(joint, direction, *np.array(found, dtype=np.float64).reshape(-1, 3).T),
            {at: float(np.mean(values)) for at, values in reversals.get(joint, {}).items()},
        )
        for (joint, direction), found in rows.items()
    ]


def _position(path: Path, test: AnyTest) -> float:
    if test.position is None:
        raise UsageError(
            f"{path}: a {test.test} test of {test.joint} states no position: evaluate it again with --position-deg"
        )
    return test.position


def _require_scale(path: Path, test: AnyTest) -> None:
    if test.likely_mistake is not None:
        raise UsageError(
            f"{path}: {title(test)}: all steps are about {test.likely_mistake.factor:.3g} times those commanded, "
            f"likely because {test.likely_mistake.text}: correct it and evaluate the recording again, or leave this "
            "result out"
        )


def _without_least_step(results: Sequence[tuple[Path, ResolutionResult]]) -> list[str]:
    without = [
        title(test)
        for _, result in results
        for test in result.tests
        if test.test == "decaying" and test.lis is None
    ]
    if not without:
        return []
    return [
        f"{counted(len(without), 'test')} without a least step, whose errors may not be those of the joint: "
        f"{listed(without, 6)}; see what their results say, and leave them out if it is the measurement"
    ]


def _shipped(results: Sequence[tuple[Path, ResolutionResult]]) -> list[str]:
    shipped = sum(test.shipped for _, result in results for test in result.tests)
    if not shipped:
        return []
    return [
        f"{counted(shipped, 'test')} shipped with the program: the tables are not those of your arm alone"
    ]


def _warnings(few: Sequence[JointData], tables: Sequence[JointTable]) -> list[str]:
    texts = [
        f"{one.steps.name} has {one.steps.commands.size} steps with an error, and gets no table: {FEWEST} are needed"
        for one in few
    ]
    lacking = {table.joint for table in tables if all(one.reversal is None for one in table.sectors)}
    if lacking:
        texts.append(
            f"no valid reversal error of {listed(sorted(lacking), 8)}: predictions with --reversal leave them open"
        )
    alone = {table.joint for table in tables if len(table.sectors) == 1}
    if alone:
        texts.append(
            f"{listed(sorted(alone), 8)} tested at one position: the tables serve poses within 1 of it only"
        )
    return texts


_SIZE = Format("significant", 2)


class ModelPart(Document):
    """One table."""

    joint: str
    direction: int
    positions: list[float]
    steps: int
    smallest: float
    largest: float
    reversal: float | None


class ModelsDocument(Document):
    """What the models are made of, and the file that has them."""

    output: str
    arm: str
    models: list[ModelPart]
    warnings: list[str]


def model_document(modelled: ModelledArm, output: Path) -> ModelsDocument:
    """Return what the models are made of, as JSON has it."""
    parts = [
        ModelPart(
            joint=table.joint,
            direction=table.direction,
            positions=np.unique(one.steps.positions).tolist(),
            steps=one.steps.commands.size,
            smallest=float(one.steps.commands.min()),
            largest=float(one.steps.commands.max()),
            reversal=_mean([sector.reversal for sector in table.sectors if sector.reversal is not None]),
        )
        for one, table in zip(modelled.data, modelled.tables, strict=True)
    ]
    return ModelsDocument(
        output=str(output), arm=modelled.arm, models=parts, warnings=list(modelled.warnings)
    )


def model_report(modelled: ModelledArm) -> Report:
    """Return what the models are made of and what they say."""
    columns = (
        Column("joint", "joint"),
        Column("direction", "direction"),
        Column("positions", "positions", format=COUNT),
        Column("steps", "steps", format=COUNT),
        Column("smallest", "smallest step", "deg or mm", _SIZE),
        Column("largest", "largest step", "deg or mm", _SIZE),
        Column("scatter_smallest_percent", "scatter of the smallest", "%", _SIZE),
        Column("scatter_largest_percent", "scatter of the largest", "%", _SIZE),
        Column("reversal", "reversal error", "deg or mm", _SIZE),
    )
    rows = tuple(
        (
            table.joint,
            f"{table.direction:+d}",
            int(np.unique(one.steps.positions).size),
            int(one.steps.commands.size),
            float(one.steps.commands.min()),
            float(one.steps.commands.max()),
            _mean([float(sector.errors.scatter_percent[0]) for sector in table.sectors]),
            _mean([float(sector.errors.scatter_percent[-1]) for sector in table.sectors]),
            _mean([sector.reversal for sector in table.sectors if sector.reversal is not None]),
        )
        for one, table in zip(modelled.data, modelled.tables, strict=True)
    )
    return Report(
        f"Joint models of {modelled.arm}",
        origin_now(simulated=modelled.simulated),
        (
            section(
                "verdict",
                "Verdict",
                [Statement(Sign.ATTENTION, f"{t}.") for t in modelled.warnings],
                brief=True,
            ),
            section(
                "models", "Models", [Table("models", "Step errors of joints", columns, rows)], brief=True
            ),
        ),
    )


def _mean(values: Sequence[float]) -> float | None:
    return float(np.mean(values)) if values else None
