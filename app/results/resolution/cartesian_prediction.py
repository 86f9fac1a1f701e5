"""Cartesian resolution at poses and over slices of the workspace: predicted, written, told."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np

from catseye.app.cell.arm import ArmDescription
from catseye.app.cell.serial_arm import chain_of
from catseye.app.cluster.share import Share, map_quick
from catseye.app.files.atomic import write_atomically
from catseye.app.files.csv_text import OwnWord, csv_text
from catseye.app.files.poses import NamedPoses
from catseye.app.results.document import Document
from catseye.app.results.model import Column, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import Format, counted
from catseye.app.results.origin import origin_now
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.resolution.cartesian_steps import DIRECTIONS
from catseye.calibration.resolution.predictor import (
    PredictedStep,
    PredictionMethod,
    no_prediction,
    predict_pose,
    unit_of,
)
from catseye.calibration.resolution.tables import ResolutionTables
from catseye.calibration.resolution.workspace_slice import SlicePoint

_CHUNK: Final = 4
"""Poses that a worker is handed at once."""


@dataclass(frozen=True)
class Place:
    """Where the resolution is predicted.

    Attributes:
        name: of the pose.
        joints: deg or mm, shape (joints,); None of a place that the arm does not reach.
        approach: sense of each joint's last motion, 1, -1 or 0; None leaves reversals out.
        tcp_mm: of a point of a slice, shape (3,); None of a pose of a file.
        reason: why there are no joints.
    """

    name: str
    joints: Floats | None
    approach: Ints | None = None
    tcp_mm: Floats | None = None
    reason: str = ""


@dataclass(frozen=True)
class PredictedDirection:
    """One row of a prediction."""

    place: Place
    direction: str
    least: PredictedStep


@dataclass(frozen=True)
class Predictor:
    """What all places have in common.

    Attributes:
        chain: the arm.
        tables: of its joints.
        method: of the prediction.
        tool: the tool centre point in the last frame, shape (4, 4); None for that frame.
    """

    chain: Chain
    tables: ResolutionTables
    method: PredictionMethod
    tool: Floats | None


@dataclass(frozen=True)
class _Chunk:
    predictor: Predictor
    first: int
    places: Sequence[Place]


def places_of(poses: NamedPoses, *, reversal: bool) -> list[Place]:
    """Return the poses of a file; the sense of a joint's last motion follows from the pose before.

    A joint that did not move keeps its sense; before it first moves nobody knows it.
    """
    senses = np.sign(np.diff(poses.joints, axis=0, prepend=poses.joints[:1])).astype(np.int64)
    for before, after in pairwise(senses):
        after[after == 0] = before[after == 0]
    return [
        Place(name, joints, sense if reversal else None)
        for name, joints, sense in zip(poses.names, poses.joints, senses, strict=True)
    ]


def places_of_slice(points: Sequence[SlicePoint], *, reversal: bool) -> list[Place]:
    """Return the points of a slice; how the arm came to them is not known."""
    return [
        Place(
            f"M{number}",
            point.joints,
            np.zeros(point.joints.size, dtype=np.int64) if reversal and point.joints is not None else None,
            point.tcp_mm,
            point.reason,
        )
        for number, point in enumerate(points, 1)
    ]


def predict_places(
    predictor: Predictor,
    places: Sequence[Place],
    share: Share,
    done: Callable[[int, int], None] | None = None,
) -> list[PredictedDirection]:
    """Return what is predicted of all directions at places, the same whoever shares the work.

    Args:
        done: is called with the number of finished places and of all.
    """
    chunks = [_Chunk(predictor, k, places[k : k + _CHUNK]) for k in range(0, len(places), _CHUNK)]
    told = None if done is None else lambda n: done(min(n * _CHUNK, len(places)), len(places))
    return [row for rows in map_quick(share, _predict_chunk, chunks, told) for row in rows]


def _predict_chunk(chunk: _Chunk) -> list[PredictedDirection]:
    return [
        row
        for number, place in enumerate(chunk.places, chunk.first)
        for row in _predict_place(chunk.predictor, place, number)
    ]


def _predict_place(predictor: Predictor, place: Place, number: int) -> list[PredictedDirection]:
    if place.joints is None:
        return [PredictedDirection(place, direction, no_prediction(place.reason)) for direction in DIRECTIONS]
    found = predict_pose(
        predictor.chain,
        place.joints,
        predictor.tables,
        predictor.method,
        predictor.tool,
        place.approach,
        number,
    )
    return [PredictedDirection(place, one.direction, one.least) for one in found]


def write_predicted_steps(rows: Sequence[PredictedDirection], output: Path) -> None:
    """Write the predicted CSV; of a slice with the places of its points."""
    on_map = rows[0].place.tcp_mm is not None
    places = ("x_mm", "y_mm", "z_mm") if on_map else ()
    cells = (
        [
            row.place.name,
            *(f"{value:.6g}" for value in (() if row.place.tcp_mm is None else row.place.tcp_mm)),
            OwnWord(row.direction),
            *(
                "" if value is None else f"{value:.6g}"
                for value in (row.least.lis, row.least.low, row.least.high)
            ),
            unit_of(row.direction),
            row.least.reason,
        ]
        for row in rows
    )
    write_atomically(
        output, csv_text(("pose", *places, "direction", "lis", "low", "high", "unit", "reason"), cells)
    )


class LeastStepPart(Document):
    """One direction at one place; numbers in its unit."""

    pose: str
    tcp_mm: list[float] | None
    direction: str
    unit: str
    lis: float | None
    low: float | None
    high: float | None
    reason: str


class PredictionDocument(Document):
    """Everything that is predicted."""

    least_steps: list[LeastStepPart]


def prediction_document(rows: Sequence[PredictedDirection]) -> PredictionDocument:
    """Return what is predicted, as JSON has it."""
    return PredictionDocument(
        least_steps=[
            LeastStepPart(
                pose=row.place.name,
                tcp_mm=None if row.place.tcp_mm is None else row.place.tcp_mm.tolist(),
                direction=row.direction,
                unit=unit_of(row.direction),
                lis=row.least.lis,
                low=row.least.low,
                high=row.least.high,
                reason=row.least.reason,
            )
            for row in rows
        ]
    )


_SIZE: Final = Format("significant", 2)


def prediction_report(arm: ArmDescription, rows: Sequence[PredictedDirection], tables: Path) -> Report:
    """Return what is predicted, with how much is left open."""
    open_rows = [row for row in rows if row.least.lis is None]
    statements = [
        Statement(
            Sign.NEUTRAL,
            f"{arm.name}: {len(rows) - len(open_rows)} of {counted(len(rows), 'direction')} predicted with {tables}.",
        )
    ]
    if open_rows:
        first = open_rows[0]
        statements.append(
            Statement(
                Sign.ATTENTION,
                f"{counted(len(open_rows), 'direction')} without a number, first {first.direction} at pose "
                f"{first.place.name}: {first.least.reason}. The file gives the reason of each.",
            )
        )
    return Report(
        "Predicted Cartesian resolution",
        origin_now(),
        (
            section("verdict", "Verdict", statements, brief=True),
            section("steps", "Least increment steps", [_table(rows)], brief=True),
        ),
    )


_MOST_ROWS = 60
"""A table of a slice stands in the file, not on the terminal."""


def _table(rows: Sequence[PredictedDirection]) -> Table | None:
    if len(rows) > _MOST_ROWS:
        return None
    columns = (
        Column("pose", "pose"),
        Column("direction", "direction"),
        Column("lis", "least step", format=_SIZE),
        Column("low", "low", format=_SIZE),
        Column("high", "high", format=_SIZE),
        Column("unit", "unit"),
    )
    cells = tuple(
        (row.place.name, row.direction, row.least.lis, row.least.low, row.least.high, unit_of(row.direction))
        for row in rows
    )
    return Table("least_steps", "Predicted least increment steps with their 95 % intervals", columns, cells)


def predictor_of(
    arm: ArmDescription, tables: ResolutionTables, method: PredictionMethod, tool: Floats | None
) -> Predictor:
    """Return what predicts for an arm."""
    return Predictor(chain_of(arm), tables, method, tool)
