"""What a procedure does and how its set-up looks, for whoever has not seen it yet."""

from dataclasses import dataclass
from typing import Final

SKETCH_LINES: Final = 12
SKETCH_COLUMNS: Final = 60


@dataclass(frozen=True)
class Explanation:
    """A procedure in a paragraph and a sketch.

    Attributes:
        text: what happens, what it is for, what the person does; one paragraph.
        sketch: the set-up as a drawing of characters, at most `SKETCH_LINES` × `SKETCH_COLUMNS`.
        example: parameters of a typical run, as on the command line.
    """

    text: str = ""
    sketch: str = ""
    example: tuple[str, ...] = ()
