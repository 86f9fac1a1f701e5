"""A distance that has settled, or the operator's word about it."""

from dataclasses import dataclass, replace

from catseye.drivers.roles.interferometer import BeamStatus
from catseye.procedures.kit.beam.questions import UNSETTLED
from catseye.procedures.kit.bench import Timing
from catseye.procedures.kit.context import Context, Measurement, Prompt
from catseye.procedures.kit.live import Live

_LASER = (
    "the laser is not ready: it is warming up or has lost its lock, and the count is worthless; look at the "
    "laser's lamp. The run continues by itself when it is ready"
)

_TRIES = 3
"""Each further try settles twice as long as the one before."""


@dataclass(frozen=True)
class Unsettled:
    """A point that the operator leaves out.

    Attributes:
        measured: the last of its readings, which scatter too much.
    """

    measured: Measurement


async def settled_measurement(ctx: Context, timing: Timing, where: str) -> Measurement | Unsettled:
    """Measure at standstill; readings that scatter too much are taken again, then the operator is asked.

    A laser that is not ready suspends the run. Its count is lost meanwhile, so the measurement is not ok then.

    Args:
        where: what is measured, unique in the run; part of the question's id.

    Returns:
        The measurement, whose count need not be valid.
    """
    question = 0
    while True:
        measured = await _tried(ctx, timing)
        if not measured.beam.laser_ready:
            await _laser_is_ready(ctx)
            return measured
        # Readings of a lost beam say nothing about settling.
        if measured.spread_mm <= timing.spread_limit_mm or not measured.beam.count_valid:
            return measured
        question += 1
        answer = await ctx.ask(_prompt(measured, timing, f"unsettled/{where}/{question}", where))
        if answer == "take":
            await ctx.event("unsettled", where=where, spread_mm=measured.spread_mm, answer=answer)
            return measured
        if answer == "skip":
            await ctx.event("unsettled", where=where, spread_mm=measured.spread_mm, answer=answer)
            return Unsettled(measured)


async def _tried(ctx: Context, timing: Timing) -> Measurement:
    """Measure until the readings have settled, at most three times."""
    for number in range(_TRIES):
        waiting = replace(timing, settle_time_s=timing.settle_time_s * 2**number)
        measured = await ctx.measure(waiting.settle_time_s, waiting.dwell_time_s, waiting.readings)
        settled = measured.spread_mm <= timing.spread_limit_mm
        if settled or not measured.beam.count_valid:
            break
        ctx.show(_spread(measured, timing))
    return measured


def _spread(measured: Measurement, timing: Timing) -> Live:
    return Live(
        "spread of the readings",
        measured.spread_mm * 1e3,
        "µm",
        high=timing.spread_limit_mm * 1e3,
        text="wait: the readings have not settled",
    )


def _prompt(measured: Measurement, timing: Timing, prompt_id: str, where: str) -> Prompt:
    spread_um, limit_um = measured.spread_mm * 1e3, timing.spread_limit_mm * 1e3
    text = (
        f"Find what shakes arm, reflector or laser: at {where} the readings scatter by {spread_um:.1f} µm after "
        f"{_TRIES} tries, spread_limit_um is {limit_um:g}. Measure again, take it, or skip it?"
    )
    return UNSETTLED.prompt(prompt_id, text)


async def beam_when_ready(ctx: Context) -> BeamStatus:
    """Return the state of the beam; a laser that is not ready suspends the run until it is."""
    status = await ctx.beam()
    if status.laser_ready:
        return status
    await _laser_is_ready(ctx)
    return await ctx.beam()


async def _laser_is_ready(ctx: Context) -> None:
    async def ready() -> bool:
        return (await ctx.beam()).laser_ready

    await ctx.wait_until(_LASER, ready)
