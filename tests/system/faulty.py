"""The command with a fault in it: what lists the procedures fails as no command expects."""

from typing import NoReturn

from catseye import entry
from catseye.app.protocol import procedures


def _fault() -> NoReturn:
    raise ZeroDivisionError("a fault of the program")


if __name__ == "__main__":
    procedures.procedures = _fault
    entry.main()
