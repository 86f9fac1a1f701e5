"""What the command itself tells, whatever is to be done."""

from importlib.metadata import version

from typer.testing import CliRunner

from app.cli import cli


def test_the_version_is_that_of_the_package() -> None:
    told = CliRunner().invoke(cli, ["--version"])
    assert (told.exit_code, told.output) == (0, f"catseye {version('catseye')}\n")


def test_help_says_what_the_software_stop_is_not() -> None:
    told = CliRunner().invoke(cli, ["-h"])
    assert told.exit_code == 0
    assert "is not an emergency stop" in told.output
