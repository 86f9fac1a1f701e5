"""How far a command is, from the lines that it says about it."""

import re
from dataclasses import dataclass
from typing import Final

_LINE: Final = re.compile(
    r"(?P<title>.*?)\s+(?P<share>\d{1,3})%  (?P<gone>.+?) gone, (?P<left>.+?) left(?:  (?P<text>.*))?"
)
_PART: Final = re.compile(r"(?P<number>\d+) (?P<unit>h|min|s)")
_UNITS_S: Final = {"h": 3600.0, "min": 60.0, "s": 1.0}


@dataclass(frozen=True)
class CommandProgress:
    """What a command said last about its way.

    Attributes:
        share: done, 0…1.
        left_s: time that is left from when it was said, s; None where it is not known yet.
        text: what it does.
    """

    share: float
    left_s: float | None
    text: str


class ProgressReader:
    """Finds progress in what a command says, piece by piece as it comes."""

    def __init__(self) -> None:
        self._rest = ""

    def take(self, piece: str) -> CommandProgress | None:
        """Return the last progress that a piece completes; None when there is none in it."""
        *whole, self._rest = re.split(r"[\r\n]", self._rest + piece)
        found = [progress for line in whole if (progress := progress_of(line)) is not None]
        return found[-1] if found else None


def progress_of(line: str) -> CommandProgress | None:
    """Return what a line says about progress; None when it says something else."""
    match = _LINE.fullmatch(line.strip())
    if match is None:
        return None
    return CommandProgress(int(match["share"]) / 100.0, _seconds(match["left"]), match["text"] or "")


def _seconds(text: str) -> float | None:
    parts = list(_PART.finditer(text))
    return sum(float(part["number"]) * _UNITS_S[part["unit"]] for part in parts) if parts else None
