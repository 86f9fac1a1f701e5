"""The registry of what commands write for programs, its schemas, and the page that lists them."""

import inspect
import json
import re
from pathlib import Path

import pytest
import typer
from jsonschema import Draft202012Validator
from typer.testing import CliRunner

from catseye.app.cli import cli
from catseye.app.cli.commands import COMMANDS
from catseye.app.cli.lazy import declaration_of
from catseye.app.cli.output import document_line
from catseye.app.cli.outputs import OUTPUTS, format_of, schema_of
from catseye.app.engine.questions import ENGINE_QUESTIONS
from catseye.app.protocol.procedures import procedures
from catseye.procedures.kit.questions import Question
from tests.machine_lines import faults_of

SOURCES = Path(__file__).parents[4] / "app" / "cli"
PAGE = Path(__file__).parents[4] / "docs" / "machine-output.md"


def told(*words: str) -> str:
    done = CliRunner().invoke(cli, ["schema", *words])
    assert done.exit_code == 0
    return done.stdout


@pytest.mark.parametrize("name", OUTPUTS)
def test_each_document_has_a_schema_with_its_format(name: str) -> None:
    schema = schema_of(name)
    Draft202012Validator.check_schema(schema)
    assert schema["properties"]["format"] == {"const": f"catseye-{name}/1"}
    assert schema["required"][0] == "format"


def test_every_name_that_is_written_is_registered() -> None:
    texts = [path.read_text(encoding="utf-8") for path in SOURCES.rglob("*.py")]
    written = {
        name
        for text in texts
        for name in re.findall(r'(?:write_document|self\._write)\(\s*"([a-z-]+)"', text)
    }
    # The survey names its lines itself.
    assert written | {"procedure", "stages"} == set(OUTPUTS)


def test_every_command_with_json_has_a_document() -> None:
    documented = {words.split()[0] for one in OUTPUTS.values() for words in one.commands}
    with_json = {
        name
        for name in COMMANDS
        if not isinstance(declared := declaration_of(name), typer.Typer)
        and "as_json" in inspect.signature(declared).parameters
    }
    assert with_json <= documented


def test_the_schema_is_printed_by_name_and_by_format() -> None:
    assert json.loads(told("doctor")) == schema_of("doctor")
    assert told("catseye-doctor/1") == told("doctor")


def test_the_names_are_listed_alone() -> None:
    listed = [line.split()[:2] for line in told().splitlines()]
    assert listed == [[name, format_of(name)] for name in OUTPUTS]


def test_an_unknown_document_is_a_usage_error() -> None:
    done = CliRunner().invoke(cli, ["schema", "nonsense"])
    assert "catseye schema lists the names" in str(done.exception)


def test_a_line_begins_with_its_format() -> None:
    line = document_line("detached", {"run": "r", "path": "/r"})
    assert line == '{"format": "catseye-detached/1", "run": "r", "path": "/r"}'
    assert faults_of(line) == []


@pytest.mark.parametrize(
    "line",
    [
        '{"run": "r", "path": "/r"}',
        '{"format": "catseye-detached/1", "run": "r"}',
        '{"format": "catseye-detached/1", "run": "r", "path": "/r", "more": 1}',
        '{"format": "catseye-detached/1", "run": "r", "path": NaN}',
    ],
)
def test_a_line_of_another_shape_is_noticed(line: str) -> None:
    assert faults_of(line)


def test_the_page_lists_every_question() -> None:
    tables = re.split(r"^### (.+)$", PAGE.read_text("utf-8"), flags=re.M)[1:]
    listed = {
        name: re.findall(r"^\| `([^`]+)` \| (.*?) \| (.*?) \| (.*?) \| (.*?) \|$", text, re.M)
        for name, text in zip(tables[::2], tables[1::2], strict=True)
    }
    declared = {each.name: each.questions for each in procedures() if each.questions}
    assert listed == {
        name: [_row(question) for question in questions]
        for name, questions in ({"Every procedure": ENGINE_QUESTIONS} | declared).items()
    }


def _row(question: Question) -> tuple[str, ...]:
    typed = f"{question.kind}, {question.unit}" if question.unit else question.kind
    safe = f"`{question.safe_answer}`" if question.safe_answer else ""
    file = "all" if question.from_file is None else _words(question.from_file) or "none"
    return question.id, question.about, _words(question.answers) or typed, safe, file


def _words(answers: tuple[str, ...]) -> str:
    return " ".join(f"`{answer}`" for answer in answers)


def test_prompts_say_what_a_file_may_answer() -> None:
    done = CliRunner().invoke(cli, ["prompts", "open-loop", "--json"])
    found = {entry["id"]: entry for entry in json.loads(done.stdout)["prompts"]}
    lost = found["beam/<step>[/<number>]"]
    assert (lost["answers"], lost["safe_answer"]) == (["retry", "skip", "stop"], "stop")
    assert (lost["from_file"], lost["example"]) == (["stop"], '"beam/P1/0042" = "stop"')
    assert found["resume/reflectors"]["by"] == "engine"


def test_prompts_are_listed_for_people() -> None:
    text = CliRunner().invoke(cli, ["prompts", "ballbar"]).stdout
    assert "reading/<nest>/<number>[/<attempt>]" in text
    assert "from a file on a real arm: no answer: the arm moves after it" in text


def test_the_page_lists_every_document() -> None:
    rows = re.findall(r"^\| `([a-z-]+)` \| `([^`]+)` \| (.*) \| (.*) \|$", PAGE.read_text("utf-8"), re.M)
    assert rows == [
        (name, format_of(name), ", ".join(f"`{words}`" for words in one.commands), one.summary)
        for name, one in OUTPUTS.items()
    ]
