"""A prompt on the wire: the question as the procedures' kit has it, and the motion that follows on the answer."""

from typing import Annotated, Any, Literal, Self

from pydantic import (
    Field,
    SerializerFunctionWrapHandler,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_serializer,
)

from catseye.app.protocol.bench import AxisName
from catseye.app.protocol.message import Message
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.tasks import Task

_OF_A_MOTION = ("rests_after", "target", "override_percent", "speed_deg_s", "axes")


class MotionAfter(Message):
    """How the arm moves after an answer that lets it.

    Attributes:
        override_percent: speed override now.
        speed_deg_s: what the joints can reach at that override, in the order of the arm description's speeds; None
            where that is not known.
        axes: of the arm, which name the values of a target.
    """

    override_percent: float
    speed_deg_s: tuple[float, ...] | None
    axes: tuple[AxisName, ...] = ()


class UnknownTask(Message):
    """What hands do for a newer engine: this program has no picture of it, and the question says it in words.

    Attributes:
        do: its name.
    """

    do: str


def _known_or_not(task: object, known: ValidatorFunctionWrapHandler) -> object:
    """Return a task; one that this version does not know cuts no client off from the question."""
    try:
        return known(task)
    except ValidationError:
        return UnknownTask.model_validate(task)


SentTask = Annotated[
    Annotated[Task, Field(discriminator="do")] | UnknownTask | None, WrapValidator(_known_or_not)
]
"""A task as an engine sends it."""


class PromptFields(Message):
    """What the event `prompt` carries beside time and run; flat, as scripts read it.

    Attributes:
        id: stable within the run; answers name it.
        kind: what an answer may be.
        text: one imperative sentence.
        choices: for kind "choice".
        unit: for kind "number".
        timeout_s: how long the question stays open, bench seconds; None for ever.
        task: what hands have to do on the bench before the answer; an `UnknownTask` from a newer engine.
        safe_answer: taken when the time is over.
        motion: the arm moves after an answer that `Prompt.moves_after` says so of.
        rests_after: answers after which the arm does not move; like the rest below there only with `motion`.
        target: where it goes, in the order of the axes; None where the procedure does not know yet.
        override_percent: see `MotionAfter`.
        speed_deg_s: see `MotionAfter`.
        axes: see `MotionAfter`.
    """

    id: str
    kind: Literal["confirm", "choice", "number", "text"]
    text: str
    choices: tuple[str, ...] = ()
    unit: str = ""
    timeout_s: float | None = None
    task: SentTask = None
    safe_answer: str | None = None
    motion: bool = False
    rests_after: tuple[str, ...] | None = None
    target: tuple[float, ...] | None = None
    override_percent: float | None = None
    speed_deg_s: tuple[float, ...] | None = None
    axes: tuple[AxisName, ...] = ()

    @classmethod
    def of(cls, prompt: Prompt, motion: MotionAfter) -> Self:
        """Return a prompt as the wire has it.

        Args:
            motion: as it would be now; left out where no answer moves the arm.
        """
        asked = cls.model_validate(prompt, from_attributes=True)
        after: dict[str, Any] = {"rests_after": None, "target": None}
        if asked.motion:
            after = {"rests_after": asked.prompt.resting_answers, **dict(motion)}
        return asked.model_copy(update=after)

    @property
    def prompt(self) -> Prompt:
        """The question as the kit has it; whether only a person answers it is the engine's business."""
        return Prompt(
            id=self.id,
            kind=self.kind,
            text=self.text,
            choices=self.choices,
            unit=self.unit,
            timeout_s=self.timeout_s,
            safe_answer=self.safe_answer,
            task=None if isinstance(self.task, UnknownTask) else self.task,
            motion=self.motion,
            rests_after=self.rests_after,
            target=self.target,
        )

    @model_serializer(mode="wrap")
    def _without_motion(self, as_usual: SerializerFunctionWrapHandler) -> dict[str, Any]:
        fields: dict[str, Any] = as_usual(self)
        return fields if self.motion else {name: fields[name] for name in fields if name not in _OF_A_MOTION}
