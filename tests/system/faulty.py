"""The command with a fault in it: what lists the procedures fails as no command expects."""

from catseye import entry
from catseye.app.protocol import installed


def _fault() -> tuple[str, ...]:
    raise ZeroDivisionError("a fault of the program")


if __name__ == "__main__":
    installed.procedure_names = _fault
    entry.main()
