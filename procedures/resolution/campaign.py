"""Carrying a campaign out: place after place, series after series, each a step of its own."""

from functools import partial

from catseye.procedures.kit.context import Context
from catseye.procedures.kit.motion.bench_time import BenchTime
from catseye.procedures.kit.records import Row
from catseye.procedures.resolution.campaign_plan import CampaignPlan, Series
from catseye.procedures.resolution.optics import set_up
from catseye.procedures.resolution.reading_rate import ReadingRate
from catseye.procedures.resolution.recorded_series import SeriesRecorder


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
        row = await ctx.step(f"{place.joint}/{place.name}/optics", title, partial(set_up, ctx, plan, place))
        recorder = SeriesRecorder(ctx, plan, place, rate)
        for series in place.series:
            if not row["skipped"]:
                await ctx.step(series.step_id, series.title, partial(_recorded, time, recorder, series))
            time.passed(plan.series_s(series), 0.0, series.title)


async def _recorded(time: BenchTime, recorder: SeriesRecorder, series: Series) -> Row:
    time.begin()
    return await recorder.record(series)
