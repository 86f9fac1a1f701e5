"""Where the beam points: J4 commands, beam miss, line of sight (Eq. 1, corrected).

The printed Eq. 1 gives the beam's direction in the world. The tool turns with J1 and J2, so the joint to
command is J4 = θ_world − θ1 − θ2 − θ40, on a branch inside the limits.
"""

import numpy as np

from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.scara.planar import forward, wrap_rad
from catseye.calibration.scara.points import Points


def beam_direction(xy_mm: Floats, reflector_mm: Floats) -> Floats:
    """Return the direction from positions of the J4 axis to a reflector.

    Args:
        xy_mm: positions of the J4 axis, mm, shape (..., 2).
        reflector_mm: place of the reflector, mm, shape (2,) or (..., 2).

    Returns:
        World angle, rad, in (-pi, pi], shape (...).
    """
    beam = np.asarray(reflector_mm) - xy_mm
    return np.arctan2(beam[..., 1], beam[..., 0])


def beam_turn_rad(points: Points, nominal_mm: tuple[float, float], reflectors_mm: Floats) -> Floats:
    """Return the angle of the beam against link 2 as it was commanded, rad, shape (n,).

    Args:
        nominal_mm: nominal links, mm.
        reflectors_mm: places of points.reflector_names that the beam was aimed at, mm, shape (reflectors, 2).
    """
    commands = points.commands
    position = forward(commands.theta1_rad, commands.theta2_rad, *nominal_mm)
    world = beam_direction(position, reflectors_mm[points.reflector])
    return wrap_rad(world - commands.theta1_rad - commands.theta2_rad)


def aim(theta1_rad: Floats, theta2_rad: Floats, world_rad: Floats, theta40_rad: float) -> Floats:
    """Return the J4 angle that points the beam in a world direction, rad, on the branch (-pi, pi]."""
    return wrap_rad(world_rad - theta1_rad - theta2_rad - theta40_rad)


def nearest_branch(j4_rad: Floats, reference_rad: Floats | float) -> Floats:
    """Return J4 angles moved by whole turns to lie within half a turn of a reference, rad."""
    return reference_rad + wrap_rad(np.asarray(j4_rad) - reference_rad)


def unwrap(j4_rad: Floats) -> Floats:
    """Return J4 angles along a path, last axis, as the joint turns: without jumps of a turn."""
    turns = np.rint(np.diff(j4_rad, axis=-1) / (2.0 * np.pi))
    if not turns.any():
        return j4_rad
    back = np.concatenate([np.zeros_like(turns[..., :1]), np.cumsum(turns, axis=-1)], axis=-1)
    return np.asarray(j4_rad - 2.0 * np.pi * back, dtype=np.float64)


def beam_miss(xy_mm: Floats, world_rad: Floats, reflector_mm: Floats) -> Floats:
    """Return the distance of a reflector's centre from the beam's line.

    Args:
        xy_mm: positions of the J4 axis, mm, shape (..., 2).
        world_rad: directions of the beam, rad, shape (...).
        reflector_mm: place of the reflector, mm, shape (2,) or (..., 2).

    Returns:
        Miss, mm, shape (...); infinite when the reflector lies behind the beam.
    """
    beam = np.asarray(reflector_mm) - xy_mm
    along = beam[..., 0] * np.cos(world_rad) + beam[..., 1] * np.sin(world_rad)
    across = beam[..., 1] * np.cos(world_rad) - beam[..., 0] * np.sin(world_rad)
    return np.where(along > 0.0, np.abs(across), np.inf)


def column_clearance(xy_mm: Floats, reflector_mm: Floats) -> Floats:
    """Return how close the beam comes to the J1 axis, mm, shape (...).

    Args:
        xy_mm: positions of the J4 axis, mm, shape (..., 2).
        reflector_mm: place of the reflector, mm, shape (2,) or (..., 2).
    """
    # Coordinate by coordinate: sums over an axis of two elements cost several times as much.
    along = np.asarray(reflector_mm) - xy_mm
    (x, y), (along_x, along_y) = ((one[..., 0], one[..., 1]) for one in (xy_mm, along))
    square = along_x**2 + along_y**2
    share = np.clip(-(x * along_x + y * along_y) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    return np.asarray(np.hypot(x + share * along_x, y + share * along_y))


def field_angle(xy_mm: Floats, reflector_mm: Floats, facing_rad: float) -> Floats:
    """Return the angle between a reflector's axis and the beam that arrives, rad, shape (...)."""
    back = beam_direction(xy_mm, reflector_mm) + np.pi
    return np.abs(wrap_rad(back - facing_rad))


def visible(
    xy_mm: Floats,
    reflector_mm: Floats,
    facing_rad: float,
    column_radius_mm: float,
    field_half_angle_rad: float,
    beam_range_mm: tuple[float, float],
) -> Bools:
    """Return where a reflector can be seen: past the column, inside its field, inside the beam's range.

    Args:
        xy_mm: positions of the J4 axis, mm, shape (..., 2).
        reflector_mm: place of the reflector, mm, shape (2,).
        facing_rad: direction of the reflector's axis, rad.
        column_radius_mm: radius about the J1 axis that the beam must stay out of, mm.
        field_half_angle_rad: half angle of the reflector's field, rad.
        beam_range_mm: shortest and longest beam, mm.

    Returns:
        Flags, shape (...).
    """
    beam = np.asarray(reflector_mm) - xy_mm
    length = np.hypot(beam[..., 0], beam[..., 1])
    return np.asarray(
        (column_clearance(xy_mm, reflector_mm) > column_radius_mm)
        & (field_angle(xy_mm, reflector_mm, facing_rad) <= field_half_angle_rad)
        & (length >= beam_range_mm[0])
        & (length <= beam_range_mm[1])
    )
