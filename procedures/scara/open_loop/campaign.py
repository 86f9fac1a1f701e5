"""The measurement of one reflector: its points, its closure visits, and what is known after each row."""

import math
from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from catseye.procedures.kit.beam.settled import Unsettled
from catseye.procedures.kit.context import Context, Measurement
from catseye.procedures.kit.errors import BeamLostError
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.motion.bench_time import BenchTime
from catseye.procedures.kit.records import Row, row_of
from catseye.procedures.kit.stored import integer, number_of
from catseye.procedures.kit.tasks import PlaceReflector
from catseye.procedures.scara.beam.diagnosis import Loss
from catseye.procedures.scara.counter import CounterWatch
from catseye.procedures.scara.following.follower import Follower
from catseye.procedures.scara.following.recovery import LeftOut, Recovery
from catseye.procedures.scara.motion.point_row import distance_of, title_of
from catseye.procedures.scara.motion.visits import Visit
from catseye.procedures.scara.open_loop.closures import Closure, trip_within_reach
from catseye.procedures.scara.open_loop.live_knowledge import Knowledge
from catseye.procedures.scara.open_loop.open_loop_plan import OpenLoopPlan, ReflectorPlan
from catseye.procedures.scara.questions import PLACE
from catseye.procedures.scara.records import ClosureVisit, Distance


@dataclass(frozen=True)
class _Distance:
    segment: int
    displacement_mm: float


@dataclass(frozen=True)
class _Reference:
    """What a reference pose gave, as counted from the present zero.

    Attributes:
        displacement_mm: there and then.
        overlaps: how many losses of the beam lie between; each adds the scatter of its overlap.
    """

    displacement_mm: float
    overlaps: int


class ReflectorCampaign:
    """Measures one reflector.

    Args:
        part: this reflector's part of it.
        knowledge: takes the points in.
        counter: looks at the first counts, of points that did not settle, too.
        segment: number of the last segment of this reflector; -1 for none.

    Attributes:
        left_out: titles of the points that were not measured, with the reason.
    """

    def __init__(
        self,
        ctx: Context,
        plan: OpenLoopPlan,
        part: ReflectorPlan,
        knowledge: Knowledge,
        counter: CounterWatch,
        time: BenchTime,
        segment: int = -1,
    ) -> None:
        self.left_out: list[str] = []
        self._ctx = ctx
        self._bench = plan.bench
        self._rules = plan.rules
        self._part = part
        self._name = part.reflector.name
        turned = bool(plan.bench.mount_deg)
        self._steps = f"turned/{self._name}" if turned else self._name
        self._titled = f"turned, {self._name}" if turned else self._name
        self._knowledge = knowledge
        self._counter = counter
        self._time = time
        self._follower = Follower(ctx, plan.bench, part.reflector, segment)
        self._recovery = Recovery(
            ctx, plan.bench, part.reflector, self._follower, plan.rules.recovery_attempts
        )
        self._distances: dict[int, _Distance] = {}
        self._placed = not plan.bench.optics.one_reflector
        self._row_is_fresh = False
        self._counted_s = 0.0

    @property
    def segment(self) -> int:
        """Number of the last segment."""
        return self._follower.segment

    async def run(self) -> bool:
        """Measure all points; return whether the maps are known so well that nothing more is needed.

        Raises:
            BeamLostError: the beam stays away and the operator ends the run.
            WayBlockedError: the arm cannot be led to a point.
            CounterError: sign or scale of the counter are wrong.
        """
        visits, closures = self._part.visits, {closure.after: closure for closure in self._part.closures}
        for place, visit in enumerate(visits):
            await self._point(place, visit)
            if place in closures:
                await self._closure(closures[place])
            if not _same_row(visit, visits[place + 1 : place + 2]) and await self._row_done(visit):
                return True
        return False

    async def _point(self, place: int, visit: Visit) -> None:
        step_id, title = f"{self._steps}/{visit.command.index:04d}", title_of(self._titled, visit.command)
        fresh: list[bool] = []
        result = await self._ctx.step(
            step_id, title, self._noted(fresh, lambda: self._measured(place, visit, step_id))
        )
        segment = integer(result["segment"])
        self._follower.segment = max(self._follower.segment, segment)
        if result["measured"]:
            found = _Distance(segment, number_of(result, "displacement_mm"))
            self._distances[place] = found
            self._counted(visit, segment, found.displacement_mm)
            await self._known(visit, found, fresh=bool(fresh))
        else:
            self.left_out.append(f"{title} ({result.get('reason', 'no beam')})")
        last = self._part.visits[-1].command.index
        self._passed(visit.duration_s, f"{self._titled} point {visit.command.index + 1}/{last + 1}")

    async def _closure(self, closure: Closure) -> None:
        reference = self._part.visits[closure.reference]
        step_id = f"{self._steps}/closure/{closure.number:02d}"
        title = f"closure visit {closure.number}, planned to {title_of(self._titled, reference.command)}"
        fresh: list[bool] = []
        result = await self._ctx.step(step_id, title, self._noted(fresh, lambda: self._closed(closure)))
        self._follower.segment = max(self._follower.segment, integer(result["segment"]))
        # Earlier versions stored no distance with the step.
        if "displacement_mm" in result:
            found = _Distance(integer(result["segment"]), number_of(result, "displacement_mm"))
            await self._known(self._part.visits[integer(result["place"])], found, fresh=bool(fresh))
        self._passed(closure.duration_s, title)

    async def _known(self, visit: Visit, found: _Distance, *, fresh: bool) -> None:
        await self._knowledge.take(
            self._name,
            visit.command,
            found.segment,
            found.displacement_mm,
            self._bench.mount_deg,
            fresh=fresh,
        )

    def _noted(self, fresh: list[bool], action: Callable[[], Awaitable[Row]]) -> Callable[[], Awaitable[Row]]:
        """Return the action of a step; it takes note that it runs, and has the reflector put in its place."""

        async def noted() -> Row:
            fresh.append(True)
            self._row_is_fresh = True
            self._time.begin()
            await self._place()
            return await action()

        return noted

    async def _measured(self, place: int, visit: Visit, step_id: str) -> Row:
        before = self._part.visits[place - 1] if place else None
        measured = await self._recovery.obtain(visit, before, step_id)
        segment = self._follower.segment
        if isinstance(measured, LeftOut):
            await self._ctx.event(
                "point-left-out", reflector=self._name, point=visit.command.index, reason=measured.reason
            )
            if measured.unsettled is not None:
                # In a wrong unit readings seem never to settle.
                self._counted(visit, segment, measured.unsettled.displacement_mm)
            return {"measured": False, "segment": segment, "reason": measured.reason}
        self._ctx.record(self._distance(visit, measured))
        return {"measured": True, "segment": segment, "displacement_mm": measured.displacement_mm}

    def _distance(self, visit: Visit, measured: Measurement) -> Distance:
        follower = self._follower
        return distance_of(
            self._name, follower.segment, visit.command, follower.sent, measured, self._bench.mount_deg
        )

    def _counted(self, visit: Visit, segment: int, displacement_mm: float) -> None:
        command = visit.command
        self._counter.take(self._name, segment, command.theta1_deg, command.theta2_deg, displacement_mm)

    async def _closed(self, planned: Closure) -> Row:
        """Drive to the reference pose, measure there, and drive back."""
        follower, visits = self._follower, self._part.visits
        here = visits[planned.after]
        if follower.at is not here or not await follower.undisturbed():
            return await self._no_closure("the arm does not stand where the trip begins")
        closure = self._within_reach(planned)
        known = None if closure is None else self._reference(closure)
        if closure is None or known is None or not follower.counting:
            return await self._no_closure("the present count goes back to no pose that can be driven to")
        reference = visits[closure.reference]
        found = await follower.track(closure.out, reference) or await follower.measure(
            reference, f"{self._steps}/closure/{closure.number:02d}"
        )
        if isinstance(found, Loss):
            cause = await self._recovery.report(found, reference)
            follower.at = None
            return await self._no_closure(f"the beam was lost ({cause.name})")
        result = await self._drifted(closure, reference, known, found)
        if closure.back and (loss := await follower.track(closure.back, here)) is not None:
            await self._recovery.report(loss, here)
            follower.at = None
        return result

    def _within_reach(self, planned: Closure) -> Closure | None:
        """Return the trip, or one to another pose when a gap lies between the planned one and the present count."""
        if self._reference(planned) is not None:
            return planned
        places = [
            place
            for place, known in self._distances.items()
            if self._recovery.carried(known.segment) is not None
        ]
        return trip_within_reach(self._part.visits, planned, places, self._bench, self._part.reflector)

    def _reference(self, closure: Closure) -> "_Reference | None":
        """Return what the reference pose gave, as counted from the present zero."""
        known = self._distances.get(closure.reference)
        carried = None if known is None else self._recovery.carried(known.segment)
        if known is None or carried is None:
            return None
        return _Reference(known.displacement_mm + carried[0], carried[1])

    async def _no_closure(self, reason: str) -> Row:
        await self._ctx.event("closure-left-out", reflector=self._name, reason=reason)
        return {"measured": False, "segment": self._follower.segment, "reason": reason}

    async def _drifted(
        self, closure: Closure, reference: Visit, known: _Reference, measured: Measurement | Unsettled
    ) -> Row:
        if isinstance(measured, Unsettled):
            return await self._no_closure("its readings did not settle")
        segment = self._follower.segment
        drift_um = (measured.displacement_mm - known.displacement_mm) * 1e3
        # Each overlap is a difference of two distances, as the drift itself is.
        limit_um = self._rules.drift_limit_mm * 1e3 * math.sqrt(1.0 + known.overlaps)
        there = self._distance(reference, measured)
        self._ctx.record(
            ClosureVisit(
                number=closure.number,
                point=reference.command.index,
                reference_displacement_mm=known.displacement_mm,
                overlaps=known.overlaps,
                drift_um=drift_um,
                extra=row_of(there),
            )
        )
        self._ctx.show(Live("drift at the reference pose", drift_um, "µm", -limit_um, limit_um))
        if abs(drift_um) > limit_um:
            await self._ctx.warn(
                f"reflector {self._name}: the distance at the reference pose "
                f"({title_of(self._name, reference.command)}) has drifted by {drift_um:+.0f} µm, the limit is "
                f"{limit_um:.0f} µm: warm the arm up (warmup), keep air and room steady, and see that reflector and "
                "interferometer are clamped; what was measured meanwhile carries that drift"
            )
        return {
            "measured": True,
            "segment": segment,
            "place": closure.reference,
            "displacement_mm": measured.displacement_mm,
            "drift_um": drift_um,
        }

    async def _place(self) -> None:
        """Have the only reflector put where it is needed, before it is measured or after an interruption."""
        if self._placed:
            return
        reflector = self._part.reflector
        answer = await self._ctx.ask(
            PLACE.prompt(
                f"place/{self._steps}",
                f"Put the reflector into nest {self._name} at x {reflector.x_mm:.0f} mm, y {reflector.y_mm:.0f} mm, "
                f"facing {reflector.facing_deg:.0f}°, clamp it, step back, then confirm.",
                task=PlaceReflector(reflector=self._name),
            )
        )
        if answer != "yes":
            raise BeamLostError(
                f"the reflector is not in nest {self._name}: put it there and continue with catseye resume"
            )
        self._placed = True

    async def _row_done(self, visit: Visit) -> bool:
        fresh, self._row_is_fresh = self._row_is_fresh, False
        return await self._knowledge.row_done(
            self._name, visit.command, self._rules.stop_at_mdeg, fresh=fresh
        )

    def _passed(self, planned_s: float, text: str) -> None:
        extra_s = self._follower.extra_s - self._counted_s
        self._counted_s = self._follower.extra_s
        self._time.passed(planned_s, extra_s, text)


def _same_row(visit: Visit, following: tuple[Visit, ...]) -> bool:
    """Return whether the next point, if there is one, belongs to the same row of J2."""
    here = visit.command
    return any(
        (v.command.theta1_deg, v.command.direction1) == (here.theta1_deg, here.direction1) for v in following
    )
