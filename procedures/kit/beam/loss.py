"""What is done about a lost beam: how often a run tries by itself, when it asks, and what may be answered."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final, Literal

from catseye.drivers.roles.interferometer import BeamStatus
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.beam.questions import BEAM_LOST, BEAM_NEEDED
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.errors import BeamLostError
from catseye.procedures.kit.event_text import Data, EventText, EventTexts, plain_text
from catseye.procedures.kit.questions import Question
from catseye.procedures.kit.records import Json
from catseye.procedures.kit.tasks import ClearBeam

Decision = Literal["again", "ask", "retry", "skip", "stop"]
"""What follows: another attempt by itself, a question, an attempt that somebody asked for, or neither."""


@dataclass(frozen=True)
class Cause:
    """Why a beam was lost.

    Attributes:
        name: for programs.
        text: what is wrong and what to do about it.
        facts: numbers that belong to it.
        said_once: the same warning again would say nothing new.
    """

    name: str
    text: str
    facts: dict[str, Json] = field(default_factory=dict)
    said_once: bool = False


LASER = Cause("laser", "the laser was not ready, so its count is worthless; look at the laser's lamp")


def cause_of(status: BeamStatus, override_percent: float) -> Cause | None:
    """Return the cause that the interferometer itself states.

    Args:
        override_percent: of the speed at which the beam was lost.
    """
    if not status.laser_ready:
        return LASER
    if status.overspeed:
        return Cause(
            "overspeed",
            "the beam's length changed faster than the counter counts: lower override_cap_percent (now "
            f"{override_percent:g} %) or the speed of following",
        )
    return None


@dataclass(frozen=True)
class BeamLossPolicy:
    """How a stage of a procedure deals with a lost beam.

    Attributes:
        attempts: failures in a row before somebody is asked.
        kept_counts: the loss of a beam that was kept until then is such a failure too.
        patience_s: standstill after a failed attempt: whoever walks through the beam is gone then.
        may_skip: the answer may leave the place out.
        most_questions: a failure after so many ends the run unasked: an answers file must not keep an arm moving
            for ever.
    """

    attempts: int = 3
    kept_counts: bool = True
    patience_s: float = 0.0
    may_skip: bool = False
    most_questions: int = 10


@dataclass
class LossCount:
    """Failures and questions of one place or one stage: the policy without any arm.

    Attributes:
        policy: see there.
        failures: in a row.
        questions: that were asked.
    """

    policy: BeamLossPolicy
    failures: int = 0
    questions: int = 0

    def lost(self, *, kept: bool) -> Decision:
        """Count a loss and return what follows.

        Args:
            kept: the beam was kept until then; no attempt to get it back has failed.
        """
        if kept and not self.policy.kept_counts:
            return "again"
        self.failures += 1
        if self.failures < self.policy.attempts:
            return "again"
        if self.questions >= self.policy.most_questions:
            return "stop"
        self.questions += 1
        return "ask"

    def answered(self, answer: str) -> Decision:
        """Return what follows an answer."""
        if answer == "skip" and self.policy.may_skip:
            return "skip"
        if answer != "retry":
            return "stop"
        self.failures = 0
        return "retry"

    def succeeded(self) -> None:
        """Begin to count anew."""
        self.failures = 0


class LossLog:
    """Records losses of a stage and says why."""

    def __init__(self, ctx: Context) -> None:
        self._ctx = ctx
        self._said: set[str] = set()

    async def note(self, cause: Cause, where: str, /, **facts: Json) -> None:
        """Store a loss and warn of it.

        Args:
            where: the place on the way to which, or at which, the beam was lost, for people.
            facts: what the event names beside the cause: reflector, point, segment.
        """
        await self._ctx.event("beam-lost", **facts, cause=cause.name, **cause.facts)
        if cause.said_once and cause.name in self._said:
            return
        self._said.add(cause.name)
        await self._ctx.warn(f"beam lost, {where}: {cause.text}")


class BeamLoss:
    """Decides what follows a loss: waits, asks, gives up.

    Args:
        target_name: what is aimed at, for people: reflector P1.
        question_id: returns the id of a question by its number, from 1; answers files name it.
        otherwise: what else to do where the beam does not come back.
        question: that is asked; as a rule one about a beam along which the arm is led.
    """

    def __init__(
        self,
        ctx: Context,
        policy: BeamLossPolicy,
        target_name: str,
        question_id: Callable[[int], str],
        otherwise: str = "search again (reflector-search)",
        question: Question | None = None,
    ) -> None:
        self._ctx = ctx
        self._count = LossCount(policy)
        self._target_name = target_name
        self._question_id = question_id
        self._otherwise = otherwise
        self._question = question or (BEAM_LOST if policy.may_skip else BEAM_NEEDED)

    @property
    def failures(self) -> int:
        """Failures in a row."""
        return self._count.failures

    async def decide(
        self, cause: Cause, where: str, *, kept: bool = False, goal: Pose | None = None
    ) -> Literal["again", "retry", "skip"]:
        """Count a loss and return whether to try again, by itself or as asked for, or to leave the place out.

        Args:
            where: as in `LossLog.note`.
            kept: the beam was kept until then; no attempt to get it back has failed.
            goal: where the arm goes after "retry", which the question shows.

        Raises:
            BeamLostError: the operator ends the run, or was asked as often as the policy allows.
        """
        decision = self._count.lost(kept=kept)
        times = f" {self.failures} times in a row" if self.failures > 1 else ""
        if decision == "ask":
            answer = await self._ctx.ask(
                self._prompt(cause, f"{where}, lost{times}" if times else where, goal)
            )
            decision = self._count.answered(answer)
        elif decision == "again" and not kept:
            await self._wait()
        match decision:
            case "again" | "retry" | "skip":
                return decision
        raise BeamLostError(
            f"the beam to {self._target_name} was lost{times}: check that nothing is in it and that the reflector "
            f"has not been moved. {where}: {cause.text}. What is stored stays; continue with catseye resume when "
            f"the beam is back, or {self._otherwise}"
        )

    def succeeded(self) -> None:
        """Take note that the beam was kept to the end of what the policy counts by."""
        self._count.succeeded()

    async def _wait(self) -> None:
        if self._count.policy.patience_s:
            await self._ctx.pause(self._count.policy.patience_s)

    def _prompt(self, cause: Cause, where: str, goal: Pose | None) -> Prompt:
        skip = "leave the place out (skip), " if self._count.policy.may_skip else ""
        return self._question.prompt(
            self._question_id(self._count.questions),
            f"Clear the beam to {self._target_name} ({where}): {cause.text}. Try again (retry), {skip}or end "
            "the run (stop)?",
            task=ClearBeam(),
            target=goal,
        )


def _lost_text(data: Data) -> str:
    where = f" {data['reflector']}" if data.get("reflector") else ""
    if isinstance(data.get("point"), int):
        where += f", on the way to point {data['point'] + 1}"
    elif data.get("where"):
        where += f", {data['where']}"
    known = ("reflector", "point", "where", "segment", "cause")
    rest = {key: value for key, value in data.items() if key not in known}
    text = f"BEAM LOST:{where}; segment {data.get('segment')} ends"
    if data.get("cause"):
        text += f"; cause: {data['cause']}"
    return text + (f" ({plain_text('', rest).removeprefix(': ')})" if rest else "")


LOSS_TEXTS: Final[EventTexts] = {"beam-lost": EventText(_lost_text)}
