"""Arm, beam and count while one reflector is measured: what may be relied on, and what was lost."""

from itertools import pairwise

from catseye.drivers.roles.pose import Pose, is_at
from catseye.procedures.kit.beam.loss import Cause, cause_of
from catseye.procedures.kit.beam.settled import Unsettled, beam_when_ready, settled_measurement
from catseye.procedures.kit.context import Context, Measurement
from catseye.procedures.kit.errors import ArmMovedError, NoBeamError
from catseye.procedures.scara.beam.beam_scan import beam_mm, find_return, look_around_deg, window_deg
from catseye.procedures.scara.beam.diagnosis import (
    INTERRUPTED,
    MOVED_BY_HAND,
    NOT_SUBDIVIDED,
    Loss,
    hidden,
    no_return,
    off_aim,
    weak,
)
from catseye.procedures.scara.beam.re_aim import AimCorrection, brighten
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.motion.entry import approach, way_in
from catseye.procedures.scara.motion.visits import Leg, Visit, driving_time_s, measuring_time_s


class Follower:
    """Drives the arm, looks after the beam, and knows whether the count holds.

    Args:
        segment: number of the last segment that was used; -1 for none.

    Attributes:
        segment: number of the present segment.
        counting: the count goes on since the zero of the present segment, as far as was looked.
        at: the point at whose node the arm stands, approached from its sides; None elsewhere.
        extra_s: expected bench seconds spent beyond the plan.
    """

    def __init__(self, ctx: Context, bench: ScaraBench, reflector: Reflector, segment: int = -1) -> None:
        self.segment = segment
        self.counting = False
        self.at: Visit | None = None
        self.extra_s = 0.0
        self._ctx = ctx
        self._bench = bench
        self._reflector = reflector
        self._aim = AimCorrection()
        self._left: Pose | None = None

    @property
    def sent(self) -> Pose:
        """Where the arm was sent last.

        Raises:
            RuntimeError: nobody knows where it stands.
        """
        if self._left is None:
            raise RuntimeError("the arm has had no command since its position was last known")
        return self._left

    async def undisturbed(self) -> bool:
        """Return whether the arm still stands where it was left; somebody may have moved it during a hold."""
        if self._left is None:
            return False
        if is_at(await self._ctx.joints(), self._left):
            return True
        self.lose()
        return False

    def lose(self) -> None:
        """Rely neither on the place of the arm nor on the count any more."""
        self.counting, self.at, self._left = False, None, None

    async def track(self, legs: tuple[Leg, ...], goal: Visit) -> Loss | None:
        """Drive legs with the beam kept; where it is lost nothing drives on.

        The last leg is followed by a measurement, which looks at the latch itself.

        Args:
            goal: whose node it ends at.
        """
        self.at = None
        for leg in legs[:-1]:
            if not await self._drive(leg):
                return Loss(MOVED_BY_HAND)
            if (loss := await self._broken()) is not None:
                return loss
        if not await self._drive(legs[-1]):
            return Loss(MOVED_BY_HAND)
        self.at = goal
        return None

    async def drive(self, visit: Visit) -> Loss | None:
        """Drive the legs of a point to which the beam is not kept."""
        self.counting, self.at = False, None
        self._aim.restart()
        for number, leg in enumerate(visit.legs):
            if (number and not await self.undisturbed()) or not await self._drive(leg):
                return Loss(MOVED_BY_HAND)
        self.at = visit
        return None

    async def enter(self, visit: Visit) -> None:
        """Go to a point from wherever the arm stands, both joints from the point's sides.

        An arm that is moved by hand on the way enters once more, from where it stands then.

        Raises:
            WayBlockedError: no way there is free.
        """
        while not await self._entered(visit):
            await self._ctx.warn(f"entry, reflector {self._reflector.name}: {MOVED_BY_HAND.text}")

    async def _entered(self, visit: Visit) -> bool:
        """Go to a point; return whether nobody moved the arm meanwhile."""
        self.lose()
        self._aim.restart()
        here = await self._ctx.joints()
        take_up, node = (self._corrected(target) for target in approach(visit, self._bench, self._reflector))
        way = (*way_in(here, take_up, self._bench), node)
        await self._ctx.event(
            "entry", reflector=self._reflector.name, point=visit.command.index, targets=len(way)
        )
        for target in way:
            try:
                await self._ctx.move(target)
            except ArmMovedError:
                self.lose()
                return False
            self._left = target
        self.extra_s += sum(driving_time_s(a, ((b,),), self._bench) for a, b in pairwise((here, *way)))
        self.at = visit
        return True

    async def begin_segment(self, visit: Visit, *, centre: bool) -> Loss | None:
        """Zero the count at the node where the arm stands; a beam that is missing or weak is looked for nearby.

        Args:
            visit: at whose node the arm stands.
            centre: look for the middle of the return in any case.
        """
        status = await beam_when_ready(self._ctx)
        good = status.returns(self._bench.optics.signal_min)
        if centre or not good:
            try:
                found_deg = await self._scan(visit.node)
            except ArmMovedError:
                return self._moved_by_hand()
            if found_deg is None:
                return Loss(self._gone(visit.node))
        try:
            await self._ctx.zero(visit.beam_mm)
        except NoBeamError as error:
            return Loss(Cause("interrupted", f"{INTERRUPTED.text} ({error})"))
        self.segment += 1
        self.counting = True
        return None

    async def measure(self, visit: Visit, where: str) -> Measurement | Loss | Unsettled:
        """Measure where the arm stands.

        Args:
            visit: at whose node the arm stands.
            where: part of a question's id.
        """
        measured = await self._measured(where)
        if not isinstance(measured, Measurement) or measured.beam.signal >= self._bench.optics.signal_min:
            return measured
        try:
            kept = await self._brightened(visit)
        except ArmMovedError:
            return self._moved_by_hand()
        if not kept:
            return Loss(weak(measured.beam.signal, self._bench))
        self.extra_s += measuring_time_s(self._bench)
        again = await self._measured(where)
        if isinstance(again, Measurement) and again.beam.signal < self._bench.optics.signal_min:
            return Loss(weak(again.beam.signal, self._bench))
        return again

    async def diagnose(self, loss: Loss, visit: Visit) -> Cause:
        """Find out why the beam was lost, where the arm stands; J4 may be turned for that.

        Args:
            visit: the point on the way to which, or at which, it was lost.
        """
        if loss.cause is not None:
            return loss.cause
        status = await self._ctx.beam()
        if (stated := cause_of(status, self._bench.arm.override_percent)) is not None:
            return stated
        if visit.miss_mm > self._bench.optics.acceptance_mm:
            return NOT_SUBDIVIDED
        if not await self.undisturbed():
            return MOVED_BY_HAND
        if status.beam_ok:
            return INTERRUPTED
        try:
            return await self._looked_for()
        except ArmMovedError:
            self.lose()
            return MOVED_BY_HAND

    async def _looked_for(self) -> Cause:
        """Look for the beam where the arm stands, unless geometry says why it is gone."""
        if self._left is None:
            return MOVED_BY_HAND
        planned = (*self._left[:3], self._left[3] - self._aim.present_deg)
        before_deg = self._aim.present_deg
        found_deg = await self._scan(planned)
        if found_deg is None:
            return self._gone(planned)
        off_deg = found_deg - before_deg
        if abs(off_deg) <= window_deg(planned, self._bench, self._reflector):
            return INTERRUPTED
        return off_aim(off_deg, beam_mm(planned, self._bench, self._reflector))

    def _gone(self, joints: Pose) -> Cause:
        looked_deg = look_around_deg(joints, self._bench, self._reflector)
        return hidden(joints, self._bench, self._reflector) or no_return(looked_deg)

    def _moved_by_hand(self) -> Loss:
        self.lose()
        return Loss(MOVED_BY_HAND)

    async def _broken(self) -> Loss | None:
        status = await self._ctx.beam()
        if status.count_valid:
            return None
        return Loss(cause_of(status, self._bench.arm.override_percent))

    async def _measured(self, where: str) -> Measurement | Loss | Unsettled:
        try:
            measured = await settled_measurement(self._ctx, self._bench.timing, where)
        except NoBeamError:
            return Loss()
        if isinstance(measured, Unsettled):
            return measured
        if not measured.beam.count_valid:
            return Loss(cause_of(measured.beam, self._bench.arm.override_percent))
        if self._left is None or not is_at(measured.reported, self._left):
            self.lose()
            return Loss(MOVED_BY_HAND)
        return measured

    async def _brightened(self, visit: Visit) -> bool:
        """Turn J4 to the strongest signal without losing the count; return whether it was kept."""
        half_window_deg = window_deg(visit.node, self._bench, self._reflector)
        pose = (*visit.node[:3], self.sent[3])
        best_deg = await brighten(self._ctx, pose, half_window_deg, self._bench.j4_limits_deg)
        if best_deg is None:
            self._left = await self._ctx.joints()
            return False
        self._left = (*pose[:3], best_deg)
        self._aim.found(best_deg - visit.node[3], half_window_deg)
        return True

    async def _scan(self, planned: Pose) -> float | None:
        """Turn J4 about the plan's aim; return the offset at which the beam is centred, with J4 there."""
        half_window_deg = window_deg(planned, self._bench, self._reflector)
        limits_deg = self._bench.j4_limits_deg
        start = self._corrected(planned)
        half_range_deg = look_around_deg(start, self._bench, self._reflector)
        found = await find_return(self._ctx, start, half_range_deg, half_window_deg, limits_deg)
        if found is None:
            # Where J4 ends after a scan in vain matters to nobody, but the arm has to be left somewhere.
            await self._ctx.move(start)
            self._left = start
            return None
        self._left = (*planned[:3], found.centre_deg)
        self._aim.found(found.centre_deg - planned[3], half_window_deg)
        return self._aim.present_deg

    async def _drive(self, leg: Leg) -> bool:
        """Drive a leg; return whether nobody moved the arm meanwhile."""
        way = tuple(self._corrected(target) for target in leg)
        try:
            await self._ctx.follow(way)
        except ArmMovedError:
            self.lose()
            return False
        self._left = way[-1]
        return True

    def _corrected(self, target: Pose) -> Pose:
        return self._aim.applied(target, self._bench.j4_limits_deg)
