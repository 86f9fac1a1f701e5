"""The commands of the table, and how one of them is reached."""

import inspect

import pytest
import typer
from typer.testing import CliRunner

from catseye.app.cli import cli
from catseye.app.cli.commands import COMMANDS
from catseye.app.cli.lazy import declaration_of


def said(*words: str) -> tuple[int, str]:
    """Return exit code and output of a command line."""
    done = CliRunner().invoke(cli, [*words])
    return done.exit_code, done.output


@pytest.mark.parametrize("name", COMMANDS)
def test_a_summary_is_the_first_line_of_the_command(name: str) -> None:
    declared = declaration_of(name)
    text = declared.info.help if isinstance(declared, typer.Typer) else inspect.getdoc(declared)
    assert str(text).splitlines()[0] == COMMANDS[name].summary


@pytest.mark.parametrize("name", COMMANDS)
def test_each_command_explains_itself(name: str) -> None:
    code, text = said(name, "--help")
    assert code == 0
    assert text.startswith(f"Usage: catseye {name} ")
    assert COMMANDS[name].summary[:60] in text


@pytest.mark.parametrize("words", [(), ("config",), ("runs",)])
def test_listed_commands_have_whole_sentences(words: tuple[str, ...]) -> None:
    code, text = said(*words, "--help")
    assert code == 0
    assert "Commands:" in text
    assert "..." not in text.partition("Commands:")[2]


def test_a_mistyped_command_names_the_nearest() -> None:
    code, text = said("comapre")
    assert code == 2
    assert "compare" in text


def test_a_missing_option_is_a_usage_error() -> None:
    code, text = said("identify")
    assert code == 2
    assert "--output" in text


def test_a_group_offers_its_commands() -> None:
    assert [name for name in ("validate", "show", "schema") if name in said("config", "-h")[1]] == [
        "validate",
        "show",
        "schema",
    ]


@pytest.mark.parametrize(
    ("typed", "offered"),
    [("catseye com", "compare"), ("catseye compare --js", "--json"), ("catseye config va", "validate")],
)
def test_completion_knows_commands_and_options(typed: str, offered: str) -> None:
    words = {"_CATSEYE_COMPLETE": "complete_bash", "COMP_WORDS": typed, "COMP_CWORD": str(typed.count(" "))}
    assert offered in CliRunner().invoke(cli, prog_name="catseye", env=words).output
