"""Copying out the profiles that drivers bring along."""

import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from catseye.app.cli import cli
from catseye.app.errors import UsageError
from catseye.drivers import counter

SHIPPED = Path(counter.__file__).parent / "profiles"


def asked(*words: str | Path) -> Result:
    return CliRunner().invoke(cli, ["config", "profile", *map(str, words)])


def test_a_profile_is_copied_out_with_its_comments(tmp_path: Path) -> None:
    copy = tmp_path / "mine.toml"
    done = asked("distax", "-o", copy)
    assert (done.exit_code, done.stdout) == (0, "")
    assert copy.read_bytes() == (SHIPPED / "distax.toml").read_bytes()
    assert f'profile = "{copy}"' in done.stderr


def test_without_a_file_a_profile_goes_to_stdout() -> None:
    assert tomllib.loads(asked("vacuum").stdout) == tomllib.loads(
        (SHIPPED / "vacuum.toml").read_text("utf-8")
    )


def test_without_a_name_the_profiles_are_listed() -> None:
    assert asked().stdout.splitlines() == [
        "default  line-counter",
        "distax   line-counter",
        "vacuum   line-counter",
    ]


def test_an_unknown_profile_names_those_there_are() -> None:
    done = asked("distaks")
    assert isinstance(done.exception, UsageError)
    assert str(done.exception) == (
        "there is no profile 'distaks'; did you mean distax? Drivers bring along: default, distax, vacuum"
    )


def test_a_completed_profile_is_not_overwritten(tmp_path: Path) -> None:
    copy = tmp_path / "mine.toml"
    copy.write_text("confirmed = true\n", encoding="utf-8")
    done = asked("distax", "-o", copy)
    assert isinstance(done.exception, UsageError)
    assert "mine.toml exists already" in str(done.exception)
    assert copy.read_text("utf-8") == "confirmed = true\n"


@pytest.mark.parametrize(("typed", "offered"), [("di", ["distax"]), ("", ["default", "distax", "vacuum"])])
def test_profiles_are_completed(typed: str, offered: list[str]) -> None:
    words = {"COMP_WORDS": f"catseye config profile {typed}", "COMP_CWORD": "3"}
    done = CliRunner().invoke(cli, prog_name="catseye", env={**words, "_CATSEYE_COMPLETE": "complete_bash"})
    assert done.output.split() == offered
