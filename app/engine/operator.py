"""Who answers the questions of a run."""

import math
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass

from app.engine.waiting import within
from app.errors import ConfigError, PromptUnansweredError
from drivers.clock import Clock
from procedures.context import Prompt


@dataclass(frozen=True)
class Answer:
    """An answer and where it came from.

    Attributes:
        text: the answer; "yes" or "no" to a confirmation.
        who: the operator's name, or which part of the program.
    """

    text: str
    who: str


Answerer = Callable[[Prompt], Awaitable[Answer | None]]
"""A front end that checks what was typed with `fault_of`; None means that nobody is there."""


def fault_of(prompt: Prompt, text: str) -> str:
    """Return why a text is no answer to a prompt; empty when it is one."""
    match prompt.kind:
        case "confirm":
            return "" if text in {"yes", "no"} else "answer yes or no"
        case "choice":
            return "" if text in prompt.choices else f"choose one of {', '.join(prompt.choices)}"
        case "number":
            return "" if _is_number(text) else f"type a number{f' in {prompt.unit}' if prompt.unit else ''}"
        case "text":
            return ""


class Operator:
    """Finds an answer: from the answers file, a front end, or, with emulated devices only, by itself.

    On real hardware a confirmation is given by a person at a front end and by nothing else: the answers file
    was written before anybody saw the robot.

    Args:
        clock: of the run.
        answers: answers file, by prompt id.
        answerer: a front end, if there is one.
        simulated: all devices are emulated.
    """

    def __init__(
        self, clock: Clock, answers: Mapping[str, str], answerer: Answerer | None, *, simulated: bool
    ) -> None:
        self._clock = clock
        self._answers = answers
        self._answerer = answerer
        self._simulated = simulated

    async def answer(self, prompt: Prompt) -> Answer:
        """Return an answer.

        Raises:
            ConfigError: the answers file gives something that is no answer.
            PromptUnansweredError: nobody answered, or not in time, and there is no safe answer.
        """
        if prompt.id in self._answers and (self._simulated or prompt.kind != "confirm"):
            return self._from_file(prompt)
        try:
            found = await self._from_person(prompt)
        except TimeoutError as error:
            if prompt.safe_answer is None:
                raise PromptUnansweredError(f"no answer to {prompt.id!r} in {prompt.timeout_s} s") from error
            return Answer(prompt.safe_answer, "safe answer after the time was over")
        found = found or self._by_itself(prompt) or self._safe(prompt)
        if found is None:
            raise PromptUnansweredError(
                f"nobody is there to answer {prompt.id!r}: {prompt.text} {self._remedy(prompt)}"
            )
        return found

    def _from_file(self, prompt: Prompt) -> Answer:
        text = self._answers[prompt.id]
        if fault := fault_of(prompt, text):
            raise ConfigError(f"the answers file gives {prompt.id} = {text!r}: {fault}")
        return Answer(text, "answers file")

    async def _from_person(self, prompt: Prompt) -> Answer | None:
        if self._answerer is None:
            return None
        if prompt.timeout_s is None:
            return await self._ask(self._answerer, prompt)
        return await within(self._clock, prompt.timeout_s, self._ask(self._answerer, prompt))

    async def _ask(self, answerer: Answerer, prompt: Prompt) -> Answer | None:
        found = await answerer(prompt)
        if found is not None and (fault := fault_of(prompt, found.text)):
            raise ValueError(f"the front end answered {prompt.id} with {found.text!r}: {fault}")
        return found

    def _by_itself(self, prompt: Prompt) -> Answer | None:
        if not self._simulated:
            return None
        text = "yes" if prompt.kind == "confirm" else prompt.safe_answer
        return None if text is None else Answer(text, "emulated operator")

    def _safe(self, prompt: Prompt) -> Answer | None:
        if prompt.safe_answer is None:
            return None
        return Answer(prompt.safe_answer, "safe answer, nobody was there")

    def _remedy(self, prompt: Prompt) -> str:
        if prompt.kind == "confirm" and not self._simulated:
            return "(a confirmation for real hardware is given at a terminal)"
        return "(write it into the answers file)"


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False
