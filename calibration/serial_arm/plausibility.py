"""Likely mistakes in a table of poses: units, handedness, order or signs of joints, names of targets.

Measurements that fit the nominal arm badly are tried once more as each mistake would have made them. One is named if
they fit without it, and far better.
"""

from collections.abc import Iterator

import numpy as np

from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.kinematics.joint_ranges import beyond_text, ranges_of, within
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.combined_mistakes import combined_mistakes, other_order
from catseye.calibration.serial_arm.measurements import Measurements
from catseye.calibration.serial_arm.misfit import fits, misfit_mm, reach_mm
from catseye.calibration.serial_arm.mistakes import Mistake, renamed, single_mistakes
from catseye.calibration.serial_arm.orientations import orientation_mistake
from catseye.calibration.serial_arm.read_back import read_back_mistake
from catseye.calibration.serial_arm.several_tables import Tables, mistake_between
from catseye.calibration.serial_arm.stated_errors import in_other_unit

_FAR_BETTER = 0.2
"""Share of the misfit that is left when a mistake is found."""

_EXACT_MM = 1e-6
"""A misfit below this is rounding."""

_READ = 0.01
"""deg or mm beyond the end of a range that a joint may be written down."""

_CHANCE = 0.5
"""Of repeated rows at most this share agrees to the last digit by chance."""

_FEW = 3
_TIMES = 3.0
"""So many agree at most beside those that are expected to, and so many times these."""

_NEVER = 1e-3
"""Fewer expected ones are none."""


class ImplausibleError(CalibrationError):
    """The table contradicts the arm; the likely mistake is named."""


def require_plausible(
    arm: SerialArm,
    measurements: Measurements,
    read_back: Floats | None = None,
    tables: Tables | None = None,
) -> None:
    """Refuse measurements that the arm cannot have given.

    Args:
        read_back: joints as the controller said them at the poses, deg or mm, shape (n, joints).
        tables: that the rows are from; None for one.

    Raises:
        ImplausibleError: the likely mistake, with the misfit before and after.
    """
    _require_no_copies(measurements)
    _require_other_joints(measurements)
    if text := in_other_unit(measurements):
        raise ImplausibleError(text)
    if tables is not None and (text := mistake_between(arm, measurements, tables)):
        raise ImplausibleError(text)
    require_of_arm(arm, measurements)
    joints = measurements.commands.joints
    if read_back is not None and (text := read_back_mistake(arm, joints, read_back, measurements.names)):
        raise ImplausibleError(text)


def require_of_arm(arm: SerialArm, measurements: Measurements) -> None:
    """Refuse measurements that the arm does not fit, wherever it stands.

    Raises:
        ImplausibleError: the mistake without which it fits, where there is one.
    """
    misfit = misfit_mm(arm, measurements)
    if misfit == np.inf:
        # So few rows contradict nothing; identification says how many it wants.
        return
    if fits(arm, misfit):
        _require_names(arm, measurements, misfit)
        if text := orientation_mistake(arm, measurements):
            raise ImplausibleError(text)
        return
    for mistakes in (single_mistakes, combined_mistakes, other_order):
        left, text = _least(arm, mistakes(arm, measurements))
        if fits(arm, left) and left < max(_FAR_BETTER * misfit, _EXACT_MM):
            raise ImplausibleError(
                f"the nominal arm misses the measured places by {misfit:.3g} mm rms, and by {left:.3g} mm if {text}: "
                "put the table right"
            )
    raise ImplausibleError(
        f"the nominal arm misses the measured places by {misfit:.3g} mm rms, more than an arm of "
        f"{reach_mm(arm):.0f} mm is wrong by: another arm, joints at other poses than measured, or targets of "
        "another tool. Check the arm description, the tool and which row belongs to which pose"
    )


def outside_ranges(arm: SerialArm, rows: Measurements) -> str | None:
    """Return which poses are outside the ranges of the arm; None where all are inside."""
    joints = rows.commands.joints
    low, high = ranges_of(arm.chain)
    beyond = ~within(joints, low - _READ, high + _READ).all(axis=1)
    if not beyond.any():
        return None
    first = int(np.argmax(beyond))
    said = f"the first: pose {rows.names[first]!r}, {beyond_text(arm.chain, joints[first])}"
    return (
        f"{np.count_nonzero(beyond)} of {len(joints)} poses are outside the ranges of the arm description ("
        f"{said}): correct the joints, or the ranges"
    )


def _least(arm: SerialArm, mistakes: Iterator[Mistake]) -> tuple[float, str]:
    """Return the misfit without the mistake that leaves least of it, the first of equal ones, and its text."""
    found = [(misfit_mm(one.arm or arm, one.measurements), one.text) for one in mistakes]
    return min(found, key=lambda one: one[0], default=(np.inf, ""))


def _require_names(arm: SerialArm, rows: Measurements, misfit: float) -> None:
    """Refuse exchanged names of targets, which a small tool hides below what an arm may be wrong by."""
    for one in renamed(arm, rows):
        left = misfit_mm(arm, one.measurements)
        if left < _FAR_BETTER * misfit and misfit > _EXACT_MM:
            raise ImplausibleError(
                f"the nominal arm misses the measured places by {misfit:.3g} mm rms, and by {left:.3g} mm if "
                f"{one.text}: put the table right"
            )


def _require_no_copies(rows: Measurements) -> None:
    """Refuse rows that stand twice to the last digit, more of them than agree by chance."""
    points, distances, joints = rows.points, rows.distances, rows.commands.joints
    _require_few(rows, points.pose, np.column_stack([joints[points.pose], points.target]), points.place_mm)
    _require_few(
        rows,
        distances.pose,
        np.column_stack([joints[distances.pose], distances.target, distances.anchor, distances.segment]),
        distances.distance_mm[:, None],
    )


def _require_few(rows: Measurements, pose: Ints, what: Floats, measured: Floats) -> None:
    """Refuse copies where they are more of the rows that measure something again than chance makes."""
    if not len(what):
        return
    earlier, copied = _earliest(what), _earliest(np.column_stack([what, measured]))
    again = earlier != np.arange(len(what))
    copies = np.flatnonzero(copied != np.arange(len(what)))
    alike = measured[again] == measured[earlier[again]]
    if copies.size > _by_chance(alike):
        one, other = (rows.names[pose[k]] for k in (copied[copies[0]], copies[0]))
        raise ImplausibleError(
            f"{copies.size} rows repeat others to the last digit (the first: pose {other!r} repeats {one!r}): no "
            "instrument measures the same numbers again. Remove the copies"
        )


def _by_chance(alike: Bools) -> float:
    """Return how many rows that measure something again may agree in all numbers by chance.

    Single numbers show it: those that are written with few decimals agree often, in rows that are no copies, too.

    Args:
        alike: which numbers agree with those of the earliest such row, shape (n, numbers).
    """
    most = _CHANCE * len(alike)
    others = alike[~alike.all(axis=1)]
    if alike.shape[1] == 1 or not others.any():
        return most if alike.shape[1] == 1 else 0.0
    expected = len(alike) * float(np.prod(others.mean(axis=0)))
    return min(most, _FEW + _TIMES * expected) if expected > _NEVER else 0.0


def _earliest(rows: Floats) -> Ints:
    """Return the number of the first row that is the same, of each, shape (n,)."""
    _, first, number = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return np.asarray(first[number.ravel()])


def _require_other_joints(rows: Measurements) -> None:
    """Refuse poses of which all have the same joints."""
    joints = rows.commands.joints
    if len(joints) > 1 and not np.ptp(joints, axis=0).any():
        raise ImplausibleError(
            f"all {len(joints)} poses have the same joints: check whether each row has the joints of its own pose"
        )
