"""A check of ways tried on generated ones, judged by the oracle."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from catseye.drivers.roles.pose import Pose
from catseye.procedures.scara.bench import ScaraBench
from tests.unit.procedures.collision_oracle import (
    generated,
    judged,
    least_mm,
    pairs,
    refined,
    with_cut_corners,
)

Check = Callable[[Pose, Sequence[Sequence[Pose]], ScaraBench], str | None]

ORACLE_MM = 1.0
"""What the oracle may see too large, with the resolution of the check."""


@dataclass
class Outcome:
    """What became of the ways.

    Attributes:
        accepted: how many were.
        refused: how many were.
        collisions: numbers of those that were accepted although bodies come nearer than the clearance.
        needless: numbers of those that were refused although they do not, beyond the stated margin.
        misnamed: numbers of those whose refusal names other bodies than those that come too near.
        check_s: time that the check took.
    """

    accepted: int = 0
    refused: int = 0
    collisions: list[int] = field(default_factory=list)
    needless: list[int] = field(default_factory=list)
    misnamed: list[int] = field(default_factory=list)
    check_s: float = 0.0

    def __str__(self) -> str:
        count = self.accepted + self.refused
        return (
            f"{self.accepted} accepted, {self.refused} refused; collisions accepted: {len(self.collisions)}; refused "
            f"needlessly: {len(self.needless)} ({100.0 * len(self.needless) / count:.2f} %); misnamed: "
            f"{len(self.misnamed)}; the check took {1e3 * self.check_s / count:.1f} ms a way"
        )


def tried(seed: int, count: int, check: Check) -> Outcome:
    """Return how a check judges generated ways; some are driven with their corners cut."""
    outcome = Outcome()
    for number, (scene, way) in enumerate(generated(seed, count)):
        begin_s = time.perf_counter()
        refusal = check(way[0], [way[1:]], scene)
        outcome.check_s += time.perf_counter() - begin_s
        straight = refined(way, scene)
        clearance_mm = scene.workspace.clearance_mm
        if refusal is None:
            outcome.accepted += 1
            cut = scene.arm.following == "blended" and len(way) > 2
            seen = [straight, *(judged(with_cut_corners(way, share), scene) for share in (0.2, 0.5) if cut)]
            if min(one.distance_mm for one in seen) < clearance_mm - 1e-6:
                outcome.collisions.append(number)
            continue
        outcome.refused += 1
        if scene.arm.following == "blended":
            # Corners may be cut by any amount: what that needs is the stated margin.
            continue
        if straight.distance_mm > clearance_mm + ORACLE_MM:
            outcome.needless.append(number)
        elif not _names_near_bodies(refusal, way, scene, clearance_mm):
            outcome.misnamed.append(number)
    return outcome


def _names_near_bodies(refusal: str, way: list[Pose], scene: ScaraBench, clearance_mm: float) -> bool:
    """Return whether the bodies that a refusal names come too near on the leg that it names."""
    leg = int(refusal.split("on the way to target ")[1].split(" ")[0])
    named = [
        two for two in pairs(scene) if f"the {two[0].name} " in refusal and f"the {two[1].name} " in refusal
    ]
    nearest = min((least_mm(way[leg - 1 : leg + 1], two) for two in named), default=np.inf)
    return nearest < clearance_mm + ORACLE_MM
