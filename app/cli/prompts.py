"""prompts: what a run of a procedure may ask, for whoever writes an answers file."""

import json
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from catseye.app.cli import completion
from catseye.app.cli.options import AsJson
from catseye.app.cli.output import note, write_document, write_line

if TYPE_CHECKING:
    from catseye.app.cli.documents import PromptEntry, PromptsDocument
    from catseye.procedures.kit.questions import Question


def prompts(
    procedure: Annotated[
        str, typer.Argument(help="see: catseye procedures", autocompletion=completion.procedures)
    ],
    as_json: AsJson = False,
) -> None:
    """List the questions that a run may ask. Also says which answers an answers file may give.

    Example: catseye prompts open-loop
    """
    document = _document(procedure)
    if as_json:
        write_document("prompts", document.json_object())
        return
    for entry in document.prompts:
        for line in _lines(entry):
            write_line(line)
    note(
        "a line of an answers file (run --answers FILE) has the id in full; emulators take every answer from it"
    )


def _document(procedure: str) -> "PromptsDocument":
    from catseye.app.cli.documents import PromptsDocument
    from catseye.app.engine.questions import ENGINE_QUESTIONS
    from catseye.app.protocol.procedures import load_procedure

    found = load_procedure(procedure)
    entries = [
        *(_entry(question, "procedure") for question in found.questions),
        *(_entry(question, "engine") for question in ENGINE_QUESTIONS),
    ]
    return PromptsDocument(procedure=found.name, prompts=tuple(entries))


def _entry(question: "Question", by: Literal["procedure", "engine"]) -> "PromptEntry":
    from catseye.app.cli.documents import PromptEntry

    return PromptEntry(
        id=question.id,
        kind=question.kind,
        about=question.about,
        answers=question.answers,
        unit=question.unit,
        safe_answer=question.safe_answer,
        motion=question.motion,
        from_file=question.from_file,
        example=f"{json.dumps(question.example)} = {json.dumps(question.example_answer)}",
        by=by,
    )


def _lines(entry: "PromptEntry") -> list[str]:
    answers = " | ".join(entry.answers) or entry.kind + (f", {entry.unit}" if entry.unit else "")
    if entry.from_file is None:
        file = "every answer"
    else:
        file = " | ".join(entry.from_file) or "no answer: the arm moves after it"
    safe = "the run ends with code 4" if entry.safe_answer is None else entry.safe_answer
    return [
        entry.id,
        f"    {entry.about}",
        f"    answers: {answers}; where nobody answers: {safe}",
        f"    from a file on a real arm: {file}",
        f"    {entry.example}",
    ]
