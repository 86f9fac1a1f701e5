"""The target on the arm that a tracker follows, and what to do where it follows none, or another one."""

import math
from typing import Final

from catseye.drivers.roles.errors import HiddenTargetError
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.tracker import Position
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.errors import HiddenTargetsError
from catseye.procedures.kit.tasks import LeadTracker
from catseye.procedures.scara.path.measured_path import MEASURED_MM
from catseye.procedures.scara.questions import TARGET

ON_THE_ARM: Final = "arm"
"""Where the target sits, as an emulated bench calls it."""

_MOST_QUESTIONS: Final = 10
"""So often one point is asked for; after that the target does not come back."""


class FollowedTarget:
    """Has a tracker measure where the arm stands, point after point.

    Args:
        ctx: the bench.
        settle_s: standstill before a measurement, s.
    """

    def __init__(self, ctx: Context, settle_s: float) -> None:
        self._ctx = ctx
        self._settle_s = settle_s
        self._last: tuple[tuple[float, float], tuple[float, float]] | None = None

    def recall(self, place_mm: tuple[float, float], seen_mm: tuple[float, float]) -> None:
        """Compare the next point with one that is measured: also after a resume, when no point of this process is.

        Args:
            place_mm: where the arm stood by its commands, x and y.
            seen_mm: where the tracker saw it, in its own frame.
        """
        self._last = place_mm, seen_mm

    async def at(self, place_mm: tuple[float, float], question: str, following: Pose | None) -> Position:
        """Return where the tracker sees the arm, in the tracker's frame.

        Args:
            place_mm: where the arm stands by its commands, x and y.
            question: id of the prompt, should the tracker see no target or another one.
            following: where the arm goes afterwards; None for nowhere in particular.

        Raises:
            HiddenTargetsError: the operator ends the run, or the target does not come back.
        """
        was_wrong = False
        for number in range(1, _MOST_QUESTIONS + 1):
            try:
                found = await self._ctx.locate(self._settle_s, place_mm)
            except HiddenTargetError as error:
                complaint = str(error)
            else:
                complaint = self._complaint(place_mm, found)
                if not complaint:
                    self.recall(place_mm, (found.x_mm, found.y_mm))
                    return found
                if was_wrong:
                    raise HiddenTargetsError(
                        f"{complaint}, also after its beam was led to the arm: the points before were measured to "
                        "another target, or the tracker was moved; start the run again"
                    )
                was_wrong = True
            asked = question if number == 1 else f"{question}/{number}"
            if await self._ctx.ask(_prompt(asked, complaint, following)) != "again":
                break
        raise HiddenTargetsError(
            f"{complaint}; continue with catseye resume when the tracker follows the target on the arm"
        )

    def _complaint(self, place_mm: tuple[float, float], found: Position) -> str:
        """Return what is wrong with a place; a distance does not depend on the frame that it is measured in."""
        if self._last is None or self._ctx.rehearsing:
            return ""
        before_mm, before_seen_mm = self._last
        moved_mm = math.dist(before_mm, place_mm)
        seen_mm = math.dist(before_seen_mm, (found.x_mm, found.y_mm))
        if abs(seen_mm - moved_mm) <= MEASURED_MM:
            return ""
        return (
            f"the arm has gone {moved_mm:.1f} mm since the last point and the tracker's target {seen_mm:.1f} mm: the "
            "tracker follows another target, it was moved, or its unit is not mm"
        )


def _prompt(question: str, complaint: str, following: Pose | None) -> Prompt:
    return TARGET.prompt(
        f"target/{question}",
        f"{complaint}. Lead the tracker's beam to the target on the arm, then have the point measured again.",
        task=LeadTracker(target=ON_THE_ARM),
        target=following,
    )
