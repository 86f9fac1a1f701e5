"""Getting a point measured whatever happens to the beam: back to the last good pose, a new segment, on again.

A count that was broken never becomes a point: every distance comes from a segment whose latch was looked at after its
readings. A loss leads back to the pose that was measured last; the distance there, old and new, goes into `records`
(kind `overlap`): the difference ties the zeros of both segments. What the beam's length is in itself nobody knows, so
it says nothing about a reflector that was moved along the beam; one that was moved across shows in J4, where the beam
comes back.
"""

import math
from dataclasses import dataclass
from typing import Literal

from catseye.procedures.kit.beam.loss import BeamLoss, BeamLossPolicy, Cause, LossLog
from catseye.procedures.kit.beam.settled import Unsettled
from catseye.procedures.kit.context import Context, Measurement
from catseye.procedures.kit.records import row_of
from catseye.procedures.scara.beam.diagnosis import MOVED_BY_HAND, NOT_SUBDIVIDED, Loss
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.following.follower import Follower
from catseye.procedures.scara.motion.point_row import distance_of, title_of
from catseye.procedures.scara.motion.visits import Visit, driving_time_s, measuring_time_s
from catseye.procedures.scara.records import Overlap

Way = Literal["tracked", "driven", "back", "point"]
"""How a point is reached: with the beam kept from the point before; along the plan without it; from the last good
pose, where a new segment begins; or on a way of its own to the point, where a new segment begins."""


@dataclass(frozen=True)
class Good:
    """The point that was measured last, by this process.

    Attributes:
        visit: the point.
        segment: in which it was measured.
        j4_deg: where J4 stood.
        displacement_mm: relative to the zero of that segment.
    """

    visit: Visit
    segment: int
    j4_deg: float
    displacement_mm: float


@dataclass(frozen=True)
class LeftOut:
    """A point that was not measured.

    Attributes:
        reason: why.
        unsettled: readings that scattered too much; None where there are none.
    """

    reason: str
    unsettled: Measurement | None = None


class Recovery:
    """Measures points and closes the gaps that a lost beam leaves.

    Args:
        attempts: failures in a row before the operator is asked.

    Attributes:
        good: the point that was measured last.
    """

    def __init__(
        self, ctx: Context, bench: ScaraBench, reflector: Reflector, follower: Follower, attempts: int
    ) -> None:
        self.good: Good | None = None
        self._ctx = ctx
        self._bench = bench
        self._reflector = reflector
        self._follower = follower
        self._policy = BeamLossPolicy(attempts=attempts, kept_counts=False, may_skip=True)
        self._losses = LossLog(ctx)
        self._ties: dict[int, tuple[int, float]] = {}
        self._off_aim = False

    def carried(self, segment: int) -> tuple[float, int] | None:
        """Return what a displacement of an earlier segment has to be changed by to count from the present zero.

        Returns:
            The change, mm, and the number of overlaps that it rests on; None when a gap was not overlapped.
        """
        present, change_mm, overlaps = self._follower.segment, 0.0, 0
        while present != segment:
            if present not in self._ties:
                return None
            present, difference_mm = self._ties[present]
            change_mm += difference_mm
            overlaps += 1
        return change_mm, overlaps

    async def obtain(self, visit: Visit, before: Visit | None, step_id: str) -> Measurement | LeftOut:
        """Measure a point.

        Args:
            before: the point before it in the plan; None for the first one.
            step_id: names the operator's questions.

        Raises:
            BeamLostError: the operator ends the run, or the beam stays away for all answers.
            WayBlockedError: the arm cannot be led to the point.
        """
        back = visit.tracked and self.good is not None and self.good.visit is before
        way = await self._first_way(visit, before, back=back)
        where = title_of(self._reflector.name, visit.command)
        beam = self._loss_at(step_id)
        while True:
            result = await self._attempt(visit, way, step_id)
            if isinstance(result, Measurement):
                return self._kept(visit, result)
            if isinstance(result, Unsettled):
                return LeftOut("the operator left it out: its readings did not settle", result.measured)
            cause = await self.report(result, visit)
            match await beam.decide(cause, where, kept=way == "tracked"):
                case "skip":
                    return LeftOut(cause.name)
                case "retry":
                    way = "back" if back else "point"
                case "again":
                    kept = way == "tracked" and cause is not NOT_SUBDIVIDED
                    way = "back" if kept and back else "point"

    async def report(self, loss: Loss, visit: Visit) -> Cause:
        """Find out and report why the beam was lost; the count is given up.

        Args:
            visit: the point on the way to which, or at which, it was lost.
        """
        follower, command = self._follower, visit.command
        segment = follower.segment
        cause = await follower.diagnose(loss, visit)
        follower.counting = False
        self._off_aim = cause.name == "aim"
        await self._losses.note(
            cause,
            title_of(self._reflector.name, command),
            reflector=self._reflector.name,
            point=command.index,
            segment=segment,
        )
        return cause

    async def _first_way(self, visit: Visit, before: Visit | None, *, back: bool) -> Way:
        follower = self._follower
        stood = before is not None and follower.at is before
        if stood and await follower.undisturbed():
            if not visit.tracked:
                return "driven"
            if follower.counting:
                return "tracked"
        elif stood:
            await self.report(Loss(MOVED_BY_HAND), visit)
        return "back" if back else "point"

    async def _attempt(self, visit: Visit, way: Way, step_id: str) -> Measurement | Loss | Unsettled:
        """Reach a point and measure it once."""
        loss: Loss | None = None
        if way == "driven":
            loss = await self._follower.drive(visit)
        elif way == "back":
            loss = await self._overlap(step_id)
        if loss is None and way in {"tracked", "back"}:
            loss = await self._follower.track(visit.legs, visit)
        if loss is None and way in {"driven", "point"}:
            loss = await self._begun_at(visit)
        return loss or await self._follower.measure(visit, step_id)

    async def _begun_at(self, visit: Visit) -> Loss | None:
        """Stand at a point and begin a segment there."""
        follower = self._follower
        if follower.at is not visit or not await follower.undisturbed():
            await follower.enter(visit)
        return await follower.begin_segment(visit, centre=self._off_aim)

    async def _overlap(self, step_id: str) -> Loss | None:
        """Go back to the last good pose, begin a segment and measure there once more."""
        old, follower = self.good, self._follower
        if old is None:
            raise RuntimeError("there is no last good pose to go back to")
        follower.at = None
        if (loss := await self._begun_at(old.visit)) is not None:
            return loss
        measured = await follower.measure(old.visit, f"{step_id}/overlap")
        if isinstance(measured, Unsettled):
            return Loss(Cause("interrupted", "the readings at the last good pose did not settle"))
        if isinstance(measured, Loss):
            return measured
        follower.extra_s += measuring_time_s(self._bench)
        follower.extra_s += driving_time_s(old.visit.node, (old.visit.legs[-1],), self._bench)
        await self._tie(old, measured)
        return None

    async def _tie(self, old: Good, measured: Measurement) -> None:
        follower = self._follower
        self._ties[follower.segment] = (old.segment, measured.displacement_mm - old.displacement_mm)
        shift_mm = math.radians(follower.sent[3] - old.j4_deg) * old.visit.beam_mm
        again = distance_of(
            self._reflector.name,
            follower.segment,
            old.visit.command,
            follower.sent,
            measured,
            self._bench.mount_deg,
        )
        self._ctx.record(
            Overlap(
                point=old.visit.command.index,
                previous_segment=old.segment,
                previous_displacement_mm=old.displacement_mm,
                previous_j4_deg=old.j4_deg,
                difference_mm=measured.displacement_mm - old.displacement_mm,
                across_mm=shift_mm,
                extra=row_of(again),
            )
        )
        self.good = Good(old.visit, follower.segment, follower.sent[3], measured.displacement_mm)
        if abs(shift_mm) > self._bench.optics.acceptance_mm:
            await self._ctx.warn(
                f"reflector {self._reflector.name} or the interferometer has been moved: at a pose that was measured "
                f"before, the beam comes back {shift_mm:+.2f} mm across its former place. Distances before and after "
                "do not belong together: fix the reflector, search again (reflector-search) and start a new run"
            )

    def _kept(self, visit: Visit, measured: Measurement) -> Measurement:
        follower = self._follower
        self.good = Good(visit, follower.segment, follower.sent[3], measured.displacement_mm)
        return measured

    def _loss_at(self, step_id: str) -> BeamLoss:
        """Return what decides about losses of one point."""

        def question_id(number: int) -> str:
            return f"beam/{step_id}" if number == 1 else f"beam/{step_id}/{number}"

        return BeamLoss(self._ctx, self._policy, f"reflector {self._reflector.name}", question_id)
