"""The world frame of three fixed nests, measured again through the day, and how far the instrument has drifted."""

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.kinematics.rotations import inverted, rotation_vectors_deg
from catseye.calibration.serial_arm.closed_form import rigid_motion
from catseye.drivers.roles.errors import HiddenTargetError
from catseye.drivers.roles.tracker import on_a_line
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.records import Json, Row
from catseye.procedures.serial_arm.bench import FixedNest
from catseye.procedures.serial_arm.records import MeasuredNest, coordinates, covariances

Floats = NDArray[np.float64]

_STEP_MM: Final = 1e-3
"""By which a nest is moved to see what that does to the frame."""

FEWEST: Final = 3
"""Nests that make a frame."""

U_NEST_MM: Final = 0.03
"""Of a coordinate where the instrument states none: Table V of the six-axis paper, laser tracker."""

_SIGNIFICANT: Final = 3.0
"""Motion in standard uncertainties of the mean square, beyond which it is taken out: less would only add noise."""


async def measure_nests(
    ctx: Context, nests: Sequence[FixedNest], number: int, settle_s: float, dwell_s: float
) -> Row:
    """Measure every nest once; the row holds places by name, None of a hidden one, and what is stated of them."""
    places: dict[str, Json] = {}
    stated: dict[str, Json] = {}
    for nest in nests:
        try:
            found = await ctx.measure_target(nest.name, settle_s, dwell_s, nest.place_mm)
        except HiddenTargetError as error:
            places[nest.name] = None
            await ctx.warn(
                f"the nest {nest.name} is hidden, so this measurement of the world frame lacks it: {error}"
            )
            continue
        values = coordinates(found.place_mm, found.u_mm) | covariances(found.covariance_mm2)
        ctx.record(
            MeasuredNest(
                nest=nest.name,
                nests_round=number,
                **values,  # type: ignore[arg-type]  # the keys are those of coordinates
            )
        )
        places[nest.name] = list(found.place_mm)
        stated[nest.name] = list(found.u_mm or (U_NEST_MM,) * 3)
    return {"round": number, "places": places, "u_mm": stated}


def coordinate_u_mm(rounds: Sequence[Row]) -> float:
    """Return the root mean square of the uncertainties that are stated of the nests' coordinates."""
    stated = [values for row in rounds for values in _triples(row.get("u_mm")).values()]
    return float(np.sqrt(np.mean(np.square(stated)))) if stated else U_NEST_MM


def have_moved(first: Mapping[str, Floats], later: Mapping[str, Floats], u_mm: float) -> bool:
    """Return whether nests have moved between two measurements by more than is known of their places.

    Args:
        first: places by name, mm.
        later: likewise; nests that one of the two lacks do not count.
        u_mm: standard uncertainty of a coordinate.
    """
    names = first.keys() & later.keys()
    if not names:
        return False
    square = np.mean([np.sum((later[name] - first[name]) ** 2) for name in names])
    return bool(np.sqrt(square / 3.0) > _SIGNIFICANT * np.sqrt(2.0) * u_mm / np.sqrt(len(names)))


def drift_mm(first: Row, later: Row) -> dict[str, float]:
    """Return how far each nest has moved between two measurements, as far as both have it, mm."""
    one, other = places_of(first), places_of(later)
    return {name: float(np.linalg.norm(other[name] - one[name])) for name in one.keys() & other.keys()}


def motion_between(first: Mapping[str, Floats], later: Mapping[str, Floats]) -> Floats | None:
    """Return what brings places of a later measurement back into the frame of the first, shape (4, 4).

    Returns:
        None where the two have no three nests in common that make a frame.
    """
    names = sorted(first.keys() & later.keys())
    if frame_nests({name: first[name] for name in names}) is None:
        return None
    return rigid_motion(np.array([later[name] for name in names]), np.array([first[name] for name in names]))


def frame_nests(places: Mapping[str, Floats]) -> tuple[str, ...] | None:
    """Return the names of the first three nests that make a frame; None where all lie on a line, or are fewer."""
    threes = combinations(places, FEWEST)
    return next(
        (names for names in threes if not on_a_line(*(places[name].tolist() for name in names))), None
    )


def world_frame(origin: Floats, along: Floats, aside: Floats) -> Floats:
    """Return what turns places in the instrument's frame into the world's, shape (4, 4).

    Args:
        origin: the first nest.
        along: the second, which lies on x.
        aside: the third, in the plane of x and y, y towards it.
    """
    x = (along - origin) / np.linalg.norm(along - origin)
    z = np.cross(x, aside - origin)
    z = z / np.linalg.norm(z)
    made = np.eye(4)
    made[:3, :3] = np.array([x, np.cross(z, x), z])
    made[:3, 3] = -made[:3, :3] @ origin
    return made


def places_of(row: Row) -> dict[str, Floats]:
    """Return the places of a measurement by name, mm; hidden nests are left out."""
    return {name: np.array(place) for name, place in _triples(row["places"]).items()}


def _triples(stored: object) -> dict[str, list[float]]:
    return {} if not isinstance(stored, dict) else {k: v for k, v in stored.items() if isinstance(v, list)}


def world_frame_covariance(nests_mm: Floats, covariance_mm2: Floats) -> Floats:
    """Return how uncertain the world frame of three nests is: small shifts, mm, and turns, deg, about its origin.

    Args:
        nests_mm: as `world_frame` takes them, shape (3, 3).
        covariance_mm2: of each, shape (3, 3, 3).

    Returns:
        Covariance of what everything in the world frame seems to be moved by, shape (6, 6).
    """
    back = inverted(world_frame(*nests_mm))

    def seeming(moved_mm: Floats) -> Floats:
        step = world_frame(*(nests_mm + moved_mm)) @ back
        return np.concatenate([step[:3, 3], rotation_vectors_deg(step[None, :3, :3])[0]])

    each = _STEP_MM * np.eye(nests_mm.size).reshape(-1, *nests_mm.shape)
    rates = np.column_stack([seeming(one) - seeming(-one) for one in each]) / (2.0 * _STEP_MM)
    of_nests = rates.reshape(6, *nests_mm.shape)
    return np.asarray(np.einsum("anj,njk,bnk->ab", of_nests, covariance_mm2, of_nests))
