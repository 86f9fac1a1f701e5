"""Cartesian resolution at poses and over slices of the workspace, predicted place by place."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np

from catseye.app.cell.arm import ArmDescription
from catseye.app.cell.serial_arm import chain_of
from catseye.app.cluster.share import Share, map_quick
from catseye.app.files.poses import NamedPoses, poses_table, read_poses
from catseye.app.results.origin import now_utc
from catseye.app.results.resolution.joint_tables import read_joint_tables
from catseye.app.results.resolution.predicted import PredictedCurve, PredictedLeast, PredictedResolution
from catseye.app.store.software import SOFTWARE
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.resolution.cartesian_steps import DIRECTIONS
from catseye.calibration.resolution.predictor import (
    DirectionPrediction,
    PredictionMethod,
    predict_pose,
    unit_of,
)
from catseye.calibration.resolution.tables import ResolutionTables
from catseye.calibration.resolution.workspace_slice import AxisName, SliceAxis, SlicePoint, slice_points

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


@dataclass(frozen=True)
class Prediction:
    """What is to be predicted.

    Attributes:
        arm: its description.
        tables: file with look-up tables of its joints.
        poses: file.
        method: of the prediction.
        tool: the tool centre point in the last frame, shape (4, 4); None for that frame.
        axes: of a slice through the workspace, oriented as the first pose; None for the poses themselves.
        reversal: joints that reverse lose their reversal error.
    """

    arm: ArmDescription
    tables: Path
    poses: Path
    method: PredictionMethod
    tool: Floats | None = None
    axes: Mapping[AxisName, SliceAxis] | None = None
    reversal: bool = False


def predicted_resolution(
    asked: Prediction, share: Share, done: Callable[[int, int], None] | None = None
) -> PredictedResolution:
    """Return what is predicted, the same whoever shares the work.

    Args:
        done: is called with the number of finished places and of all.

    Raises:
        UsageError: a file is missing or wrong; names it and the line.
        ArgumentError: the slice does not fit.
    """
    known = read_joint_tables(asked.tables, [joint.name for joint in asked.arm.joint])
    named = read_poses(asked.poses, poses_table([joint.unit for joint in asked.arm.joint]))
    predictor = Predictor(chain_of(asked.arm), known.tables, asked.method, asked.tool)
    if asked.axes is None:
        places = places_of(named, reversal=asked.reversal)
    else:
        points = slice_points(predictor.chain, named.joints[0], asked.axes, asked.tool)
        places = places_of_slice(points, reversal=asked.reversal)
    return PredictedResolution(
        arm=asked.arm.name,
        tables=asked.tables.name,
        threshold_percent=asked.method.threshold_percent,
        draws=asked.method.draws,
        seed=asked.method.seed,
        simulated=known.simulated,
        software=SOFTWARE,
        created=now_utc(),
        least_steps=predict_places(predictor, places, share, done),
    )


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
) -> list[PredictedLeast]:
    """Return what is predicted of all directions at places, the same whoever shares the work.

    Args:
        done: is called with the number of finished places and of all.
    """
    chunks = [_Chunk(predictor, k, places[k : k + _CHUNK]) for k in range(0, len(places), _CHUNK)]
    told = None if done is None else lambda n: done(min(n * _CHUNK, len(places)), len(places))
    return [row for rows in map_quick(share, _predict_chunk, chunks, told) for row in rows]


def _predict_chunk(chunk: _Chunk) -> list[PredictedLeast]:
    return [
        row
        for number, place in enumerate(chunk.places, chunk.first)
        for row in _predict_place(chunk.predictor, place, number)
    ]


def _predict_place(predictor: Predictor, place: Place, number: int) -> list[PredictedLeast]:
    if place.joints is None:
        return [
            _least(place, DirectionPrediction.without_steps(direction, place.reason))
            for direction in DIRECTIONS
        ]
    found = predict_pose(
        predictor.chain,
        place.joints,
        predictor.tables,
        predictor.method,
        predictor.tool,
        place.approach,
        number,
    )
    return [_least(place, one) for one in found]


def _least(place: Place, found: DirectionPrediction) -> PredictedLeast:
    """Return a row of a prediction; the errors of single steps stay with poses, of which there are few."""
    keeps_curve = place.tcp_mm is None and found.steps.size > 0
    return PredictedLeast(
        pose=place.name,
        tcp_mm=None if place.tcp_mm is None else place.tcp_mm.tolist(),
        direction=found.direction,
        unit=unit_of(found.direction),
        lis=found.least.lis,
        low=found.least.low,
        high=found.least.high,
        reason=found.least.reason,
        curve=_curve(found) if keeps_curve else None,
    )


def _curve(found: DirectionPrediction) -> PredictedCurve:
    return PredictedCurve(
        command=found.steps.tolist(),
        mean_percent=found.mean_percent.tolist(),
        std_percent=found.std_percent.tolist(),
    )
