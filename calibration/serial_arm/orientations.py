"""Likely mistakes in measured orientations: units, order and sense of the angles.

Seen from the flange, a frame of the tool has one orientation, whatever the pose; angles that were written otherwise
scatter.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.rotations import angles_of, rotation_of, rotation_vectors_deg
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.closed_form import closed_form
from catseye.calibration.serial_arm.measurements import MeasuredOrientations, Measurements

_SOUND_DEG = 5.0
"""A nominal arm holds its flange turned by less than this."""

_FAR_BETTER = 0.2
"""Share of the scatter that is left when a mistake is found."""

_FEWEST = 4
"""Orientations that show a scatter."""


def orientation_mistake(arm: SerialArm, measurements: Measurements) -> str:
    """Return what is likely wrong with the orientations of a table, as a sentence; empty when nothing is.

    The places of the table have to fit the arm already: they say where its base is.
    """
    rows = measurements.orientations
    if len(rows.pose) < _FEWEST or not len(measurements.points.pose):
        return ""
    base = closed_form(*places_only(arm, measurements)).frame
    flange = (base @ arm.chain.flange(measurements.commands.joints))[rows.pose, :3, :3]
    scatter = _scatter_deg(flange, rows, rows.rotation)
    if scatter < _SOUND_DEG:
        return ""
    said = f"the measured orientations scatter by {scatter:.3g}° about those of the nominal arm"
    left, text = min((_scatter_deg(flange, rows, one), text) for text, one in _mistakes(rows.rotation))
    if left < _FAR_BETTER * scatter:
        return f"{said}, and by {left:.3g}° if {text}: put the table right"
    return (
        f"{said}: rx_deg, ry_deg, rz_deg are angles of R = Rz·Ry·Rx from the frame of the target into that of the "
        "instrument; see how the instrument's program states them (quaternions, angles about other axes), or leave "
        "the columns out"
    )


def places_only(arm: SerialArm, measurements: Measurements) -> tuple[SerialArm, Measurements]:
    """Return an arm and its measurements without orientations."""
    targets = tuple(replace(target, turned=False) for target in arm.targets)
    return arm.with_targets(targets), replace(measurements, orientations=MeasuredOrientations())


def _mistakes(rotation: Floats) -> Iterator[tuple[str, Floats]]:
    """Give what may have gone wrong, and the rotations as they would be without it."""
    angles = angles_of(rotation)
    if np.abs(np.deg2rad(angles)).max() <= np.deg2rad(2.0 * np.pi):
        yield "rx_deg, ry_deg and rz_deg are in rad", rotation_of(np.rad2deg(angles))
    yield "they are those of the instrument in the frame of the target", rotation.transpose(0, 2, 1)
    yield "they are angles of R = Rx·Ry·Rz", _about_moved_axes(angles)
    yield "rx_deg and rz_deg are exchanged", rotation_of(angles[:, ::-1])
    yield "rx_deg, ry_deg and rz_deg have the opposite sign", rotation_of(-angles)
    mirror = np.diag([1.0, 1.0, -1.0])
    yield "the frame of the instrument is left-handed", mirror @ rotation @ mirror


def _about_moved_axes(angles_deg: Floats) -> Floats:
    turns = [rotation_of(angles_deg * np.eye(3)[axis]) for axis in range(3)]
    return np.asarray(turns[0] @ turns[1] @ turns[2])


def _scatter_deg(flange: Floats, rows: MeasuredOrientations, rotation: Floats) -> float:
    """Return how far the frames of the tool, seen from the flange, are from their means, rms, deg."""
    seen = flange.transpose(0, 2, 1) @ rotation
    apart = []
    for target in np.unique(rows.target):
        own = seen[rows.target == target]
        left, _, right = np.linalg.svd(own.sum(axis=0))
        handed = np.array([1.0, 1.0, np.sign(np.linalg.det(left @ right))])
        apart.append(rotation_vectors_deg(((left * handed) @ right).T @ own))
    return float(np.sqrt(np.mean(np.sum(np.square(np.concatenate(apart)), axis=1))))
