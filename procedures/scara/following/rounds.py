"""Round trips as they are driven: the beam is kept, found again and counted anew when it is lost."""

from dataclasses import dataclass

from catseye.drivers.roles.interferometer import BeamStatus
from catseye.drivers.roles.pose import Pose, is_at
from catseye.procedures.kit.beam.loss import BeamLoss, BeamLossPolicy, Cause, LossLog, cause_of
from catseye.procedures.kit.beam.settled import Unsettled, beam_when_ready, settled_measurement
from catseye.procedures.kit.context import Context, Measurement
from catseye.procedures.kit.errors import NoBeamError
from catseye.procedures.scara.beam.beam_scan import find_return, half_window_deg
from catseye.procedures.scara.beam.diagnosis import INTERRUPTED, MOVED_BY_HAND, weak
from catseye.procedures.scara.beam.nests import Nests
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.motion.entry import way_in
from catseye.procedures.scara.motion.round_trip import RoundTrip
from catseye.procedures.scara.motion.visits import Leg

_POLICY = BeamLossPolicy(attempts=3, patience_s=15.0)
"""Three losses in a row are no accident; whoever walks through the beam is gone after 15 s."""

_SCAN_HALF_RANGE_DEG = 0.5


_GONE = Cause("no-return", "nothing returns: see what is in the beam, and whether the reflector has moved")


@dataclass(frozen=True)
class _Lost:
    """The loss that the next beginning has to deal with.

    Attributes:
        cause: why.
        where: at which measurement, or where a segment was to begin.
        kept: the beam was kept until then.
    """

    cause: Cause
    where: str
    kept: bool


class Rounds:
    """Drives round trips and begins a new segment whenever the beam was lost.

    Args:
        nests: where the one cat's eye is, if there is only one.
        segment: last segment that the run knows of, -1 for none.
    """

    def __init__(
        self, ctx: Context, bench: ScaraBench, trip: RoundTrip, nests: Nests, segment: int = -1
    ) -> None:
        self._ctx = ctx
        self._bench = bench
        self._nests = nests
        name = trip.reflector.name
        self._losses = LossLog(ctx)
        self._beam = BeamLoss(ctx, _POLICY, f"reflector {name}", lambda number: f"beam/{name}/{number}")
        self._lost: _Lost | None = None
        self._offset_deg = 0.0
        self._left: Pose | None = None
        self.trip = trip
        self.segment = segment
        self.ready = False
        """The beam has been counted without a break since this process began the segment."""

    async def begin(self) -> None:
        """Go to the first stop, find the beam and begin a new segment there, unless one goes on.

        Raises:
            BeamLostError: the operator stops after the beam was lost or not found several times in a row.
            WayBlockedError: there is no free way to the first stop.
        """
        while not self.ready:
            if (lost := self._lost) is not None:
                goal = self._aimed(self.trip.start)
                await self._beam.decide(lost.cause, lost.where, kept=lost.kept, goal=goal)
            await self._nests.place(self.trip.reflector, target=self._aimed(self.trip.start))
            if (cause := await self._begun()) is None:
                self.segment += 1
                self.ready, self._lost = True, None
            else:
                await self._lose(_start_text(self.trip), cause, kept=False)

    async def drive(self, leg: Leg) -> None:
        """Drive a leg with the beam kept."""
        way = tuple(self._aimed(target) for target in leg)
        await self._ctx.follow(way)
        self._left = way[-1]

    async def measure(self, where: str) -> Measurement | None:
        """Measure at a stop.

        Args:
            where: what is measured, unique in the run.

        Returns:
            None when there is no distance; `ready` then says if the beam was lost or the operator left the point out.
        """
        try:
            measured = await settled_measurement(self._ctx, self._bench.timing, where)
        except NoBeamError:
            await self._lose(where, _GONE)
            return None
        if isinstance(measured, Unsettled):
            return None
        if (cause := self._fault(measured.beam)) is not None:
            await self._lose(where, cause)
            return None
        if self._left is not None and not is_at(measured.reported, self._left):
            await self._lose(where, MOVED_BY_HAND)
            return None
        return measured

    def succeed(self) -> None:
        """Forget the losses so far: a round was complete."""
        self._beam.succeeded()

    async def _lose(self, where: str, cause: Cause, *, kept: bool = True) -> None:
        """Give the present segment up."""
        self.ready = False
        self._lost = _Lost(cause, where, kept)
        await self._losses.note(
            cause,
            where,
            reflector=self.trip.reflector.name,
            where=where,
            segment=self.segment,
            in_a_row=self._beam.failures + 1,
        )

    async def _begun(self) -> Cause | None:
        """Go to the first stop and zero the count on the beam there; return why that failed."""
        trip = self.trip
        for target in way_in(await self._ctx.joints(), self._aimed(trip.start), self._bench):
            await self._ctx.move(target)
        if not (await beam_when_ready(self._ctx)).beam_ok and not await self._found():
            return Cause(
                "no-return",
                f"nothing returns within ±{_SCAN_HALF_RANGE_DEG:g}° of J4 = {trip.start[3]:.2f}°: see what is in "
                "the beam",
                {"half_range_deg": _SCAN_HALF_RANGE_DEG},
            )
        try:
            await self._ctx.zero(trip.beam_mm[0])
        except NoBeamError:
            return _GONE
        status = await self._ctx.beam()
        return None if status.count_valid else self._interrupted(status)

    async def _found(self) -> bool:
        """Look for the beam by turning J4 at the first stop; return whether it is there."""
        trip, optics = self.trip, self._bench.optics
        half_window = half_window_deg(optics.acceptance_mm, trip.beam_mm[0])
        limits = self._bench.j4_limits_deg
        window = await find_return(
            self._ctx, trip.start, _SCAN_HALF_RANGE_DEG, half_window, limits, optics.signal_min
        )
        if window is not None:
            self._shift(window.centre_deg - trip.start[3])
        return window is not None

    def _fault(self, status: BeamStatus) -> Cause | None:
        """Return what a distance is worthless by; None when it is good."""
        if not status.count_valid:
            return self._interrupted(status)
        return None if status.signal >= self._bench.optics.signal_min else weak(status.signal, self._bench)

    def _interrupted(self, status: BeamStatus) -> Cause:
        stated = cause_of(status, self._bench.arm.override_percent)
        return stated or (INTERRUPTED if status.beam_ok else _GONE)

    def _shift(self, offset_deg: float) -> None:
        """Aim everywhere as the reflector was found: a wrong zero direction is wrong by the same angle everywhere."""
        low, high = self._bench.j4_limits_deg
        smallest, largest = self.trip.j4_range_deg
        self._offset_deg = (
            offset_deg if low <= smallest + offset_deg and largest + offset_deg <= high else 0.0
        )

    def _aimed(self, target: Pose) -> Pose:
        return (*target[:3], target[3] + self._offset_deg)


def _start_text(trip: RoundTrip) -> str:
    return f"reflector {trip.reflector.name} at θ1 = {trip.start[0]:g}°, θ2 = {trip.start[1]:g}°"
