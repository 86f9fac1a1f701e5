"""Who may answer what."""

import asyncio

import pytest

from catseye.app.engine.operator import Answer, Answerer, Operator
from catseye.app.errors import ConfigError, PromptUnansweredError
from catseye.procedures.kit.context import Prompt
from tests.unit.app.engine.fakes import ManualClock

CLEAR = Prompt("clear", "confirm", "Confirm that the cell is clear.", motion=True)
COLOUR = Prompt("colour", "choice", "Choose.", choices=("red", "green"))
HEIGHT = Prompt("height", "number", "Type the height.", unit="mm")


def person(text: str | None) -> Answerer:
    async def answer(_prompt: Prompt) -> Answer | None:
        return None if text is None else Answer(text, "Ada")

    return answer


@pytest.mark.parametrize(
    ("prompt", "good", "bad"),
    [(CLEAR, "yes", "maybe"), (COLOUR, "green", "blue"), (HEIGHT, "1.5e2", "tall"), (HEIGHT, "-3", "nan")],
)
def test_an_answer_must_fit_its_kind(prompt: Prompt, good: str, bad: str) -> None:
    assert prompt.fault_of(good) == ""
    assert prompt.fault_of(bad) != ""


async def test_the_answers_file_comes_first_on_emulated_hardware() -> None:
    operator = Operator(ManualClock(), {"clear": "no"}, person("yes"), simulated=True)
    assert await operator.answer(CLEAR) == Answer("no", "answers file")


async def test_a_wrong_answer_in_the_file_is_named() -> None:
    operator = Operator(ManualClock(), {"colour": "blue"}, None, simulated=True)
    with pytest.raises(ConfigError, match="colour = 'blue': choose one of red, green"):
        await operator.answer(COLOUR)


async def test_on_real_hardware_only_a_person_confirms() -> None:
    operator = Operator(ManualClock(), {"clear": "yes", "colour": "red"}, None, simulated=False)
    with pytest.raises(PromptUnansweredError, match="at a terminal"):
        await operator.answer(CLEAR)
    assert (await operator.answer(COLOUR)).who == "answers file"
    attended = Operator(ManualClock(), {"clear": "yes"}, person("no"), simulated=False)
    assert await attended.answer(CLEAR) == Answer("no", "Ada")


async def test_the_emulated_operator_is_willing_but_types_no_numbers() -> None:
    operator = Operator(ManualClock(), {}, person(None), simulated=True)
    assert await operator.answer(CLEAR) == Answer("yes", "emulated operator")
    safe = Prompt("colour", "choice", "Choose.", choices=("red", "green"), safe_answer="green")
    assert (await operator.answer(safe)).text == "green"
    assert (await operator.answer(COLOUR)).text == "red"
    with pytest.raises(PromptUnansweredError, match="height"):
        await operator.answer(HEIGHT)


@pytest.mark.parametrize("safe", ["no", None])
async def test_a_question_open_too_long_takes_its_safe_answer(safe: str | None) -> None:
    clock = ManualClock()

    async def nobody(_prompt: Prompt) -> Answer | None:
        await asyncio.Event().wait()
        return None

    operator = Operator(clock, {}, nobody, simulated=False)
    prompt = Prompt("clear", "confirm", "Clear?", timeout_s=60.0, safe_answer=safe)
    waiting = asyncio.create_task(operator.answer(prompt))
    for _ in range(5):
        await asyncio.sleep(0)
    clock.advance(60.0)
    if safe is None:
        with pytest.raises(PromptUnansweredError, match=r"60\.0 s"):
            await waiting
    else:
        assert (await waiting).text == "no"


async def test_an_unchecked_answer_is_a_program_fault() -> None:
    operator = Operator(ManualClock(), {}, person("perhaps"), simulated=False)
    with pytest.raises(ValueError, match="answer yes or no"):
        await operator.answer(CLEAR)
