"""Every question of the program: on a real robot no answers file gives one after which the arm moves."""

from dataclasses import dataclass
from types import ModuleType
from typing import Literal

import pytest

from catseye.app.engine import questions as of_engine
from catseye.app.engine.operator import Answer, Operator
from catseye.app.errors import PromptUnansweredError
from catseye.procedures.kit.beam import questions as of_beam
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.questions import Question
from catseye.procedures.resolution import questions as of_resolution
from catseye.procedures.scara import questions as of_scara
from catseye.procedures.serial_arm import questions as of_serial_arms
from tests.unit.app.engine.fakes import ManualClock


@dataclass(frozen=True)
class Asked:
    """What a question has to be, worked out by hand from what the procedure does after each answer.

    Attributes:
        kind: of the question.
        moves: answers after which the arm moves.
        rests: answers after which it does not.
        safe: what is taken where nobody is there; None ends the run.
    """

    kind: Literal["confirm", "choice", "number", "text"]
    moves: tuple[str, ...]
    rests: tuple[str, ...]
    safe: str | None = None


_YES = Asked("confirm", ("yes",), ("no",))

QUESTIONS: dict[str, Asked] = {
    "ACKNOWLEDGE": _YES,
    "CLEAR": _YES,
    "OVERRIDE": _YES,
    "REFLECTORS": Asked("choice", ("untouched",), ("moved",)),
    # Why the arm may be driven where it was not walked.
    "WALK_WAIVER": Asked("text", ("it was walked yesterday",), ("no",)),
    "BEAM_LOST": Asked("choice", ("retry", "skip"), ("stop",), "stop"),
    # Nothing can be left out.
    "BEAM_NEEDED": Asked("choice", ("retry",), ("stop",), "stop"),
    # The run drives on in any case, as it would have without the question.
    "UNSETTLED": Asked("choice", ("again", "take", "skip"), (), "skip"),
    "SCREW_SENSE": Asked("choice", (), ("reversed", "turned the wrong way"), "reversed"),
    "SCREW": _YES,
    "SCREW_BEAM_LOST": Asked("choice", ("retry",), ("stop",), "stop"),
    "PLACE": _YES,
    "JOG": Asked("text", ("1.5", "here", "skip"), (), "skip"),
    "MOUNT": _YES,
    "POINT": _YES,
    # The whole path is driven by then.
    "MEASURED_FILE": Asked("text", (), ("measured.csv",)),
    "TARGET": Asked("choice", ("again",), ("stop",), "stop"),
    # What is typed lets the arm go on to the next place.
    "INDICATOR": Asked("number", ("12",), ()),
    "INDICATOR_FILE": Asked("text", ("readings.csv",), ()),
    "CENTRE": Asked("number", ("12",), ()),
    "TAP": _YES,
    "ARTEFACT": Asked("choice", ("done",), ("stop",)),
    # "no" leaves the place out, and the next one is asked for.
    "DRIVE": _YES,
    # The alignment is asked for before anything moves.
    "OPTICS": Asked("choice", (), ("mounted", "skip", "stop"), "stop"),
    "ALIGN": Asked("choice", ("aligned",), ("skip", "stop"), "stop"),
    "SLOW_COUNTER": Asked("choice", ("anyway",), ("stop",), "stop"),
    "TURN": _YES,
    "BAR": Asked("choice", (), ("laid", "skip"), "skip"),
    "BALLBAR_MOUNTED": Asked("choice", ("done",), ("stop",), "stop"),
    "READING": Asked("number", ("0.12",), ()),
    # The whole path is driven by then.
    "LENGTHS_FILE": Asked("text", (), ("lengths.csv",)),
    # The arm is led by hand; the run itself never moves it.
    "SEATED": Asked("choice", (), ("done", "stop"), "stop"),
    "COMPARED": Asked("choice", (), ("skip", "done", "stop"), "skip"),
}
"""By the names of their declarations; prompts are made from these alone."""

_ANSWERS = [(name, answer) for name, asked in QUESTIONS.items() for answer in asked.moves + asked.rests]


def _declared(*rooms: ModuleType) -> dict[str, Question]:
    found: dict[str, Question] = {}
    for room in rooms:
        found |= {name: one for name, one in vars(room).items() if isinstance(one, Question)}
    return found


_FOUND = _declared(of_engine, of_beam, of_scara, of_resolution, of_serial_arms)


def _asked(name: str) -> Prompt:
    return _FOUND[name].prompt(_FOUND[name].example, "?")


def test_every_question_of_the_program_stands_in_the_table() -> None:
    assert _FOUND.keys() == QUESTIONS.keys()


@pytest.mark.parametrize("name", QUESTIONS)
def test_kind_and_safe_answer_are_those_of_the_table(name: str) -> None:
    prompt, asked = _asked(name), QUESTIONS[name]
    assert (prompt.kind, prompt.safe_answer) == (asked.kind, asked.safe)


@pytest.mark.parametrize(("name", "answer"), _ANSWERS)
async def test_no_answers_file_starts_a_motion_of_a_real_robot(name: str, answer: str) -> None:
    prompt, asked = _asked(name), QUESTIONS[name]
    operator = Operator(ManualClock(), {prompt.id: answer}, None, simulated=False)
    if answer in asked.rests:
        assert await operator.answer(prompt) == Answer(answer, "answers file")
    elif asked.safe is None:
        with pytest.raises(PromptUnansweredError, match="given by a person"):
            await operator.answer(prompt)
    else:
        assert await operator.answer(prompt) == Answer(asked.safe, "safe answer, nobody was there")


@pytest.mark.parametrize(("name", "answer"), _ANSWERS)
async def test_a_person_may_give_every_answer(name: str, answer: str) -> None:
    async def ada(_prompt: Prompt) -> Answer:
        return Answer(answer, "Ada")

    operator = Operator(ManualClock(), {}, ada, simulated=False)
    assert await operator.answer(_asked(name)) == Answer(answer, "Ada")
