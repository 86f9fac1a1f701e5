"""Raw traffic as lines: time, device, direction, bytes in hex and as text."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.bench import WireLine
    from catseye.drivers.roles.device import Entry

_PRINTABLE: Final = bytes(byte if 32 <= byte < 127 else ord(".") for byte in range(256))
_TIME: Final = slice(11, 23)
_DEVICE_CELLS: Final = 8
_FIXED_CELLS: Final = 12 + 1 + _DEVICE_CELLS + 1 + 2 + 2
"""Time, device, arrow and the bars around the text, with the spaces between them."""

_ARROWS: Final = {"tx": "→", "rx": "←", "heal": "!"}
_SHORT: Final = {"interferometer": "interfer", "environment": "environm"}


@dataclass(frozen=True, slots=True)
class ShownLine:
    """What passed at once.

    Attributes:
        time: of day, UTC, to the millisecond.
        device: its name in the cell file.
        dir: sent to the device, received from it, or why the link is healed.
        data: the bytes, or the text.
        left_out: bytes beyond those.
    """

    time: str
    device: str
    dir: "Entry"
    data: bytes
    left_out: int = 0

    @property
    def text(self) -> str:
        """The bytes as text; what is no character is a dot."""
        return self.data.translate(_PRINTABLE).decode("ascii")

    @property
    def arrow(self) -> str:
        """Which way it went, or that the link is healed."""
        return _ARROWS[self.dir]

    def fits(self, device: str, part: str) -> bool:
        """Return whether it passes a filter.

        Args:
            device: name; empty for all.
            part: of its text or hex digits, in small letters; empty for all.
        """
        if device and device != self.device:
            return False
        return not part or part in self.text.lower() or part.replace(" ", "") in self.data.hex()


@dataclass(frozen=True, slots=True)
class Row:
    """A part of a line that is as wide as the screen.

    Attributes:
        head: time and device; spaces behind the first part.
        arrow: which way it went.
        dir: that of the line.
        hex: bytes in hex; why the link is healed.
        text: bytes as text, and what was left out.
    """

    head: str
    arrow: str
    dir: "Entry"
    hex: str
    text: str

    @property
    def plain(self) -> str:
        """The whole row."""
        return f"{self.head} {self.arrow} {self.hex} {self.text}".rstrip()


def shown_line(line: "WireLine") -> ShownLine:
    """Return a line of the engine as it is shown."""
    data = bytes.fromhex(line.hex)
    left_out = max((line.bytes or 0) - len(data), 0)
    return ShownLine(line.t[_TIME].ljust(12), line.device, line.dir, data, left_out)


def bytes_a_row(width: int) -> int:
    """Return how many bytes stand in a row: a multiple of four, at least four, at most 32."""
    return max(4, min(32, (width - _FIXED_CELLS) // 4 // 4 * 4))


def rows_of(lines: Iterable[ShownLine], per_row: int) -> Iterator[Row]:
    """Return the rows that lines take.

    Args:
        lines: oldest first.
        per_row: bytes in each row.
    """
    for line in lines:
        name = _SHORT.get(line.device, line.device)[:_DEVICE_CELLS]
        head = f"{line.time} {name:<{_DEVICE_CELLS}}"
        share = 4 * per_row if line.dir == "heal" else per_row
        for start in range(0, max(len(line.data), 1), share):
            part = line.data[start : start + share]
            text = line.text[start : start + share]
            last = start + share >= len(line.data)
            more = f" +{line.left_out} bytes" if line.left_out and last else ""
            if line.dir == "heal":
                yield Row(head, line.arrow, line.dir, text, more)
            else:
                shown_hex = f"{part.hex(' '):<{3 * per_row - 1}}"
                yield Row(head, line.arrow, line.dir, shown_hex, f"│{text}│{more}")
            head = " " * len(head)


def saved_line(line: ShownLine) -> str:
    """Return a line as it stands in a saved file: nothing is shortened but what never came."""
    more = f" +{line.left_out} bytes" if line.left_out else ""
    shown = line.text if line.dir == "heal" else f"{line.data.hex(' ')} |{line.text}|"
    return f"{line.time} {line.device} {line.arrow} {shown}{more}"
