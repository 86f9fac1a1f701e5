"""A dry run as the data that every front end shows."""

from catseye.app.engine.driven import AT_REST
from catseye.app.engine.dry_run import DryRunContext, DryStep
from catseye.app.protocol.rehearsal import Rehearsal, RehearsedJoint, RehearsedQuestion, RehearsedStep
from catseye.app.service.running import PlannedRun


def rehearsal_of(planned: PlannedRun, dry: DryRunContext) -> Rehearsal:
    """Return what a dry run of a plan did."""
    arm, speeds = planned.bench.arm, AT_REST
    for step in dry.steps:
        speeds = speeds.faster(step.speeds)
    return Rehearsal(
        procedure=planned.procedure.name,
        total_s=dry.total_s,
        override_percent=arm.override_percent,
        led_deg_s=arm.follow_speed_deg_s if arm.following == "streamed" else None,
        joint_deg_s=speeds.joint_deg_s,
        tool_mm_s=speeds.tool_mm_s,
        miss_mm=max((step.miss_mm for step in dry.steps if step.miss_mm is not None), default=None),
        max_miss_mm=dry.ideal.max_miss_mm,
        joints=tuple(RehearsedJoint(name=axis.name, unit=axis.unit) for axis in arm.axes),
        steps=tuple(map(_step, dry.steps)),
        warnings=(*(str(data.get("text")) for kind, data in dry.notes if kind == "warning"), *_excess(dry)),
        questions=tuple(
            RehearsedQuestion(id=prompt.id, kind=prompt.kind, text=prompt.text, after_s=after_s)
            for prompt, after_s in zip(dry.prompts, dry.asked_s, strict=True)
        ),
    )


def _step(step: DryStep) -> RehearsedStep:
    return RehearsedStep(
        step=step.step_id,
        title=step.title,
        moves=step.moves,
        measurements=step.measurements,
        duration_s=step.duration_s,
        first=step.first,
        end=step.end,
        joint_deg_s=step.speeds.joint_deg_s,
        tool_mm_s=step.speeds.tool_mm_s,
        beam_mm=step.beam_mm,
        miss_mm=step.miss_mm,
    )


def _excess(dry: DryRunContext) -> list[str]:
    """Return what to know about ways on which the beam misses by more than the plan's limit."""
    if not dry.excess:
        return []
    worst = max(dry.excess, key=lambda step: step.miss_mm or 0.0)
    beam = dry.ideal
    kept = "the cat's eye still returns it" if (worst.miss_mm or 0.0) <= beam.acceptance_mm else "it breaks"
    return [
        f"the beam misses by up to {worst.miss_mm:.3f} mm on the way of {worst.step_id} and by more than "
        f"max_miss_mm = {beam.max_miss_mm:g} in {len(dry.excess)} step(s); {kept} (acceptance_mm = "
        f"{beam.acceptance_mm:g}): split the moves, or move the reflector away from the arm"
    ]
