"""What a rehearsal found, as a step table or as data."""

from catseye.app.cli.output import note, table, warn, write_json, write_line
from catseye.app.engine.arm_model import AT_REST, Speeds
from catseye.app.engine.dry_run import DryRunContext, DryStep
from catseye.app.results.numbers import duration_text
from catseye.app.service.running import PlannedRun
from catseye.procedures.kit.bench import Arm
from catseye.procedures.kit.records import Json

_HEADER = [
    "step",
    "moves",
    "points",
    "s",
    "J1 deg",
    "J2 deg",
    "J3 mm",
    "J4 deg",
    "joint deg/s",
    "tool mm/s",
    "beam mm",
    "miss mm",
]

_QUESTIONS_NAMED = 8


def write_rehearsal(planned: PlannedRun, context: DryRunContext, *, as_json: bool) -> None:
    """Write the step table to stdout, and what there is to know about it to stderr.

    Args:
        planned: what was rehearsed.
        context: what happened.
        as_json: one JSON object instead of the table.
    """
    if as_json:
        write_json(_as_json(planned, context))
    else:
        write_line(table(_HEADER, [_row(step) for step in context.steps]))
    for text in (*_warnings(context), *_excesses(context)):
        warn(text)
    note(_totals(planned, context))
    if context.prompts:
        note(_questions(context))


def _row(step: DryStep) -> list[object]:
    return [
        step.step_id,
        step.moves,
        step.measurements,
        f"{step.duration_s:.2f}",
        *(f"{value:.3f}" for value in step.end),
        f"{step.speeds.joint_deg_s:.1f}",
        f"{step.speeds.tool_mm_s:.0f}",
        "–" if step.beam_mm is None else f"{step.beam_mm:.1f}",
        "–" if step.miss_mm is None else f"{step.miss_mm:.3f}",
    ]


def _as_json(planned: PlannedRun, context: DryRunContext) -> dict[str, Json]:
    speeds, miss_mm = _peaks(context)
    return {
        "procedure": planned.procedure.name,
        "total_s": context.total_s,
        "override_percent": planned.bench.arm.override_percent,
        "joint_deg_s": speeds.joint_deg_s,
        "tool_mm_s": speeds.tool_mm_s,
        "miss_mm": miss_mm,
        "max_miss_mm": planned.bench.optics.max_miss_mm,
        "steps": [_step_as_json(step) for step in context.steps],
        "warnings": [*_warnings(context), *_excesses(context)],
        "questions": [{"id": p.id, "kind": p.kind, "text": p.text} for p in context.prompts],
    }


def _step_as_json(step: DryStep) -> Json:
    return {
        "step": step.step_id,
        "title": step.title,
        "moves": step.moves,
        "measurements": step.measurements,
        "duration_s": round(step.duration_s, 3),
        "end": [round(value, 4) for value in step.end],
        "joint_deg_s": round(step.speeds.joint_deg_s, 3),
        "tool_mm_s": round(step.speeds.tool_mm_s, 3),
        "beam_mm": None if step.beam_mm is None else round(step.beam_mm, 3),
        "miss_mm": None if step.miss_mm is None else round(step.miss_mm, 4),
    }


def _peaks(context: DryRunContext) -> tuple[Speeds, float | None]:
    speeds = AT_REST
    for step in context.steps:
        speeds = speeds.faster(step.speeds)
    return speeds, max((step.miss_mm for step in context.steps if step.miss_mm is not None), default=None)


def _warnings(context: DryRunContext) -> list[str]:
    return [str(data.get("text")) for kind, data in context.notes if kind == "warning"]


def _excesses(context: DryRunContext) -> list[str]:
    """Return what to know about ways on which the beam misses by more than the plan's limit."""
    if not context.excess:
        return []
    worst = max(context.excess, key=lambda step: step.miss_mm or 0.0)
    optics = context.bench.optics
    kept = "the cat's eye still returns it" if (worst.miss_mm or 0.0) <= optics.acceptance_mm else "it breaks"
    return [
        f"the beam misses by up to {worst.miss_mm:.3f} mm on the way of {worst.step_id} and by more than "
        f"max_miss_mm = {optics.max_miss_mm:g} in {len(context.excess)} step(s); {kept} (acceptance_mm = "
        f"{optics.acceptance_mm:g}): split the moves, or move the reflector away from the arm"
    ]


def _totals(planned: PlannedRun, context: DryRunContext) -> str:
    moves = sum(step.moves for step in context.steps)
    points = sum(step.measurements for step in context.steps)
    speeds, miss_mm = _peaks(context)
    missing = "" if miss_mm is None else f"; the beam misses by {miss_mm:.3f} mm at most where it is kept"
    limits = (
        "the joints' limits hold, max_miss_mm does not"
        if context.excess
        else "every limit of the cell file holds"
    )
    return (
        f"{len(context.steps)} steps, {moves} moves, {points} distances, "
        f"about {duration_text(context.total_s, whole=True)} at {_speed_limit(planned.bench.arm)}; "
        f"fastest joint {speeds.joint_deg_s:.1f} deg/s, tool {speeds.tool_mm_s:.0f} mm/s{missing}; "
        f"{limits}; nothing was moved"
    )


def _speed_limit(arm: Arm) -> str:
    if arm.following == "streamed":
        return f"{arm.override_percent:g} % override, led at {arm.follow_speed_deg_s:g} deg/s at most"
    return f"{arm.override_percent:g} % override"


def _questions(context: DryRunContext) -> str:
    names = list(dict.fromkeys(prompt.id for prompt in context.prompts))
    shown = ", ".join(names[:_QUESTIONS_NAMED]) + (", …" if len(names) > _QUESTIONS_NAMED else "")
    return f"{len(names)} question{'' if len(names) == 1 else 's'}: {shown}"
