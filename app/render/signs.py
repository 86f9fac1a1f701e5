"""How signs look, once for all renderers."""

from dataclasses import dataclass
from typing import Final

from catseye.app.results.model import Sign


@dataclass(frozen=True)
class Look:
    """How a sign is shown.

    Attributes:
        glyph: one cell wide.
        theme: name of the colour in Textual's themes; empty for plain.
        prefix: stands before the sentence on a terminal.
    """

    glyph: str
    theme: str
    prefix: str


SIGNS: Final = {
    Sign.GOOD: Look("✓", "success", "✓ "),
    Sign.ATTENTION: Look("!", "warning", "warning: "),
    Sign.BAD: Look("✗", "error", "✗ "),
    Sign.NEUTRAL: Look("·", "", ""),
}
