"""Questions that procedures and engine declare, and prompts of them."""

import re
from pathlib import Path

import pytest

from catseye.app.engine.questions import ENGINE_QUESTIONS
from catseye.app.protocol.procedures import procedures
from catseye.procedures.kit.questions import Question

ROOMS = Path(__file__).parents[3]
DECLARED = [*ENGINE_QUESTIONS, *dict.fromkeys(one for each in procedures() for one in each.questions)]

READING = Question(
    "reading/<nest>[/<attempt>]", "number", "what it reads", "reading/N1", unit="mm", motion=True
)


@pytest.mark.parametrize("question", DECLARED, ids=lambda question: question.example)
def test_an_example_is_a_prompt_with_its_answer(question: Question) -> None:
    prompt = question.prompt(question.example, "Say something.")
    assert prompt.fault_of(question.example_answer) == ""
    assert all(prompt.fault_of(answer) == "" for answer in question.answers)
    assert question.safe_answer is None or prompt.fault_of(question.safe_answer) == ""


@pytest.mark.parametrize("question", DECLARED, ids=lambda question: question.example)
def test_a_file_lets_no_real_arm_move(question: Question) -> None:
    prompt = question.prompt(question.example, "Say something.")
    for answer in question.answers:
        permitted = question.from_file is None or answer in question.from_file
        assert permitted is not prompt.moves_after(answer)


@pytest.mark.parametrize(
    ("prompt_id", "asked"),
    [
        ("reading/N1", True),
        ("reading/N1/2", True),
        ("reading/", False),
        ("readings/N1", False),
        ("N1", False),
    ],
)
def test_an_id_fits_its_pattern(prompt_id: str, asked: bool) -> None:
    assert READING.asks(prompt_id) is asked


def test_a_prompt_of_another_id_is_refused() -> None:
    with pytest.raises(ValueError, match="none of 'reading/<nest>"):
        READING.prompt("lengths/N1", "Read it.")


def test_every_prompt_comes_from_a_declared_question() -> None:
    sources = [*(ROOMS / "procedures").rglob("*.py"), *(ROOMS / "app" / "engine").rglob("*.py")]
    building = [
        path for path in sources if re.search(r"(?<![\w.])Prompt\(", path.read_text(encoding="utf-8"))
    ]
    assert [path.relative_to(ROOMS).as_posix() for path in building] == ["procedures/kit/questions.py"]


def test_every_declared_question_is_of_a_procedure() -> None:
    files = [*(ROOMS / "procedures").rglob("questions.py")]
    ids = {
        found for file in files for found in re.findall(r'= Question\(\s*"([^"]+)"', file.read_text("utf-8"))
    }
    assert len(ids) > 15
    assert ids <= {question.id for question in DECLARED}
