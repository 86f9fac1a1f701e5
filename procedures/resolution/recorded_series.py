"""Recording a series: standstill first, then one move after another; a series that is cut short begins anew."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Final

from catseye.drivers.roles.errors import RefusedError
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.beam.loss import BeamLoss, BeamLossPolicy, Cause, LossLog, cause_of
from catseye.procedures.kit.bench import AngularOptics
from catseye.procedures.kit.context import Context, Stepped
from catseye.procedures.kit.errors import NoBeamError, StepCutShortError
from catseye.procedures.kit.recording import Recording
from catseye.procedures.kit.records import Row
from catseye.procedures.resolution.campaign_plan import CampaignPlan, Order, Place, Series
from catseye.procedures.resolution.live_steps import LiveSteps
from catseye.procedures.resolution.places import axis_number
from catseye.procedures.resolution.reading_rate import LOOK_AFTER_S, ReadingRate
from catseye.procedures.resolution.records import Configuration, Move

POLICY: Final = BeamLossPolicy(attempts=2, patience_s=10.0, may_skip=True)
"""A lost series costs a quarter of an hour: after the second one somebody looks at the optics."""

LEFT_OUT: Final[Row] = {"recording": None, "moves": 0}
"""What a step says whose series was left out."""


class SeriesRecorder:
    """Records the series of one place.

    Args:
        plan: the campaign.
        place: where the optics are set up.
        rate: looks at the rate of each recording.
    """

    def __init__(self, ctx: Context, plan: CampaignPlan, place: Place, rate: ReadingRate) -> None:
        self._ctx = ctx
        self._plan = plan
        self._place = place
        self._rate = rate
        self._optics = plan.optics(place)
        self._log = LossLog(ctx)
        self._torques = Torques(ctx)

    async def record(self, series: Series) -> Row:
        """Record a series until it is whole; the row says which recording that is, none when it is left out.

        Raises:
            BeamLostError: the beam was lost again and again and the operator stops.
            SlowCounterError: too few readings come, and nobody wants to go on.
        """
        place = self._place
        loss = BeamLoss(
            self._ctx,
            POLICY,
            f"the {place.optics} optics on {place.joint}",
            lambda number: f"beam/{series.step_id}/{number}",
            otherwise="set the optics up again in another run",
        )
        number = 0
        while True:
            number += 1
            name = f"series-{number}"
            cause = await self._recorded(series, name)
            if cause is None:
                return {"recording": name, "moves": len(series.orders)}
            await self._log.note(cause, series.title, where=series.title)
            if await loss.decide(cause, series.title, goal=series.run_in[0]) == "skip":
                return LEFT_OUT

    async def _recorded(self, series: Series, name: str) -> Cause | None:
        """Record a series once; return why it is not whole, None when it is."""
        for pose in series.run_in:
            await self._ctx.move(pose)
        if (cause := await self._zeroed()) is not None:
            return cause
        made = _Made(name)
        async with self._ctx.recording(name, self._plan.rate_hz) as recording:
            live = LiveSteps(self._ctx, series, self._place, self._optics)
            await live.stand_still(recording, LOOK_AFTER_S, self._plan.dwell_s)
            await self._rate.require(recording, series.run_in[-1])
            await live.stand_still(recording, self._plan.standstill_s - LOOK_AFTER_S, self._plan.dwell_s)
            cause = await self._moves(series, recording, made, live)
        for move in made.moves:
            self._ctx.record(move)
        if cause is None:
            self._ctx.record(self._configuration(series, made))
        return cause

    async def _zeroed(self) -> Cause | None:
        try:
            await self._ctx.zero(self._plan.dead_path_mm(self._place))
        except NoBeamError as error:
            return Cause("dark", str(error))
        status = await self._ctx.beam()
        if not status.returns(self._optics.signal_min):
            return Cause(
                "signal", f"the signal is below signal_min = {self._optics.signal_min:g}: align the optics"
            )
        return None

    async def _moves(
        self, series: Series, recording: Recording, made: "_Made", live: LiveSteps
    ) -> Cause | None:
        for number, order in enumerate(series.orders, 1):
            before = live.plateau(recording)
            try:
                stepped = await self._step(series, order)
            except StepCutShortError as error:
                return Cause("cut-short", str(error))
            await self._ctx.pause(self._plan.dwell_s)
            torques = await self._torques.read(recording)
            move = self._move(made.recording, number, order, stepped, recording, torques)
            made.moves.append(move)
            if number == len(series.orders):
                await self._rest_on(recording, made.moves)
            status = await self._ctx.beam()
            if not status.count_valid:
                return cause_of(status, self._plan.bench.arm.override_percent) or Cause(
                    "interrupted", "something was in it, or the joint left the range of the optics"
                )
            live.show(move, before, live.plateau(recording))
        return None

    async def _rest_on(self, recording: Recording, moves: Sequence[Move]) -> None:
        """Rest after the last move for as long as it took from any move to the next.

        No order follows it: with a slow controller the recording would end before the plateau of the others does.
        """
        between_s = [later.time_s - earlier.time_s for earlier, later in pairwise(moves)]
        left_s = moves[-1].time_s + min(between_s, default=0.0) - recording.elapsed_s
        if left_s > 0.0:
            await self._ctx.pause(left_s)

    async def _step(self, series: Series, order: Order) -> Stepped:
        if order.target is not None:
            return await self._ctx.step_to(order.target)
        if series.along is None:
            return await self._ctx.step_axis(self._place.joint, order.command)
        x, y, z = series.along
        size = order.command
        return await self._ctx.step_line((size * x, size * y, size * z))

    def _move(
        self,
        name: str,
        number: int,
        order: Order,
        stepped: Stepped,
        recording: Recording,
        torques: "_TorquesRead | None",
    ) -> Move:
        before, after = (self._axis_value(pose) for pose in (stepped.before, stepped.after))
        return Move(
            recording=name,
            joint=self._place.joint,
            number=number,
            sequence=order.sequence,
            # What was planned where a pose was commanded: what the arm lacked before is not part of the command.
            command=order.command
            if order.target is not None
            else math.copysign(stepped.commanded, order.command),
            time_s=recording.at(stepped.sent_s),
            ended_s=recording.at(stepped.ended_s),
            measured_before=before,
            measured_after=after,
            torque_nm=None if torques is None else self._axis_value(torques.nm),
            torque_s=None if torques is None else torques.time_s,
            extra={"before": list(stepped.before), "after": list(stepped.after)},
        )

    def _axis_value(self, values: Pose) -> float | None:
        if self._place.value is None:
            return None
        return values[axis_number(self._plan.bench, self._place.joint)]

    def _configuration(self, series: Series, made: "_Made") -> Configuration:
        optics, place = self._optics, self._place
        angular = optics if isinstance(optics, AngularOptics) else None
        return Configuration(
            recording=made.recording,
            test=series.test,
            joint=place.joint,
            position=place.name,
            position_value=place.value,
            direction=series.direction,
            unit=place.unit,
            amplitude=series.amplitude,
            absolute=int(any(order.target is not None for order in series.orders)),
            standstill_from_s=0.0,
            standstill_until_s=self._plan.standstill_s,
            dwell_s=self._plan.dwell_s,
            spacing_mm=None if angular is None else angular.spacing_mm,
            u_spacing_mm=None if angular is None else angular.u_spacing_mm,
            distance_mm=optics.distance_mm,
            moves=len(made.moves),
            extra={"pose": list(place.pose)},
        )


@dataclass
class _Made:
    """What was moved during a recording.

    Attributes:
        recording: its name.
        moves: that were made.
    """

    recording: str
    moves: list[Move] = field(default_factory=list)


@dataclass(frozen=True)
class _TorquesRead:
    """Motor torques as they were read.

    Attributes:
        time_s: the middle between question and answer, s since the recording's origin.
        nm: of the axes, N m.
    """

    time_s: float
    nm: tuple[float, ...]


class Torques:
    """Motor torques, as long as the controller states them."""

    def __init__(self, ctx: Context) -> None:
        self._ctx = ctx
        self._stated = True

    async def read(self, recording: Recording) -> _TorquesRead | None:
        """Return the torques of the axes; None where there are none, which is said once."""
        if not self._stated:
            return None
        asked_s = recording.elapsed_s
        try:
            nm = await self._ctx.torques()
            return _TorquesRead(0.5 * (asked_s + recording.elapsed_s), nm)
        except RefusedError as error:
            self._stated = False
            await self._ctx.warn(
                f"no motor torques are recorded, so no reversal error can be called valid: {error}"
            )
            return None
