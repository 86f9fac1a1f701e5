"""What instruments say in words, made harmless where it leaves a driver.

A terminal obeys control characters, a reader is misled by characters that turn the direction of writing, and a line
break begins a line that nobody wrote. Protocols decode what came as it is; values and errors show it escaped.
"""

from typing import Final

LONGEST: Final = 200
"""Characters of one text of an instrument."""


def harmless(text: str, longest: int = LONGEST) -> str:
    r"""Return a text in which each character that cannot be printed stands as its escape, such as \x1b, bounded."""
    if text.isprintable() and len(text) <= longest:
        return text
    shown = "".join(
        sign if sign.isprintable() else sign.encode("unicode_escape").decode("ascii")
        for sign in text[: longest + 1]
    )
    return shown if len(shown) <= longest else f"{shown[: longest - 1]}…"


def harmless_lines(text: str) -> str:
    """Return a text of any length and any number of lines, each of them harmless; tabs stay too.

    Records of older programs hold what instruments said as it came.
    """
    if text.isprintable():
        return text
    return "".join(
        sign if sign in "\n\t" or sign.isprintable() else sign.encode("unicode_escape").decode("ascii")
        for sign in text
    )


class DeviceText:
    """Base of frozen dataclasses whose texts come from an instrument: each is harmless from the beginning."""

    def __post_init__(self) -> None:
        """Replace texts that are not harmless."""
        for name, value in vars(self).items():
            if isinstance(value, str) and (shown := harmless(value)) != value:
                object.__setattr__(self, name, shown)
