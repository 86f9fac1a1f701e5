"""The door of the cell."""

from dataclasses import dataclass


@dataclass
class Door:
    """The cell's door.

    Attributes:
        closed: its present state; the control port opens it.
    """

    closed: bool = True
