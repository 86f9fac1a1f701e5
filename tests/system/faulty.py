"""The command with a fault in it: what lists the procedures fails as no command expects."""

from pathlib import Path

from catseye.app import cli
from catseye.app.cli import procedures


def _fault(cell: Path | None, runs: Path | None, as_json: bool) -> None:
    raise ZeroDivisionError(f"{cell}, {runs}, {as_json}")


if __name__ == "__main__":
    procedures.procedures_command = _fault
    cli.main()
