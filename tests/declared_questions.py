"""Prompts that were asked, held against the questions that procedures declare."""

from collections.abc import Iterable

from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.procedure import Procedure


def undeclared(prompts: Iterable[Prompt], *procedures: Procedure | type[Procedure]) -> list[str]:
    """Return the ids of prompts that none of these procedures declares."""
    declared = [question for each in procedures for question in each.questions]
    return [
        prompt.id
        for prompt in prompts
        if not any(
            question.asks(prompt.id)
            and (question.kind, question.choices, question.safe_answer, question.motion)
            == (prompt.kind, prompt.choices, prompt.safe_answer, prompt.motion)
            for question in declared
        )
    ]
