"""An emulated bench whose interferometer tries to command the terminal of whoever asks for its name."""

from typing import Any
from unittest.mock import patch

from catseye.simulators.attocube.device import Ids
from tests.system.altered_bench import main

TITLE = "OWNED"
NAME = f"EMULATOR\x1b]0;{TITLE}\x07\x1b[31mred\x9b31m\u202eesrever\u2066\nline two\r\x00[/bold]"

_of_the_maker = Ids._common  # noqa: SLF001  # the emulator has no setting for a hostile name


def hostile(self: Ids) -> dict[str, Any]:
    """Return the methods, with another answer to the question for the name."""
    return _of_the_maker(self) | {"system.getDeviceType": lambda: [0, NAME]}


if __name__ == "__main__":
    with patch.object(Ids, "_common", hostile):
        main(lambda config: config)
