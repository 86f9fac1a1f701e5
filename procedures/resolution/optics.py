"""Setting optics up at a place: the arm drives there, somebody mounts and aligns them, a slow motion proves it."""

from collections.abc import Awaitable, Callable
from functools import partial
from typing import Final

from catseye.procedures.kit.bench import AngularOptics, LinearOptics
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.errors import AlignmentError
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.tasks import AlignOptics, MountOptics
from catseye.procedures.resolution.campaign_plan import CampaignPlan, Place
from catseye.procedures.resolution.questions import ALIGN, DRIVE, OPTICS

_MOST_ALIGNMENTS: Final = 10
"""An answers file must not keep an arm moving for ever."""


async def set_up(ctx: Context, plan: CampaignPlan, place: Place) -> Row:
    """Drive to a place and have its optics set up; the row says whether it is left out.

    Raises:
        AlignmentError: the beam is not kept over the range, however often it was aligned, or the operator stops.
    """
    where = f"{place.joint}/{place.name}"
    if await ctx.ask(_drive(place, where)) != "yes":
        return {"skipped": True}
    await ctx.move(place.pose)
    if await _asked(ctx, _mount(plan, place, where), place) == "skip":
        return {"skipped": True}
    optics = plan.optics(place)
    fault = ""
    for number in range(1, _MOST_ALIGNMENTS + 1):
        prompt = _align(place, where, number)
        if await _asked(ctx, prompt, place, partial(_signal, ctx, optics)) == "skip":
            return {"skipped": True}
        fault = await _fault(ctx, plan, place)
        if not fault:
            return {"skipped": False, "alignments": number, "signal": (await ctx.beam()).signal}
        await ctx.warn(f"{place.joint} at {place.name}: {fault}")
    raise AlignmentError(
        f"{place.joint} at {place.name}: after {_MOST_ALIGNMENTS} alignments still: {fault}; mount the optics again, "
        "then continue with catseye resume"
    )


async def _asked(
    ctx: Context, prompt: Prompt, place: Place, watch: Callable[[], Awaitable[Live]] | None = None
) -> str:
    answer = await ctx.ask(prompt, watch)
    if answer == "stop":
        raise AlignmentError(
            f"{place.joint} at {place.name}: the operator ended the run while optics were set up; what is stored "
            "stays; continue with catseye resume"
        )
    return answer


def _drive(place: Place, where: str) -> Prompt:
    return DRIVE.prompt(
        f"drive/{where}",
        f"Take stands and cables out of the arm's way: it will drive to {place.joint} at {place.name}. May it? No "
        "leaves this position out.",
        target=place.pose,
    )


def _mount(plan: CampaignPlan, place: Place, where: str) -> Prompt:
    distance_mm = plan.optics(place).distance_mm
    if place.optics == "angular":
        text = (
            f"Mount the angular retroreflector so that it turns with {place.joint}, its axis in the plane that "
            "contains the joint's axis and is square to the beam; set up the angular interferometer in front of "
            f"it, at most {distance_mm:g} mm away, and direct the beam at it."
        )
    else:
        text = (
            f"Mount the linear retroreflector on the tool, stand the linear interferometer {distance_mm:g} mm before "
            f"it and lay the beam along {place.joint} of the base frame."
        )
    return OPTICS.prompt(
        f"mount/{where}",
        f"{text} Answer when the optics are mounted (mounted), or leave this position out (skip), or end the run "
        "(stop). The arm stands still meanwhile; alignment comes next.",
        task=MountOptics(optics=place.optics, on=place.joint),
    )


def _align(place: Place, where: str, number: int) -> Prompt:
    return ALIGN.prompt(
        f"align/{where}/{number}",
        f"Align the {place.optics} optics of {place.joint} until the signal is at its largest. Answer when they "
        "are aligned (aligned): the arm then moves over the whole range of the test. Or leave this position out "
        "(skip), or end the run (stop).",
        task=AlignOptics(),
        target=place.range_check[0],
    )


async def _signal(ctx: Context, optics: AngularOptics | LinearOptics) -> Live:
    status = await ctx.beam()
    return Live(
        "signal",
        status.signal if status.beam_ok else 0.0,
        "",
        low=optics.signal_min,
        text="turn and shift the optics until it is at its largest",
    )


async def _fault(ctx: Context, plan: CampaignPlan, place: Place) -> str:
    """Move over the whole range of the place's tests; return why the beam was not kept, empty when it was."""
    optics = plan.optics(place)
    if not (await ctx.beam()).returns(optics.signal_min):
        return f"the signal is below signal_min = {optics.signal_min:g}: align again"
    await ctx.zero(plan.dead_path_mm(place))
    fault = ""
    for pose in place.range_check:
        await ctx.move(pose)
        if not fault and not (await ctx.beam()).count_valid:
            fault = (
                "the beam is not kept over the range of the test: bring the retroreflector's axis nearer to the "
                "plane that contains the joint's axis and is square to the beam"
            )
    return fault
