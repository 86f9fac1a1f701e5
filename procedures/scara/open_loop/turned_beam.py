"""Where the beam of an interferometer comes back that was to be turned by half a turn."""

import math
from dataclasses import dataclass
from typing import Final

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context
from catseye.procedures.scara.beam.beam_scan import find_at_heights, find_narrow_return
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.open_loop.remount_plan import HALF_TURN_DEG, MOST_OFF_DEG, RemountPlan

DOUBT_MM: Final = 3.0
"""What a place that was searched may be wrong by at most, for the range of a scan."""


@dataclass(frozen=True)
class Seen:
    """What a look for the beam has found.

    Attributes:
        reflector: that it has to return from.
        turned_deg: how far the interferometer is turned by its return there; None where nothing returned.
        j3_mm: height at which it returned; that of the look where nothing did.
        again: it returned from another pose, too, as it does from that reflector alone.
        former_deg: J4 at which the beam returns as it did before; None where it does not.
    """

    reflector: str
    turned_deg: float | None
    j3_mm: float
    again: bool = False
    former_deg: float | None = None

    @property
    def turned(self) -> bool:
        """Whether the interferometer is turned as it has to be."""
        return (
            self.again
            and self.turned_deg is not None
            and abs(self._more_deg(self.turned_deg)) <= MOST_OFF_DEG
        )

    @property
    def trouble(self) -> str:
        """What is wrong with the mounting, for hands."""
        if self.former_deg is not None:
            return (
                f"the interferometer is not turned: its beam returns from {self.reflector} at "
                f"J4 = {self.former_deg:.1f}°, where it did before (or another reflector answers there); turn it by "
                "half a turn"
            )
        if self.turned_deg is None:
            return (
                f"the beam returns from {self.reflector} neither at the J4 angle of an interferometer turned by "
                "half a turn nor at the one from before: check that it is turned by 180°, that its seat is clean, "
                "so that the beam comes back at a height of j3_range_mm, and that nothing is in the beam"
            )
        if not self.again:
            return (
                f"something returns the beam as {self.reflector} would with an interferometer turned by "
                f"{self.turned_deg:.1f}°, but nothing does so from another pose: another reflector answers, or the "
                "beam is not free there; check that the interferometer is turned by 180°"
            )
        more_deg = self._more_deg(self.turned_deg)
        way = "anticlockwise" if more_deg > 0.0 else "clockwise"
        return (
            f"the interferometer is turned by {self.turned_deg:.1f}°: turn it by {abs(more_deg):.1f}° {way}, as "
            "seen from above"
        )

    @staticmethod
    def _more_deg(turned_deg: float) -> float:
        return HALF_TURN_DEG - turned_deg


class TurnedBeam:
    """Looks for the beam; the arm has to stand where that of the turned interferometer meets a reflector.

    Args:
        bench: as it is in the first half.
    """

    def __init__(self, ctx: Context, bench: ScaraBench, plan: RemountPlan) -> None:
        self._ctx = ctx
        self._bench = bench
        self._plan = plan

    @property
    def stand(self) -> Pose:
        """Where the arm stands while hands are at work."""
        return self._at(self._bench.j3_mm, self._plan.pose.j4_deg)

    async def look(self, likely_mm: float) -> Seen:
        """Look for the beam where it has to be, where it was before, and at all heights of J3 at last.

        Where it is not found the arm stands in the end where it stood before.

        Args:
            likely_mm: height of J3 to begin with.
        """
        pose, level = self._plan.pose, self._plan.level
        at, half_range_deg = self._at(likely_mm, pose.j4_deg), level.params.half_range_deg

        async def within(heights_mm: tuple[float, float]) -> Seen:
            found = await find_at_heights(
                self._ctx, at, half_range_deg, pose.beam_mm, self._bench, heights_mm
            )
            return await self._judged(found, likely_mm)

        seen = await within((likely_mm, likely_mm))
        if not seen.again:
            former_deg = await self._former_deg()
            if former_deg is not None:
                return Seen(seen.reflector, None, likely_mm, former_deg=former_deg)
        if seen.turned_deg is None:
            # Long: a mounting that is as high as before, or was not turned, is known by now.
            seen = await within(level.j3_range_mm)
        if not seen.turned:
            await self._ctx.move(self.stand)
        return seen

    async def _judged(self, found: Pose | None, likely_mm: float) -> Seen:
        """Return what a return means; another pose shows whether it is that of the reflector."""
        name = self._plan.pose.reflector.name
        if found is None:
            return Seen(name, None, likely_mm)
        off_deg = found[3] - self._plan.pose.j4_deg
        return Seen(name, HALF_TURN_DEG - off_deg, found[2], await self._returns_again(off_deg, found[2]))

    async def _returns_again(self, off_deg: float, j3_mm: float) -> bool:
        """Look from the farthest pose of the levelling, where another reflector stands in another direction."""
        near, far = self._plan.pose, self._plan.level.poses[-1]
        doubt_deg = math.degrees(DOUBT_MM * (1.0 / near.beam_mm + 1.0 / far.beam_mm))
        at = (far.theta1_deg, far.theta2_deg, j3_mm, far.j4_deg + off_deg)
        heights_mm = self._plan.level.j3_range_mm
        again = await find_at_heights(self._ctx, at, doubt_deg, far.beam_mm, self._bench, heights_mm)
        return again is not None

    async def _former_deg(self) -> float | None:
        """Return J4 where the beam returns as it did before; an interferometer put back lies a little off."""
        former_deg = self._plan.former_j4_deg
        if former_deg is None:
            return None
        # The way between is checked at this height.
        await self._ctx.move(self.stand)
        former = self._at(self._bench.j3_mm, former_deg)
        beam_mm = self._plan.pose.beam_mm
        window = await find_narrow_return(self._ctx, former, MOST_OFF_DEG, beam_mm, self._bench)
        await self._ctx.move(self.stand)
        return None if window is None else former_deg

    def _at(self, j3_mm: float, j4_deg: float) -> Pose:
        pose = self._plan.pose
        return (pose.theta1_deg, pose.theta2_deg, j3_mm, j4_deg)
