"""What marks data that say nothing about a real robot, or that were changed: the same words everywhere."""

from typing import Final

SIMULATION: Final = "SIMULATION"
UNVERIFIED: Final = "UNVERIFIED"

SIMULATION_TEXT: Final = (
    f"{SIMULATION}: every device is an emulator; these data say nothing about a real robot"
)


def unverified_text(reason: str) -> str:
    """Return the sentence about data that were changed after their end."""
    return f"{UNVERIFIED}: {reason}"
