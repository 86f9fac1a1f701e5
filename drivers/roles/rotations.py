"""Rotations about three axes, in one order and in the other. Pure."""

import math

from catseye.drivers.roles.tracker import Place

_Matrix = tuple[tuple[float, float, float], ...]


def as_fixed_axes_deg(turn_deg: Place) -> Place:
    """Return rx, ry, rz with R = Rz·Ry·Rx for angles that mean R = Rx·Ry·Rz, deg."""
    return _angles_deg(
        _product(_product(_about(0, turn_deg[0]), _about(1, turn_deg[1])), _about(2, turn_deg[2]))
    )


def _angles_deg(matrix: _Matrix) -> Place:
    level = math.hypot(matrix[0][0], matrix[1][0])
    ry = math.atan2(-matrix[2][0], level)
    if level < 1e-12:
        # Rx and Rz turn about one axis; all of it is given to Rx.
        return math.degrees(math.atan2(-matrix[1][2], matrix[1][1])), math.degrees(ry), 0.0
    rx, rz = math.atan2(matrix[2][1], matrix[2][2]), math.atan2(matrix[1][0], matrix[0][0])
    return math.degrees(rx), math.degrees(ry), math.degrees(rz)


def _about(axis: int, angle_deg: float) -> _Matrix:
    cosine, sine = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    after, last = (axis + 1) % 3, (axis + 2) % 3
    rows = [[float(row == column) for column in range(3)] for row in range(3)]
    rows[after][after] = rows[last][last] = cosine
    rows[after][last], rows[last][after] = -sine, sine
    return tuple((row[0], row[1], row[2]) for row in rows)


def _product(one: _Matrix, other: _Matrix) -> _Matrix:
    rows = [[sum(one[i][k] * other[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    return tuple((row[0], row[1], row[2]) for row in rows)
