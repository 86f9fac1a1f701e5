"""Likely mistakes in a table of poses: units, handedness, order or signs of joints, names of targets.

Measurements that fit the nominal arm badly are tried once more as each mistake would have made them; one that makes
them fit far better is named.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import permutations

import numpy as np

from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.closed_form import closed_form
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.identification import parameters_of
from catseye.calibration.serial_arm.measurements import Measurements
from catseye.calibration.serial_arm.model import ArmModel
from catseye.calibration.serial_arm.orientations import orientation_mistake, places_only

_SOUND_SHARE = 0.02
"""A nominal arm misses its targets by less than this share of its reach: a centimetre of half a metre."""

_FAR_BETTER = 0.2
"""Share of the misfit that is left when a mistake is found."""

_EXACT_MM = 1e-6
"""A misfit below this is rounding."""

_SMALL_SHARE = 0.02
"""Of the usual distance from the instrument: a place nearer than this may be in another unit."""

_TURN_RAD = 2.0 * np.pi
"""Angles of joints that are no larger may be in rad."""

_OTHER_ZEROS = (-90.0, 90.0, 180.0)
"""deg by which conventions put the zero of a joint elsewhere."""

_FEW_WRONG = 0.05
"""Share of the poses that may be so wrong that they hide how well the others fit."""

_MOST_TARGETS = 4
"""All orders of more targets are too many to try."""


class ImplausibleError(CalibrationError):
    """The table contradicts the arm; the likely mistake is named."""


@dataclass(frozen=True)
class _Mistake:
    """What may have gone wrong, and the measurements as they would be without it."""

    text: str
    measurements: Measurements


def require_plausible(arm: SerialArm, measurements: Measurements) -> None:
    """Refuse measurements that the arm cannot have given.

    Raises:
        ImplausibleError: the likely mistake, with the misfit before and after.
    """
    _require_no_copies(measurements)
    _require_other_joints(measurements)
    misfit, limit = _misfit_mm(arm, measurements), _SOUND_SHARE * _reach_mm(arm)
    if misfit == np.inf:
        # So few rows contradict nothing; identification says how many it wants.
        return
    if misfit < limit:
        _require_names(arm, measurements, misfit)
        if text := orientation_mistake(arm, measurements):
            raise ImplausibleError(text)
        return
    found = [
        (_misfit_mm(arm, one.measurements), k, one.text) for k, one in enumerate(_mistakes(arm, measurements))
    ]
    left, _, text = min(found)
    if left < max(_FAR_BETTER * misfit, _EXACT_MM):
        raise ImplausibleError(
            f"the nominal arm misses the measured places by {misfit:.3g} mm rms, and by {left:.3g} mm if {text}: "
            "put the table right"
        )
    raise ImplausibleError(
        f"the nominal arm misses the measured places by {misfit:.3g} mm rms, more than an arm of "
        f"{_reach_mm(arm):.0f} mm is wrong by: another arm, joints at other poses than measured, or targets of "
        "another tool. Check the arm description, the tool and which row belongs to which pose"
    )


def _require_names(arm: SerialArm, rows: Measurements, misfit: float) -> None:
    """Refuse exchanged names of targets, which a small tool hides below what an arm may be wrong by."""
    for one in _renamed(arm, rows):
        left = _misfit_mm(arm, one.measurements)
        if left < _FAR_BETTER * misfit and misfit > _EXACT_MM:
            raise ImplausibleError(
                f"the nominal arm misses the measured places by {misfit:.3g} mm rms, and by {left:.3g} mm if "
                f"{one.text}: put the table right"
            )


def _require_no_copies(rows: Measurements) -> None:
    """Refuse rows that stand twice to the last digit: no instrument measures the same numbers again."""
    points = rows.points
    table = np.column_stack([rows.commands.joints[points.pose], points.target, points.place_mm])
    _, first, number = np.unique(table, axis=0, return_index=True, return_inverse=True)
    copies = np.flatnonzero(first[number.ravel()] != np.arange(len(table)))
    if copies.size:
        one, other = (rows.names[points.pose[k]] for k in (first[number.ravel()[copies[0]]], copies[0]))
        raise ImplausibleError(
            f"{copies.size} rows repeat others to the last digit (the first: pose {other!r} repeats {one!r}): no "
            "instrument measures the same numbers again. Remove the copies"
        )


def _require_other_joints(rows: Measurements) -> None:
    """Refuse poses of which all have the same joints."""
    joints = rows.commands.joints
    if len(joints) > 1 and not np.ptp(joints, axis=0).any():
        raise ImplausibleError(
            f"all {len(joints)} poses have the same joints: look whether each row has the joints of its own pose"
        )


def _mistakes(arm: SerialArm, rows: Measurements) -> Iterator[_Mistake]:
    joints = rows.commands.joints
    if np.abs(joints).max() <= _TURN_RAD:
        turned = _moved(arm, rows, np.rad2deg(joints))
        yield _Mistake("the joints are in rad, not in deg", turned)
        yield _Mistake("the joints are in rad and the coordinates in m", _scaled(turned, 1000.0))
    else:
        yield from _mixed_angles(arm, rows)
    yield _Mistake("the coordinates are in m, not in mm", _scaled(rows, 1000.0))
    yield from _mixed_lengths(rows)
    yield _Mistake("the coordinates are in inches, not in mm", _scaled(rows, 25.4))
    yield _Mistake("the coordinates are in µm, not in mm", _scaled(rows, 0.001))
    if len(rows.points.pose):
        yield _Mistake("the frame of the instrument is left-handed", _mirrored(rows))
    count, names = joints.shape[1], arm.joint_names
    yield _Mistake("the joints stand in the opposite order", _moved(arm, rows, joints[:, ::-1]))
    for i in range(count):
        for j in range(i + 1, count):
            order = list(range(count))
            order[i], order[j] = order[j], order[i]
            yield _Mistake(f"{names[i]} and {names[j]} are exchanged", _moved(arm, rows, joints[:, order]))
    for i in range(count):
        signs = np.where(np.arange(count) == i, -1.0, 1.0)
        yield _Mistake(f"{names[i]} has the opposite sign", _moved(arm, rows, joints * signs))
    yield _Mistake("the rows are one pose late", _moved(arm, rows, np.roll(joints, 1, axis=0)))
    yield _Mistake("the rows are one pose early", _moved(arm, rows, np.roll(joints, -1, axis=0)))
    for i in range(count):
        for zero in _OTHER_ZEROS if arm.chain.joints[i].kind == "revolute" else ():
            shift = np.where(np.arange(count) == i, zero, 0.0)
            yield _Mistake(
                f"{names[i]} counts from a zero {zero:g} deg away", _moved(arm, rows, joints + shift)
            )
    yield from _renamed(arm, rows)
    yield from _without_wrong(arm, rows)


def _mixed_angles(arm: SerialArm, rows: Measurements) -> Iterator[_Mistake]:
    """Give each joint that may be the only one in rad, and the poses that may be while the others are in deg."""
    joints = rows.commands.joints
    turns = np.array([one.kind == "revolute" for one in arm.chain.joints])
    small = turns & (np.abs(joints) <= _TURN_RAD)
    for number in np.flatnonzero(small.all(axis=0)):
        turned = np.where(np.arange(len(turns)) == number, np.rad2deg(joints), joints)
        yield _Mistake(f"{arm.joint_names[number]} is in rad, not in deg", _moved(arm, rows, turned))
    poses = small[:, turns].all(axis=1)
    if poses.any():
        first, turned = rows.names[int(np.argmax(poses))], joints.copy()
        turned[np.ix_(poses, turns)] = np.rad2deg(joints[np.ix_(poses, turns)])
        yield _Mistake(
            f"the joints of {np.count_nonzero(poses)} poses are in rad, not in deg (the first: pose {first!r})",
            _moved(arm, rows, turned),
        )


def _without_wrong(arm: SerialArm, rows: Measurements) -> Iterator[_Mistake]:
    """Leave out the pose that is missed most, again and again, while few are gone."""
    numbers = np.unique(rows.points.pose)
    kept = np.ones(len(rows.commands), dtype=np.bool_)
    for _ in range(int(_FEW_WRONG * len(numbers))):
        found = _missed_mm(arm, rows.at(kept))
        if found is None:
            return
        kept[max(found, key=lambda pose: found[pose])] = False
        if _misfit_mm(arm, rows.at(kept)) < _SOUND_SHARE * _reach_mm(arm):
            left_out = ", ".join(repr(rows.names[k]) for k in np.flatnonzero(~kept))
            yield _Mistake(f"{left_out} {'is' if (~kept).sum() == 1 else 'are'} left out", rows.at(kept))
            return


def _missed_mm(arm: SerialArm, rows: Measurements) -> dict[int, float] | None:
    """Return by how much the nominal arm misses the places of each pose; None where nothing is found from them."""
    residuals = _residuals_mm(*places_only(arm, rows))
    if residuals is None:
        return None
    sizes = np.linalg.norm(residuals[: 3 * len(rows.points.pose)].reshape(-1, 3), axis=1)
    found: dict[int, float] = {}
    for pose, size in zip(rows.points.pose.tolist(), sizes.tolist(), strict=True):
        found[pose] = max(size, found.get(pose, 0.0))
    return found


def _mixed_lengths(rows: Measurements) -> Iterator[_Mistake]:
    """Give the rows whose places are in m while the others are in mm."""
    places = rows.points.place_mm
    if not len(places):
        return
    away = np.linalg.norm(places, axis=1)
    small = away < _SMALL_SHARE * np.median(away)
    if small.any():
        first = rows.names[rows.points.pose[int(np.argmax(small))]]
        scaled = np.where(small[:, None], 1000.0, 1.0) * places
        yield _Mistake(
            f"the places of {np.count_nonzero(small)} rows are in m, not in mm (the first: pose {first!r})",
            replace(rows, points=replace(rows.points, place_mm=scaled)),
        )


def _renamed(arm: SerialArm, rows: Measurements) -> Iterator[_Mistake]:
    used = rows.targets
    if not 1 < len(used) <= _MOST_TARGETS:
        return
    for order in permutations(used):
        if order == used:
            continue
        to = np.arange(len(arm.targets))
        to[list(used)] = order
        swapped = ", ".join(
            f"{arm.targets[a].name} is {arm.targets[b].name}"
            for a, b in zip(used, order, strict=True)
            if a != b
        )
        yield _Mistake(
            f"the names of the targets are mixed up ({swapped})",
            replace(
                rows,
                points=replace(rows.points, target=to[rows.points.target]),
                distances=replace(rows.distances, target=to[rows.distances.target]),
            ),
        )


def _moved(arm: SerialArm, rows: Measurements, joints: Floats) -> Measurements:
    return replace(rows, commands=Commands.of(arm, joints, rows.commands.approach))


def _scaled(rows: Measurements, factor: float) -> Measurements:
    points = replace(rows.points, place_mm=factor * rows.points.place_mm)
    distances = replace(rows.distances, distance_mm=factor * rows.distances.distance_mm)
    return replace(rows, points=points, distances=distances)


def _mirrored(rows: Measurements) -> Measurements:
    mirror = np.array([1.0, 1.0, -1.0])
    return replace(rows, points=replace(rows.points, place_mm=mirror * rows.points.place_mm))


def _misfit_mm(arm: SerialArm, rows: Measurements) -> float:
    """Return how far the nominal arm is off, with base, unknown targets and anchors in closed form, rms."""
    if len(rows.points.pose):
        arm, rows = places_only(arm, rows)
    residuals = _residuals_mm(arm, rows)
    return np.inf if residuals is None else float(np.sqrt(np.mean(np.square(residuals))))


def _residuals_mm(arm: SerialArm, rows: Measurements) -> Floats | None:
    """Return the residuals of the nominal arm; None where the rows do not put it anywhere."""
    try:
        start = closed_form(arm, rows)
    except CalibrationError:
        return None
    model = ArmModel(arm, start.frame, parameters_of(arm, rows, "frames"), rows)
    return model.residuals(model.start_values(start))[: model.measured_rows]


def _reach_mm(arm: SerialArm) -> float:
    return sum(abs(joint.a_mm) + joint.longest_mm for joint in arm.chain.joints)
