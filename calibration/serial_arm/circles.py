"""A joint that turns by itself: the circle of a target, the axis in it, and what the axis does beside turning.

Six-axis paper, section 4.1 and Table III: tangential, radial and axial errors against the circle about the axis
through the place of the target at a reference angle, the range of the angular errors, and the backlash between both
ways.
"""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import require_finite, require_shape
from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Bools, Floats

_FEWEST = 5
"""Places: a circle in space has six unknowns, and two more coordinates of each place show what it lacks."""

_ROUNDS = 50
_SETTLED_MM = 1e-10

_FLATTEST_DEG = 1.0
"""Arc below which the centre of a circle is a guess."""


@dataclass(frozen=True)
class Circle:
    """A circle in space.

    Attributes:
        centre_mm: shape (3,).
        axis: unit vector about which positive commands turn the target, shape (3,).
        radius_mm: of the fit.
        angle_deg: of each place about the axis, near its command, shape (n,).
        radial_mm: distance of each place from the circle in its plane, outwards, shape (n,).
        axial_mm: distance of each place from the plane, along the axis, shape (n,).
    """

    centre_mm: Floats
    axis: Floats
    radius_mm: float
    angle_deg: Floats
    radial_mm: Floats
    axial_mm: Floats


@dataclass(frozen=True)
class AxisErrors:
    """What a joint does beside turning by what it is commanded (Table III).

    Attributes:
        circle: about the axis.
        tangential_mm: of each place, along the circle, shape (n,).
        radial_mm: of each place against that at the reference, outwards, shape (n,).
        axial_mm: of each place against that at the reference, along the axis, shape (n,).
        angular_deg: of each place, shape (n,).
        backlash_deg: angle after coming from below less that after coming from above, mean over the places that were
            visited from both sides; None without one.
    """

    circle: Circle
    tangential_mm: Floats
    radial_mm: Floats
    axial_mm: Floats
    angular_deg: Floats
    backlash_deg: float | None

    @property
    def tangential_range_mm(self) -> float:
        """From the smallest to the largest tangential error, mm."""
        return float(np.ptp(self.tangential_mm))

    @property
    def angular_range_deg(self) -> float:
        """From the smallest to the largest angular error, deg."""
        return float(np.ptp(self.angular_deg))


def circle_of(command_deg: Floats, place_mm: Floats) -> Circle:
    """Return the circle of a target that one joint turns: least squares in plane and radius.

    Args:
        command_deg: of the joint, shape (n,).
        place_mm: of the target, shape (n, 3).

    Raises:
        InsufficientPointsError: fewer than five places, or all on a line or in one place.
    """
    require_shape(command_deg, (None,), "command_deg")
    require_shape(place_mm, (len(command_deg), 3), "place_mm")
    require_finite(place_mm, "place_mm")
    if len(place_mm) < _FEWEST or np.ptp(command_deg) < _FLATTEST_DEG:
        raise InsufficientPointsError(
            f"{len(place_mm)} places over {float(np.ptp(command_deg)) if len(command_deg) else 0.0:g} deg show no "
            f"circle: measure at least {_FEWEST} over some degrees"
        )
    middle = place_mm.mean(axis=0)
    _, size, directions = np.linalg.svd(place_mm - middle, full_matrices=False)
    if size[1] < 1e-9 * max(size[0], 1.0):
        raise InsufficientPointsError(
            "all places lie on a line: the target hardly moves, or the joint does not turn"
        )
    flat = (place_mm - middle) @ directions[:2].T
    centre, radius = _flat_circle(flat)
    angle = np.arctan2(*(flat - centre).T[::-1])
    axis = np.cross(directions[0], directions[1])
    if _sense(command_deg, angle) < 0.0:
        axis, angle = -axis, -angle
    return Circle(
        centre_mm=middle + centre @ directions[:2],
        axis=axis,
        radius_mm=radius,
        angle_deg=_near_commands(command_deg, np.rad2deg(angle)),
        radial_mm=np.linalg.norm(flat - centre, axis=1) - radius,
        axial_mm=(place_mm - middle) @ axis,
    )


def axis_errors(
    command_deg: Floats, place_mm: Floats, from_below: Bools, reference_deg: float = 0.0
) -> AxisErrors:
    """Return what a joint does beside turning.

    Args:
        command_deg: of the joint, shape (n,).
        place_mm: of the target, shape (n, 3).
        from_below: the joint came to the place by a positive motion, shape (n,).
        reference_deg: command at which the errors are zero; the nearest place to it counts, of both ways together.

    Raises:
        InsufficientPointsError: as `circle_of`.
    """
    require_shape(from_below, (len(command_deg),), "from_below")
    circle = circle_of(command_deg, place_mm)
    away = np.abs(command_deg - reference_deg)
    at = away <= away.min() + 1e-9
    error = circle.angle_deg - command_deg
    error = error - error[at].mean()
    radius = circle.radius_mm + circle.radial_mm[at].mean()
    return AxisErrors(
        circle=circle,
        tangential_mm=np.deg2rad(error) * radius,
        radial_mm=circle.radial_mm - circle.radial_mm[at].mean(),
        axial_mm=circle.axial_mm - circle.axial_mm[at].mean(),
        angular_deg=error,
        backlash_deg=_backlash(command_deg, error, from_below),
    )


def _backlash(command_deg: Floats, error_deg: Floats, from_below: Bools) -> float | None:
    below = {float(q): e for q, e in zip(command_deg[from_below], error_deg[from_below], strict=True)}
    above = {float(q): e for q, e in zip(command_deg[~from_below], error_deg[~from_below], strict=True)}
    both = sorted(below.keys() & above.keys())
    return float(np.mean([below[q] - above[q] for q in both])) if both else None


def _flat_circle(flat: Floats) -> tuple[Floats, float]:
    """Return centre and radius of a circle in a plane: algebraic start (Kåsa), then least squares of distances."""
    columns = np.column_stack([2.0 * flat, np.ones(len(flat))])
    solved = np.linalg.lstsq(columns, np.sum(flat**2, axis=1), rcond=None)[0]
    centre = solved[:2]
    radius = float(np.sqrt(max(solved[2] + centre @ centre, 0.0)))
    for _ in range(_ROUNDS):
        out = flat - centre
        apart = np.linalg.norm(out, axis=1)
        towards = np.column_stack([-out / apart[:, None], -np.ones(len(flat))])
        step = np.linalg.lstsq(towards, radius - apart, rcond=None)[0]
        centre, radius = centre + step[:2], radius + float(step[2])
        if np.abs(step).max() < _SETTLED_MM:
            break
    return centre, radius


def _sense(command_deg: Floats, angle: Floats) -> float:
    """Return the sign with which angles follow commands: small turns cannot be taken for others."""
    order = np.argsort(command_deg, kind="stable")
    turned = np.diff(angle[order])
    back = (turned + np.pi) % (2.0 * np.pi) - np.pi
    small = np.diff(command_deg[order]) < 170.0
    return float(np.sign(np.sum(back[small] * np.diff(command_deg[order])[small])))


def _near_commands(command_deg: Floats, angle_deg: Floats) -> Floats:
    """Return angles by whole turns as near to their commands as they are to that of the first place."""
    off = (angle_deg - command_deg) - (angle_deg[0] - command_deg[0])
    return np.asarray(angle_deg - angle_deg[0] + command_deg[0] - 360.0 * np.round(off / 360.0))
