"""Who answers the questions of a run."""

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import mkdtemp

from catseye.app.engine.simulated_operator import SimulatedOperator
from catseye.app.engine.waiting import within
from catseye.app.errors import ConfigError, PromptUnansweredError
from catseye.drivers.roles.clock import Clock
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.records import Json
from catseye.procedures.kit.tasks import ExportBallbar, ReadBallbar, ReadIndicator


@dataclass(frozen=True)
class Answer:
    """An answer and where it came from.

    Attributes:
        text: the answer; "yes" or "no" to a confirmation.
        who: the operator's name, or which part of the program.
        done: what the emulated operator's hands did for it on the bench.
    """

    text: str
    who: str
    done: Mapping[str, Json] | None = None


Answerer = Callable[[Prompt], Awaitable[Answer | None]]
"""A front end that checks what was typed with `Prompt.fault_of`; None means that nobody is there."""


def says_done(prompt: Prompt, text: str) -> bool:
    """Return whether an answer says that the prompt's task is done: "yes", the first choice, any number or text."""
    match prompt.kind:
        case "confirm":
            return text == "yes"
        case "choice":
            return text == prompt.choices[0]
        case "number" | "text":
            return True


class Operator:
    """Finds an answer: from the answers file, a front end, or, with emulated devices only, by itself.

    On emulated devices an answer that says that the prompt's task is done has it done, whoever gives the answer.

    On real hardware an answer after which the arm moves is given by a person at a front end and by nothing else: the
    answers file was written before anybody saw the robot. Where nobody is there the procedure's safe answer counts.

    Args:
        answers: answers file, by prompt id.
        hands: of the emulated operator; None where the cell has no [tracker] to reach the emulated bench by.
    """

    def __init__(
        self,
        clock: Clock,
        answers: Mapping[str, str],
        answerer: Answerer | None,
        *,
        simulated: bool,
        hands: SimulatedOperator | None = None,
    ) -> None:
        self._hands = hands
        self._clock = clock
        self._answers = answers
        self._answerer = answerer
        self._simulated = simulated

    async def answer(self, prompt: Prompt) -> Answer:
        """Return an answer, its task done on an emulated bench.

        Raises:
            ConfigError: the answers file gives something that is no answer, or no hands can reach the bench.
            LinkFailedError: the emulated bench does not do the task.
            PromptUnansweredError: nobody answered, or not in time, and there is no safe answer.
        """
        found = await self._find(prompt)
        if prompt.task is None or not self._simulated or not says_done(prompt, found.text):
            return found
        if self._hands is None:
            raise ConfigError(
                f"nobody can do on the emulated bench what {prompt.id!r} asks for: {prompt.text} Add a [tracker] "
                "with the endpoint of the bench's control port, or its control, to the cell file"
            )
        if isinstance(prompt.task, ExportBallbar):
            return replace(found, done=await self._hands.export(Path(found.text)))
        return replace(found, done=await self._hands.do(prompt.task))

    async def _find(self, prompt: Prompt) -> Answer:
        if self._permits(prompt, self._answers.get(prompt.id)):
            return self._from_file(prompt)
        try:
            found = await self._from_person(prompt)
        except TimeoutError as error:
            found = self._safe(prompt, "safe answer after the time was over")
            if found is None:
                raise PromptUnansweredError(f"no answer to {prompt.id!r} in {prompt.timeout_s} s") from error
            return found
        found = found or await self._by_itself(prompt) or self._safe(prompt, "safe answer, nobody was there")
        if found is None:
            raise PromptUnansweredError(
                f"nobody is there to answer {prompt.id!r}: {prompt.text} {self._remedy(prompt)}"
            )
        return found

    def _permits(self, prompt: Prompt, text: str | None) -> bool:
        """Return whether the answers file gives an answer, and may."""
        return text is not None and (self._simulated or not prompt.moves_after(text))

    def _from_file(self, prompt: Prompt) -> Answer:
        text = self._answers[prompt.id]
        if fault := prompt.fault_of(text):
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
        if found is not None and (fault := prompt.fault_of(found.text)):
            raise ValueError(f"the front end answered {prompt.id} with {found.text!r}: {fault}")
        return found

    async def _by_itself(self, prompt: Prompt) -> Answer | None:
        if not self._simulated or prompt.by_person:
            return None
        text = _best_answer(prompt)
        if isinstance(prompt.task, ReadBallbar | ReadIndicator) and self._hands is not None:
            read = await self._hands.read(prompt.task)
            text = text if prompt.fault_of(read) else read
        if isinstance(prompt.task, ExportBallbar):
            text = str(Path(mkdtemp(prefix="catseye-ballbar-")) / "recording.csv")
        return None if text is None else Answer(text, "emulated operator")

    def _safe(self, prompt: Prompt, who: str) -> Answer | None:
        return None if prompt.safe_answer is None else Answer(prompt.safe_answer, who)

    def _remedy(self, prompt: Prompt) -> str:
        if prompt.motion and not self._simulated:
            return "(an answer after which a real arm moves is given by a person at a terminal or the terminal UI)"
        return "(write it into the answers file)"


def _best_answer(prompt: Prompt) -> str | None:
    """Return what a willing operator of an emulated bench answers; None to what only a person can know."""
    if prompt.kind == "confirm":
        return "yes"
    if prompt.kind == "choice" and (prompt.task is not None or prompt.safe_answer is None):
        return prompt.choices[0]
    return prompt.safe_answer
