"""The name of the descriptor on which a command reports to the program that started it; see `commands`."""

from typing import Final

EVENTS_FD: Final = "CATSEYE_EVENTS_FD"
"""Environment variable that names it. Without it nothing is written."""
