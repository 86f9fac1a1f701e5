"""What instruments say of an arm: points, whole poses and distances, each with its covariance."""

from dataclasses import dataclass, field

import numpy as np

from catseye.calibration.core.arguments import require_finite, require_shape
from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.serial_arm.arm import Anchor
from catseye.calibration.serial_arm.geometry import Commands


def _no_numbers() -> Ints:
    return np.zeros(0, dtype=np.int64)


@dataclass(frozen=True)
class MeasuredPoints:
    """Targets that a tracker measured, m rows.

    Attributes:
        pose: number of each row's pose, shape (m,).
        target: number of each row's target, shape (m,).
        place_mm: in the frame of the instrument, shape (m, 3).
        covariance_mm2: of the coordinates, shape (m, 3, 3); None where none is stated.
    """

    pose: Ints = field(default_factory=_no_numbers)
    target: Ints = field(default_factory=_no_numbers)
    place_mm: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    covariance_mm2: Floats | None = None

    def __post_init__(self) -> None:
        require_shape(self.target, self.pose.shape, "target")
        require_shape(self.place_mm, (len(self.pose), 3), "place_mm")
        require_finite(self.place_mm, "place_mm")
        if self.covariance_mm2 is not None:
            _require_covariances(self.covariance_mm2, len(self.pose))

    def some(self, kept: Bools) -> "MeasuredPoints":
        """Return some of the rows."""
        covariance = None if self.covariance_mm2 is None else self.covariance_mm2[kept]
        return MeasuredPoints(self.pose[kept], self.target[kept], self.place_mm[kept], covariance)


@dataclass(frozen=True)
class MeasuredOrientations:
    """Orientations of a frame on the flange that an optical CMM measured, beside the place of its origin.

    Attributes:
        pose: number of each row's pose, shape (m,).
        target: number of each row's frame among the targets, shape (m,).
        rotation: into the frame of the instrument, shape (m, 3, 3).
        u_deg: standard uncertainty of each angle, shape (m,); None where none is stated.
    """

    pose: Ints = field(default_factory=_no_numbers)
    target: Ints = field(default_factory=_no_numbers)
    rotation: Floats = field(default_factory=lambda: np.zeros((0, 3, 3)))
    u_deg: Floats | None = None

    def some(self, kept: Bools) -> "MeasuredOrientations":
        """Return some of the rows."""
        u_deg = None if self.u_deg is None else self.u_deg[kept]
        return MeasuredOrientations(self.pose[kept], self.target[kept], self.rotation[kept], u_deg)


@dataclass(frozen=True)
class MeasuredDistances:
    """Distances from targets to anchors, by interferometer or ballbar.

    Attributes:
        pose: number of each row's pose, shape (m,).
        target: number of each row's target, shape (m,).
        anchor: number of each row's anchor, shape (m,).
        segment: number of each row's segment, whose distances share an unknown dead path; −1 of an absolute one.
        distance_mm: shape (m,).
        u_mm: standard uncertainties, shape (m,); None where none is stated.
        anchors: by number.
        segments: names by number.
    """

    pose: Ints = field(default_factory=_no_numbers)
    target: Ints = field(default_factory=_no_numbers)
    anchor: Ints = field(default_factory=_no_numbers)
    segment: Ints = field(default_factory=_no_numbers)
    distance_mm: Floats = field(default_factory=lambda: np.zeros(0))
    u_mm: Floats | None = None
    anchors: tuple[Anchor, ...] = ()
    segments: tuple[str, ...] = ()

    def some(self, kept: Bools) -> "MeasuredDistances":
        """Return some of the rows, with all anchors and segments."""
        return MeasuredDistances(
            self.pose[kept],
            self.target[kept],
            self.anchor[kept],
            self.segment[kept],
            self.distance_mm[kept],
            None if self.u_mm is None else self.u_mm[kept],
            self.anchors,
            self.segments,
        )


@dataclass(frozen=True)
class Measurements:
    """Everything that was measured at the poses of an arm.

    Attributes:
        commands: the poses.
        names: of the poses.
    """

    commands: Commands
    names: tuple[str, ...]
    points: MeasuredPoints = field(default_factory=MeasuredPoints)
    orientations: MeasuredOrientations = field(default_factory=MeasuredOrientations)
    distances: MeasuredDistances = field(default_factory=MeasuredDistances)

    def __post_init__(self) -> None:
        if len(self.names) != len(self.commands):
            raise ArgumentError(
                f"{len(self.names)} names of {len(self.commands)} poses: give each pose its name"
            )
        if not (len(self.points.pose) + len(self.distances.pose)):
            raise ArgumentError("nothing was measured: give places of targets or distances to them")

    def everywhere(self, commands: Commands) -> "Measurements":
        """Return the same kinds of rows at other poses, with nothing in them: what such measurements could show."""
        count = len(commands)
        kinds = np.unique(self.points.target), np.unique(self.orientations.target)
        lines = np.unique(
            np.column_stack([self.distances.target, self.distances.anchor, self.distances.segment]), axis=0
        )
        pose, line = np.tile(np.arange(count), len(lines)), np.repeat(lines, count, axis=0)
        return Measurements(
            commands,
            tuple(map(str, range(count))),
            MeasuredPoints(*_crossed(count, kinds[0]), np.zeros((count * len(kinds[0]), 3))),
            MeasuredOrientations(
                *_crossed(count, kinds[1]), np.tile(np.eye(3), (count * len(kinds[1]), 1, 1))
            ),
            MeasuredDistances(
                pose,
                line[:, 0],
                line[:, 1],
                line[:, 2],
                np.zeros(len(pose)),
                None,
                self.distances.anchors,
                self.distances.segments,
            ),
        )

    @property
    def stated(self) -> bool:
        """Every row states its uncertainty."""
        return not any(
            len(rows.pose) and stated is None
            for rows, stated in (
                (self.points, self.points.covariance_mm2),
                (self.orientations, self.orientations.u_deg),
                (self.distances, self.distances.u_mm),
            )
        )

    @property
    def poses(self) -> Ints:
        """Numbers of the poses that something was measured at, with repetitions."""
        return np.concatenate([self.points.pose, self.orientations.pose, self.distances.pose])

    @property
    def targets(self) -> tuple[int, ...]:
        """Numbers of the targets that were measured."""
        used = np.concatenate([self.points.target, self.orientations.target, self.distances.target])
        return tuple(np.unique(used).tolist())

    def at(self, kept: Bools) -> "Measurements":
        """Return what was measured at some poses; the poses keep their numbers.

        Args:
            kept: flags of the poses, shape (n,).
        """
        points, orientations, distances = self.points, self.orientations, self.distances
        return Measurements(
            self.commands,
            self.names,
            points.some(kept[points.pose]),
            orientations.some(kept[orientations.pose]),
            distances.some(kept[distances.pose]),
        )


def _crossed(poses: int, targets: Ints) -> tuple[Ints, Ints]:
    """Return numbers of poses and targets of every target at every pose."""
    return np.tile(np.arange(poses), len(targets)), np.repeat(targets, poses)


def _require_covariances(covariance_mm2: Floats, rows: int) -> None:
    require_shape(covariance_mm2, (rows, 3, 3), "covariance_mm2")
    sound = np.isfinite(covariance_mm2).all(axis=(1, 2))
    if rows and sound.all():
        sound = np.linalg.eigvalsh(covariance_mm2)[:, 0] > 0.0
    if not sound.all():
        raise ArgumentError(
            f"covariance_mm2: row {int(np.argmin(sound))} is not a covariance of three coordinates: it has to be "
            "finite and positive definite"
        )
