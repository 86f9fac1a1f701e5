"""Carrying a campaign out: place after place, series after series, each a step of its own."""

from functools import partial

from catseye.procedures.kit.context import Context
from catseye.procedures.kit.motion.bench_time import BenchTime
from catseye.procedures.kit.records import Row
from catseye.procedures.resolution.campaign_plan import CampaignPlan, Place, Series
from catseye.procedures.resolution.optics import set_up
from catseye.procedures.resolution.reading_rate import ReadingRate
from catseye.procedures.resolution.recorded_series import LEFT_OUT, SeriesRecorder


async def carry_out(ctx: Context, plan: CampaignPlan) -> None:
    """Set optics up at every place and record its series; what is done already is not done again.

    Raises:
        AlignmentError: optics could not be set up, or the operator stops there.
        BeamLostError: the beam was lost again and again and the operator stops.
        SlowCounterError: too few readings come, and nobody wants to go on.
    """
    time = BenchTime(ctx, plan.duration_s)
    rate = ReadingRate(ctx, accept_slow=plan.accept_slow_counter)
    for place in plan.places:
        title = f"{place.joint} at {place.name}: optics"
        optics = _Optics(ctx, plan, place)
        row = await ctx.step(f"{place.joint}/{place.name}/optics", title, optics.set_up)
        recorder = SeriesRecorder(ctx, plan, place, rate)
        for series in place.series:
            if not row["skipped"]:
                await ctx.step(
                    series.step_id, series.title, partial(_recorded, time, optics, recorder, series)
                )
            time.passed(plan.series_s(series), 0.0, series.title)


class _Optics:
    """The optics at a place: set up once, and again where somebody has moved them before the run was resumed.

    Args:
        place: where they stand.
    """

    def __init__(self, ctx: Context, plan: CampaignPlan, place: Place) -> None:
        self._ctx = ctx
        self._plan = plan
        self._place = place
        self._row: Row = {"skipped": False}
        self._stand = not ctx.set_up_lost

    async def set_up(self) -> Row:
        """Have them set up; see `set_up`."""
        self._row = await set_up(self._ctx, self._plan, self._place)
        self._stand = True
        return self._row

    async def are_there(self) -> bool:
        """Have them set up again if they do not stand any more; return whether the place is measured."""
        if not self._stand:
            await self.set_up()
        return not self._row["skipped"]


async def _recorded(time: BenchTime, optics: _Optics, recorder: SeriesRecorder, series: Series) -> Row:
    time.begin()
    if not await optics.are_there():
        return LEFT_OUT
    return await recorder.record(series)
