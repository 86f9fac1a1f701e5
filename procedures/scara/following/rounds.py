"""Round trips as they are driven: the beam is kept, found again and counted anew when it is lost."""

from catseye.drivers.roles.protocols import Joints
from catseye.procedures.kit.beam.settled import settled_measurement
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.context import Context, Measurement, Prompt
from catseye.procedures.kit.errors import BeamLostError, NoBeamError
from catseye.procedures.scara.beam.beam_scan import find_return, half_window_deg
from catseye.procedures.scara.beam.nests import Nests
from catseye.procedures.scara.motion.entry import stands_at, way_in
from catseye.procedures.scara.motion.round_trip import RoundTrip
from catseye.procedures.scara.motion.visits import Leg

_FAILURES = 3
"""So many losses in a row are no accident: the operator is asked."""

_PATIENCE_S = 15.0
"""Whoever walks through the beam is gone after this."""

_SCAN_HALF_RANGE_DEG = 0.5


class Rounds:
    """Drives round trips and begins a new segment whenever the beam was lost.

    Args:
        ctx: the bench.
        bench: limits, optics, timing.
        trip: the way.
        nests: where the one cat's eye is, if there is only one.
        segment: last segment that the run knows of, -1 for none.
    """

    def __init__(self, ctx: Context, bench: Bench, trip: RoundTrip, nests: Nests, segment: int = -1) -> None:
        self._ctx = ctx
        self._bench = bench
        self._nests = nests
        self._failures = 0
        self._questions = 0
        self._offset_deg = 0.0
        self._left: Joints | None = None
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
            if self._failures >= _FAILURES:
                await self._ask()
            await self._nests.place(self.trip.reflector, target=self._aimed(self.trip.start))
            if await self._begun():
                self.segment += 1
                self.ready = True
            else:
                self._failures += 1
                if self._failures < _FAILURES:
                    await self._ctx.pause(_PATIENCE_S)

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
            None when there is no distance; `ready` then tells a lost beam from a point that the operator left out.
        """
        try:
            measured = await settled_measurement(self._ctx, self._bench.timing, where)
        except NoBeamError:
            await self._lose(where, "beam")
            return None
        if measured is not None and (cause := _cause(measured, self._bench.optics.signal_min)):
            await self._lose(where, cause)
            return None
        if measured is not None and self._left is not None and not stands_at(measured.reported, self._left):
            await self._lose(where, "moved by hand")
            return None
        return measured

    def succeed(self) -> None:
        """Forget the losses so far: a round was complete."""
        self._failures = 0

    async def _lose(self, where: str, cause: str) -> None:
        """Give the present segment up."""
        self.ready = False
        self._failures += 1
        await self._ctx.event(
            "beam-lost",
            reflector=self.trip.reflector.name,
            where=where,
            segment=self.segment,
            cause=cause,
            in_a_row=self._failures,
        )

    async def _begun(self) -> bool:
        """Go to the first stop and zero the count on the beam there."""
        trip, optics = self.trip, self._bench.optics
        for target in way_in(await self._ctx.joints(), self._aimed(trip.start), self._bench):
            await self._ctx.move(target)
        if not (await self._ctx.beam()).beam_ok:
            half_window = half_window_deg(optics.acceptance_mm, trip.beam_mm[0])
            limits = self._bench.arm.j4_limits_deg
            window = await find_return(
                self._ctx, trip.start, _SCAN_HALF_RANGE_DEG, half_window, limits, optics.signal_min
            )
            if window is None:
                await self._ctx.warn(
                    f"no beam from reflector {trip.reflector.name} at θ1 = {trip.start[0]:g}°, θ2 = "
                    f"{trip.start[1]:g}° within ±{_SCAN_HALF_RANGE_DEG:g}° of J4 = {trip.start[3]:.2f}°: look what "
                    "stands in the beam"
                )
                return False
            self._shift(window.centre_deg - trip.start[3])
        try:
            await self._ctx.zero(trip.beam_mm[0])
        except NoBeamError:
            return False
        beam = await self._ctx.beam()
        return beam.beam_ok and not beam.beam_lost

    def _shift(self, offset_deg: float) -> None:
        """Aim everywhere as the reflector was found: a wrong zero direction is wrong by the same angle everywhere."""
        low, high = self._bench.arm.j4_limits_deg
        smallest, largest = self.trip.j4_range_deg
        self._offset_deg = (
            offset_deg if low <= smallest + offset_deg and largest + offset_deg <= high else 0.0
        )

    def _aimed(self, target: Joints) -> Joints:
        return (*target[:3], target[3] + self._offset_deg)

    async def _ask(self) -> None:
        self._questions += 1
        name, times = self.trip.reflector.name, self._failures
        answer = await self._ctx.ask(
            Prompt(
                id=f"beam/{name}/{self._questions}",
                kind="choice",
                text=f"Find out why the beam to reflector {name} was lost {times} times in a row: something in its "
                "way, the reflector moved, or an aim that an older search found. Then choose retry; or stop.",
                choices=("retry", "stop"),
                safe_answer="stop",
                motion=True,
                target=self._aimed(self.trip.start),
            )
        )
        if answer != "retry":
            raise BeamLostError(
                f"the beam to reflector {name} was lost {times} times in a row: check that nothing stands in it and "
                "that the reflector has not been moved, and search for it again (catseye run reflector-search)"
            )
        self._failures = 0


def _cause(measured: Measurement, signal_min: float) -> str:
    """Return what a distance is worthless by; empty when it is good."""
    if measured.beam_ok:
        return "" if measured.signal >= signal_min else "weak signal"
    if not measured.laser_ready:
        return "laser not ready"
    return "counter overspeed" if measured.overspeed else "beam lost"
