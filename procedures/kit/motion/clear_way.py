"""No body of the arm may come near another one, or what stands around the arm, at the targets or between them.

Plans, the gate of every motion, the jog and the rehearsal ask here.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.kinematics.bodies import Box, Gaps, Scene, Table
from catseye.calibration.kinematics.sweep import Contact, clear_legs, first_contact
from catseye.drivers.roles.pose import Axes, Pose, between, pose_text
from catseye.procedures.kit.bench import Bench, Stand, Workspace
from catseye.procedures.kit.errors import PlanError

_LARGEST = 3600.0
"""Of an axis, deg or mm: beyond is no place of an arm, and a way from there could not be looked at in time."""

_MOST_REMEMBERED = 100_000
"""Clear legs of one scene: more than any plan has."""

_STUCK = (
    "the way begins too near it: if the arm is there, move it away with the teach pendant; if not, begin "
    "elsewhere"
)


def require_clear_way(way: Sequence[Pose], bench: Bench) -> None:
    """Refuse a way on which bodies come nearer to each other than the clearance.

    All reflectors stand on the bench while any one is measured.

    Args:
        way: targets in order, the first one where the way begins; straight joint moves lie between them.

    Raises:
        PlanError: names both bodies, how near they come, on the way to which target, and the remedy.
    """
    if (refusal := way_refusal(way, bench)) is not None:
        raise PlanError(refusal)


def require_clear_legs(start: Pose, legs: Sequence[Sequence[Pose]], bench: Bench) -> None:
    """Refuse legs, at whose ends the arm stands still, as `require_clear_way` refuses a way.

    Args:
        legs: targets of each.

    Raises:
        PlanError: as `require_clear_way`.
    """
    if (refusal := legs_refusal(start, legs, bench)) is not None:
        raise PlanError(refusal)


def legs_refusal(start: Pose, legs: Sequence[Sequence[Pose]], bench: Bench) -> str | None:
    """Return why legs, at whose ends the arm stands still, are not clear; None when they are."""
    way = [start, *(target for leg in legs for target in leg)]
    passed = [False, *(number + 1 < len(leg) for leg in legs for number in range(len(leg)))]
    contact = _contact(way, bench, passed)
    return None if contact is None else _refusal(contact, way, bench)


def way_check(bench: Bench) -> Callable[[Sequence[Pose]], str | None]:
    """Return a check that says why a path blended past its via points is not clear; None when it is.

    A gate asks before each motion: the scene is looked up once.
    """
    known = _known(bench)

    def refusal(way: Sequence[Pose]) -> str | None:
        passed = [0 < number < len(way) - 1 for number in range(len(way))]
        contact = _contact(way, bench, passed, known)
        return None if contact is None else _refusal(contact, way, bench)

    return refusal


def way_refusal(way: Sequence[Pose], bench: Bench) -> str | None:
    """Return why a way is not clear; None when it is. See `require_clear_way`."""
    contact = _contact(way, bench)
    return None if contact is None else _refusal(contact, way, bench)


def clear_ways(ways: Sequence[Sequence[Pose]], bench: Bench) -> list[bool]:
    """Return which of many ways of two targets or more are clear; `way_refusal` of each takes far longer."""
    known = _known(bench)
    legs = [set(pairwise(way)) for way in ways]
    asked = list(set().union(*legs) - known.clear)
    _require_places([pose for leg in asked for pose in leg], bench.arm.axes)
    ends = np.array(asked, dtype=np.float64).reshape(-1, 2, len(bench.arm.axes))
    clear = clear_legs(known.gaps, ends[:, 0], ends[:, 1], bench.workspace.clearance_mm)
    found = {leg for leg, free in zip(asked, clear.tolist(), strict=True) if free}
    if len(known.clear) + len(found) <= _MOST_REMEMBERED:
        known.clear.update(found)
    return [all(leg in found or leg in known.clear for leg in own) for own in legs]


def refused_target(way: Sequence[Pose], bench: Bench) -> tuple[int, str] | None:
    """Return the target, from 0, to which a way is not clear, and what is in the way there; None when it is.

    Target 0 is where the way begins: one that begins too near something is refused there. The remedy is the caller's.
    """
    if (contact := _contact(way[:1], bench)) is not None:
        return 0, _obstacle(contact, bench)
    if (contact := _contact(way, bench)) is not None:
        return _target(contact, way), _obstacle(contact, bench)
    return None


def clear_poses(poses: NDArray[np.float64], bench: Bench) -> NDArray[np.bool_]:
    """Return at which poses the arm stands clear of everything; of the ways between them nothing is said.

    Args:
        poses: joints, deg or mm, shape (n, joints).
    """
    gaps: NDArray[np.float64] = _known(bench).gaps.at(poses)
    clear: NDArray[np.bool_] = gaps.min(axis=0, initial=np.inf) >= bench.workspace.clearance_mm
    return clear


def clear_part(here: Pose, target: Pose, bench: Bench) -> tuple[Pose, str | None]:
    """Return how far a straight joint move may go, and why not farther; None when its target can be reached."""
    way = (here, target)
    contact = _contact(way, bench)
    if contact is None:
        return target, None
    return between(here, target, contact.clear_share), _refusal(contact, way, bench)


def _contact(
    way: Sequence[Pose], bench: Bench, passed: Sequence[bool] = (), known: "_KnownScene | None" = None
) -> Contact | None:
    _require_places(way, bench.arm.axes)
    known = known or _known(bench)
    corners = np.array(passed) if passed and bench.arm.following == "blended" else None
    # Where corners are cut, a leg depends on its neighbours.
    legs = set(pairwise(map(tuple, way))) if corners is None else set()
    if legs and legs <= known.clear:
        return None
    contact = first_contact(known.gaps, np.array(way), bench.workspace.clearance_mm, corners)
    if contact is None and len(known.clear) + len(legs) <= _MOST_REMEMBERED:
        known.clear.update(legs)
    return contact


def _require_places(way: Sequence[Pose], axes: Axes) -> None:
    """Refuse joints that no arm has: distances from there would mean nothing."""
    # Written so that what is not a number is refused too.
    wrong = [place for place in way if not all(abs(joint) <= _LARGEST for joint in place)]
    if wrong:
        raise PlanError(
            f"{_place(axes, wrong[0])} is not a place of an arm, so no path to it can be planned: see what the "
            "controller reports, or correct the target"
        )


@dataclass(frozen=True)
class _KnownScene:
    """The bodies of an arm and what stands around it.

    Attributes:
        gaps: their distances.
        clear: legs that were found clear: the gate meets exactly those of the plan again.
    """

    gaps: Gaps
    clear: set[tuple[Pose, Pose]] = field(default_factory=set)


def scene_of(bench: Bench) -> Scene:
    """Return the bodies of an arm and what stands around it, as plans and gate look at them."""
    return _scene(bench.workspace, bench.stands)


def _known(bench: Bench) -> _KnownScene:
    return _known_scene(bench.workspace, bench.stands)


@lru_cache(maxsize=16)
def _known_scene(workspace: Workspace, stands: tuple[Stand, ...]) -> _KnownScene:
    return _KnownScene(Gaps(_scene(workspace, stands)))


def _scene(workspace: Workspace, stands: tuple[Stand, ...]) -> Scene:
    boxes = (_named("keep-out box", workspace.keep_out), _named("wall of the keep-in box", workspace.keep_in))
    table = Table("table", workspace.table_z_mm)
    return Scene(workspace.chain, workspace.bodies, tuple(stand.body for stand in stands), table, *boxes)


def _named(what: str, boxes: tuple[Box, ...]) -> tuple[Box, ...]:
    return tuple(Box(f"{what} {box.name}", box.low_mm, box.high_mm) for box in boxes)


def _refusal(contact: Contact, way: Sequence[Pose], bench: Bench) -> str:
    target = _target(contact, way)
    remedy = _STUCK if _begins_blocked(contact) else _remedy(contact.pair[1], bench)
    return (
        f"{_obstacle(contact, bench)}, on the way to target {target} of "
        f"{max(len(way) - 1, 1)}, {_place(bench.arm.axes, way[target])}: {remedy}"
    )


def _obstacle(contact: Contact, bench: Bench) -> str:
    moving, other = contact.pair
    near = f"comes within {contact.distance_mm:.1f} mm" if contact.distance_mm > 0.0 else "runs into it"
    return (
        f"the {other} stands in the arm's way: the {moving} {near} ({bench.workspace.clearance_mm:g} mm are kept "
        f"free) near {_place(bench.arm.axes, contact.pose)}"
    )


def _begins_blocked(contact: Contact) -> bool:
    return contact.leg == 0 and contact.clear_share == 0.0


def _target(contact: Contact, way: Sequence[Pose]) -> int:
    return min(contact.leg + 1, len(way) - 1)


def _place(axes: Axes, pose: Pose) -> str:
    return pose_text(axes, pose, digits=1)


def _remedy(other: str, bench: Bench) -> str:
    ways_out = {stand.body.name: stand.remedy for stand in bench.stands}
    return ways_out.get(
        other,
        "choose targets that keep away from it, or correct its dimensions in the cell file ([[body]], [workspace])",
    )
