"""Questions that are declared before anybody asks them: whoever writes an answers file finds their ids here."""

import re
from dataclasses import dataclass
from typing import Literal

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.tasks import Task


@dataclass(frozen=True)
class Question:
    """What the prompts of one question have in common.

    Attributes:
        id: of the prompts: `<reflector>` stands for what differs, `[/<number>]` for an end that may be missing.
        kind: what an answer may be.
        about: what is asked, in a few words.
        example: an id that a prompt of it has.
        choices: for kind "choice".
        unit: for kind "number".
        safe_answer: taken where nobody answers in time.
        motion: the arm moves after the answer; see `Prompt`.
        rests_after: answers after which it does not; None for the safe choice alone.
    """

    id: str
    kind: Literal["confirm", "choice", "number", "text"]
    about: str
    example: str
    choices: tuple[str, ...] = ()
    unit: str = ""
    safe_answer: str | None = None
    motion: bool = False
    rests_after: tuple[str, ...] | None = None

    def prompt(
        self,
        prompt_id: str,
        text: str,
        *,
        task: Task | None = None,
        target: Pose | None = None,
        by_person: bool = False,
    ) -> Prompt:
        """Return the question as it is put.

        Args:
            prompt_id: as `id` has it.
            text: one imperative sentence.
            task: what a person does before the answer.
            target: where the arm goes then.
            by_person: no emulated operator answers it.

        Raises:
            ValueError: the id is not one of this question.
        """
        if not self.asks(prompt_id):
            raise ValueError(f"a prompt {prompt_id!r} is none of {self.id!r}, which whoever answers knows")
        return Prompt(
            prompt_id,
            self.kind,
            text,
            choices=self.choices,
            unit=self.unit,
            safe_answer=self.safe_answer,
            task=task,
            motion=self.motion,
            rests_after=self.rests_after,
            by_person=by_person,
            target=target,
        )

    def asks(self, prompt_id: str) -> bool:
        """Return whether a prompt of this id is of this question."""
        parts = re.split(r"(<[^>]+>|\[|\])", self.id)
        regex = {"[": "(?:", "]": ")?"}
        pattern = "".join(regex.get(part) or (".+" if part[:1] == "<" else re.escape(part)) for part in parts)
        return re.fullmatch(pattern, prompt_id) is not None

    @property
    def answers(self) -> tuple[str, ...]:
        """The answers that it can have; empty where anything of its kind can be typed."""
        return ("yes", "no") if self.kind == "confirm" else self.choices

    @property
    def from_file(self) -> tuple[str, ...] | None:
        """The answers that a file may give to a real arm; None for every one: after others the arm moves."""
        if not self.motion:
            return None
        prompt = self.prompt(self.example, "")
        known = dict.fromkeys((*self.answers, *prompt.resting_answers))
        return tuple(answer for answer in known if not prompt.moves_after(answer))

    @property
    def example_answer(self) -> str:
        """An answer that it takes; one that a file may give to a real arm, where there is one."""
        known = (*(self.from_file or ()), *self.answers, *filter(None, [self.safe_answer]))
        return known[0] if known else {"number": "0.0"}.get(self.kind, "a text")
