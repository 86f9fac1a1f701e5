"""What follows a lost beam, by the policy alone and on a bench."""

from dataclasses import replace

import pytest

from catseye.procedures.kit.beam.loss import BeamLoss, BeamLossPolicy, Cause, Decision, LossCount, LossLog
from catseye.procedures.kit.errors import BeamLostError
from catseye.procedures.kit.tasks import ClearBeam
from tests.unit.procedures.benches import IdealContext

THREE = BeamLossPolicy(attempts=3)
ONE = BeamLossPolicy(attempts=1, most_questions=2)
SKIPS = replace(ONE, may_skip=True)
PATIENT = replace(THREE, patience_s=15.0)
GONE = Cause("no-return", "nothing returns", {"half_range_deg": 0.5})


@pytest.mark.parametrize(
    ("policy", "events", "decisions"),
    [
        (THREE, ["lost", "lost", "lost"], ["again", "again", "ask"]),
        (THREE, ["kept", "kept", "kept"], ["again", "again", "ask"]),
        (
            replace(THREE, kept_counts=False),
            ["kept", "lost", "kept", "lost", "lost"],
            ["again"] * 4 + ["ask"],
        ),
        (THREE, ["lost", "lost", "succeeded", "lost", "lost", "lost"], ["again"] * 4 + ["ask"]),
        (
            THREE,
            ["lost"] * 3 + ["retry"] + ["lost"] * 3,
            ["again", "again", "ask", "retry", "again", "again", "ask"],
        ),
        (ONE, ["lost", "stop"], ["ask", "stop"]),
        (ONE, ["lost", "skip"], ["ask", "stop"]),
        (ONE, ["lost", "anything"], ["ask", "stop"]),
        (SKIPS, ["lost", "skip"], ["ask", "skip"]),
        (SKIPS, ["lost", "retry", "lost", "skip"], ["ask", "retry", "ask", "skip"]),
        # After the last question a further failure ends the run unasked.
        (ONE, ["lost", "retry", "lost", "retry", "lost"], ["ask", "retry", "ask", "retry", "stop"]),
    ],
)
def test_decisions_follow_from_policy_losses_and_answers(
    policy: BeamLossPolicy, events: list[str], decisions: list[Decision]
) -> None:
    count, found = LossCount(policy), []
    for event in events:
        match event:
            case "lost" | "kept":
                found.append(count.lost(kept=event == "kept"))
            case "succeeded":
                count.succeeded()
            case answer:
                found.append(count.answered(answer))
    assert found == decisions


def loss_on(ctx: IdealContext, policy: BeamLossPolicy) -> BeamLoss:
    return BeamLoss(ctx, policy, "reflector P1", lambda number: f"beam/P1/{number}")


async def test_a_question_names_target_place_and_cause() -> None:
    ctx = IdealContext(places={"P1": (1000.0, 0.0)}, answers={"beam/P1/1": "retry"})
    assert await loss_on(ctx, ONE).decide(GONE, "θ1 10°", goal=(1.0, 2.0, 3.0, 4.0)) == "retry"
    (prompt,) = ctx.prompts
    assert prompt.text.startswith(
        "Clear the beam to reflector P1 (θ1 10°): nothing returns. Try again (retry), or"
    )
    assert (prompt.choices, prompt.safe_answer, prompt.motion) == (("retry", "stop"), "stop", True)
    assert prompt.task == ClearBeam()
    assert prompt.target == (1.0, 2.0, 3.0, 4.0)


async def test_skip_is_offered_where_a_place_is_optional() -> None:
    ctx = IdealContext(places={"P1": (1000.0, 0.0)}, answers={"beam/P1/1": "skip"})
    assert await loss_on(ctx, SKIPS).decide(GONE, "θ1 10°") == "skip"
    assert ctx.prompts[0].choices == ("retry", "skip", "stop")


async def test_the_operators_stop_ends_the_run_with_the_cause() -> None:
    ctx = IdealContext(places={"P1": (1000.0, 0.0)}, answers={"beam/P1/1": "stop"})
    loss = loss_on(ctx, THREE)
    await loss.decide(GONE, "θ1 10°")
    await loss.decide(GONE, "θ1 10°")
    with pytest.raises(
        BeamLostError, match=r"P1 was lost 3 times in a row: .*nothing returns.*catseye resume"
    ):
        await loss.decide(GONE, "θ1 10°")


async def test_patience_follows_failed_attempts_only() -> None:
    ctx = IdealContext(places={"P1": (1000.0, 0.0)}, answers={"beam/P1/1": "retry"})
    loss = loss_on(ctx, PATIENT)
    assert await loss.decide(GONE, "here", kept=True) == "again"
    assert ctx.pauses == []
    assert await loss.decide(GONE, "here") == "again"
    assert await loss.decide(GONE, "here") == "retry"
    assert [seconds for _, seconds in ctx.pauses] == [15.0]


async def test_every_loss_is_stored_and_some_are_warned_of_once() -> None:
    ctx = IdealContext(places={"P1": (1000.0, 0.0)})
    log = LossLog(ctx)
    for cause in (GONE, GONE, replace(GONE, name="not-subdivided", said_once=True)):
        await log.note(cause, "θ1 10°", reflector="P1")
        await log.note(cause, "θ1 10°", reflector="P1")
    assert [data["cause"] for _, data in ctx.events] == ["no-return"] * 4 + ["not-subdivided"] * 2
    assert ctx.events[0] == ("beam-lost", {"reflector": "P1", "cause": "no-return", "half_range_deg": 0.5})
    assert ctx.warnings == ["beam lost, θ1 10°: nothing returns"] * 5
