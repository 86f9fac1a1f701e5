"""Where a question lies open until somebody who may answers it."""

import asyncio
from collections.abc import Callable

from catseye.app.engine.operator import Answer
from catseye.app.service.errors import RefusedError
from catseye.procedures.kit.context import Prompt


class PromptBroker:
    """Implements `catseye.app.engine.operator.Answerer`: the answer comes from the console or a client with control.

    Args:
        attended: whether somebody is there to answer, now or later.
    """

    def __init__(self, attended: Callable[[], bool]) -> None:
        self._attended = attended
        self._open: Prompt | None = None
        self._answer: Answer | None = None
        self._answered = asyncio.Event()

    @property
    def open(self) -> Prompt | None:
        """The question that waits for an answer."""
        return self._open if self._answer is None else None

    def announce(self, prompt: Prompt) -> None:
        """Take a question as soon as front ends hear of it; the engine asks for the answer a moment later."""
        self._open, self._answer = prompt, None
        self._answered.clear()

    def withdraw(self) -> None:
        """The question is over: answered here, elsewhere, or not at all."""
        self._open = self._answer = None

    def answer(self, prompt_id: str, text: str, who: str) -> None:
        """Give an answer.

        Raises:
            RefusedError: that question is not open, or this is no answer to it; it stays open.
        """
        if self.open is None:
            raise RefusedError(f"no question is open; {prompt_id!r} was answered or dropped")
        if prompt_id != self.open.id:
            raise RefusedError(
                f"{prompt_id!r} is not the open question; open is {self.open.id!r}: {self.open.text}"
            )
        if fault := self.open.fault_of(text):
            raise RefusedError(f"{text!r} is not an answer to {prompt_id!r}: {fault}")
        self._answer = Answer(text, who)
        self._answered.set()

    async def __call__(self, prompt: Prompt) -> Answer | None:
        """Wait for the answer; None at once when nobody is there."""
        if self._answer is None:
            if not self._attended():
                return None
            self.announce(prompt)
            try:
                await self._answered.wait()
            except asyncio.CancelledError:
                self.withdraw()
                raise
        found = self._answer
        self.withdraw()
        return found
