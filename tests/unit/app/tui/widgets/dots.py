"""Dots of braille characters, read by the names that Unicode gives them."""

import unicodedata
from collections.abc import Iterable

_PLACES = {1: (0, 0), 2: (0, 1), 3: (0, 2), 4: (1, 0), 5: (1, 1), 6: (1, 2), 7: (0, 3), 8: (1, 3)}
"""Column and row of each numbered dot in its cell, as braille numbers them."""


def dots_of(lines: Iterable[str]) -> set[tuple[int, int]]:
    """Return x and y of every dot, from the upper left corner; letters and blanks have none."""
    found = set()
    for row, line in enumerate(lines):
        for column, letter in enumerate(line):
            if letter == " " or not unicodedata.name(letter).startswith("BRAILLE PATTERN DOTS-"):
                continue
            for number in unicodedata.name(letter).rpartition("-")[2]:
                x, y = _PLACES[int(number)]
                found.add((2 * column + x, 4 * row + y))
    return found
