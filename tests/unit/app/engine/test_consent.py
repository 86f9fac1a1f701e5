"""Every question of the program: on a real robot no answers file gives one after which the arm moves."""

import ast
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal

import pytest

from catseye import app, procedures
from catseye.app.engine.operator import Answer, Operator
from catseye.app.errors import PromptUnansweredError
from catseye.procedures.kit.context import Prompt
from tests.unit.app.engine.fakes import ManualClock

_ROOMS = [Path(str(room.__file__)).parent for room in (app, procedures)]
_ROOT = _ROOMS[0].parent


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

QUESTIONS: dict[tuple[str, str], Asked] = {
    ("app/engine/acknowledging.py", "_asked_once"): _YES,
    ("app/engine/reentry.py", "clear"): _YES,
    ("app/engine/restoring.py", "restore_override"): _YES,
    ("app/engine/reentry.py", "ask_for_reflectors"): Asked("choice", ("untouched",), ("moved",)),
    ("procedures/scara/alignment/screws.py", "_ask_sense"): Asked(
        "choice", (), ("reversed", "turned the wrong way"), "reversed"
    ),
    ("procedures/scara/alignment/screws.py", "_ask_to_turn"): _YES,
    # Where nothing can be left out, without "skip".
    ("procedures/kit/beam/loss.py", "_prompt"): Asked("choice", ("retry", "skip"), ("stop",), "stop"),
    ("procedures/scara/beam/nests.py", "place"): _YES,
    # The run drives on in any case, as it would have without the question.
    ("procedures/kit/beam/settled.py", "_prompt"): Asked("choice", ("again", "take", "skip"), (), "skip"),
    ("procedures/scara/search/sighting.py", "_prompt"): Asked("text", ("1.5", "here", "skip"), (), "skip"),
    ("procedures/scara/path/validation_path.py", "_point_prompt"): _YES,
    # Why the arm may be driven where it was not walked.
    ("app/engine/walked/rule.py", "_asked"): Asked("text", ("it was walked yesterday",), ("no",)),
    # The whole path is driven by then.
    ("procedures/scara/path/validation_path.py", "_file_prompt"): Asked("text", (), ("measured.csv",)),
    ("procedures/scara/open_loop/campaign.py", "_place"): _YES,
    ("procedures/scara/open_loop/remount.py", "_ask"): _YES,
    # "no" leaves the place out, and the next one is asked for.
    ("procedures/resolution/optics.py", "_drive"): _YES,
    ("procedures/resolution/reading_rate.py", "_prompt"): Asked("choice", ("anyway",), ("stop",), "stop"),
    # The alignment is asked for before anything moves.
    ("procedures/resolution/optics.py", "_mount"): Asked("choice", (), ("mounted", "skip", "stop"), "stop"),
    ("procedures/resolution/optics.py", "_align"): Asked("choice", ("aligned",), ("skip", "stop"), "stop"),
    ("procedures/scara/path/followed_target.py", "_prompt"): Asked("choice", ("again",), ("stop",), "stop"),
    ("procedures/serial_arm/pose_run.py", "_turn_prompt"): _YES,
    ("procedures/serial_arm/instrument_check.py", "_bar_prompt"): Asked(
        "choice", (), ("laid", "skip"), "skip"
    ),
    # The arm is led by hand; the run itself never moves it.
    ("procedures/serial_arm/ballbar_cup.py", "_seat"): Asked("choice", (), ("done", "stop"), "stop"),
    ("procedures/serial_arm/ballbar_cup.py", "_skippable"): Asked(
        "choice", (), ("skip", "done", "stop"), "skip"
    ),
    ("procedures/serial_arm/ballbar_run.py", "_confirmed"): Asked("choice", ("done",), ("stop",), "stop"),
    # What is typed lets the arm go on to the next place.
    ("procedures/serial_arm/ballbar_run.py", "_reading_prompt"): Asked("number", ("0.12",), ()),
    ("procedures/scara/radial/centring.py", "_tapped"): _YES,
    ("procedures/scara/radial/radial_run.py", "_question"): Asked("choice", ("done",), ("stop",)),
    ("procedures/scara/radial/radial_run.py", "_prompt"): Asked("number", ("12",), ()),
    ("procedures/scara/radial/radial_run.py", "_file_question"): Asked("text", ("readings.csv",), ()),
    # The whole path is driven by then.
    ("procedures/serial_arm/ballbar_run.py", "_file_prompt"): Asked("text", (), ("lengths.csv",)),
}

_ANSWERS = [(place, answer) for place, asked in QUESTIONS.items() for answer in asked.moves + asked.rests]


def _constant(node: ast.expr) -> Any:
    try:
        return ast.literal_eval(node)
    except ValueError:
        # Texts and numbers of a certain run.
        return None


def _prompt(call: ast.Call) -> Prompt:
    names = ("id", "kind", "text", "choices")
    given = dict(zip(names, map(_constant, call.args), strict=False))
    given |= {str(keyword.arg): _constant(keyword.value) for keyword in call.keywords}
    kept = {"kind", "choices", "safe_answer", "motion", "rests_after"}
    facts = {key: value for key, value in given.items() if key in kept}
    return Prompt(id="asked", text="?", **facts)


@cache
def _found() -> dict[tuple[str, str], Prompt]:
    """Return every question that the source makes, by file and function."""
    found: dict[tuple[str, str], Prompt] = {}
    for path in (path for room in _ROOMS for path in room.rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        # Most modules ask nothing, and to parse them takes seconds.
        for function in ast.walk(ast.parse(source)) if "Prompt(" in source else ():
            if not isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef):
                continue
            for call in ast.walk(function):
                if (
                    isinstance(call, ast.Call)
                    and isinstance(call.func, ast.Name)
                    and call.func.id == "Prompt"
                ):
                    found[path.relative_to(_ROOT).as_posix(), function.name] = _prompt(call)
    # Read back from an event for a front end; it asks nothing of its own.
    del found["app/protocol/prompts.py", "prompt"]
    return found


def test_every_question_of_the_program_stands_in_the_table() -> None:
    assert _found().keys() == QUESTIONS.keys()


@pytest.mark.parametrize("place", QUESTIONS)
def test_kind_and_safe_answer_are_those_of_the_table(place: tuple[str, str]) -> None:
    prompt, asked = _found()[place], QUESTIONS[place]
    assert (prompt.kind, prompt.safe_answer) == (asked.kind, asked.safe)


@pytest.mark.parametrize(("place", "answer"), _ANSWERS)
async def test_no_answers_file_starts_a_motion_of_a_real_robot(place: tuple[str, str], answer: str) -> None:
    prompt, asked = _found()[place], QUESTIONS[place]
    operator = Operator(ManualClock(), {"asked": answer}, None, simulated=False)
    if answer in asked.rests:
        assert await operator.answer(prompt) == Answer(answer, "answers file")
    elif asked.safe is None:
        with pytest.raises(PromptUnansweredError, match="given by a person"):
            await operator.answer(prompt)
    else:
        assert await operator.answer(prompt) == Answer(asked.safe, "safe answer, nobody was there")


@pytest.mark.parametrize(("place", "answer"), _ANSWERS)
async def test_a_person_may_give_every_answer(place: tuple[str, str], answer: str) -> None:
    async def ada(_prompt: Prompt) -> Answer:
        return Answer(answer, "Ada")

    operator = Operator(ManualClock(), {}, ada, simulated=False)
    assert await operator.answer(_found()[place]) == Answer(answer, "Ada")
