"""Lines of T2SA (sheet `trackers_ballbar`, section 5): commands that come, answers that go.

A command is a verb with its arguments: `VERB:first;second…`, or `?POS argument`. Lines end in CR LF.
"""

from dataclasses import dataclass

LONGEST_BYTES = 1024

REJECTED, BUSY, NOT_FOUND, NO_FRAME = 200, 201, 306, 314
POINT_FAILED, GROUP_FAILED, HALTED, NOT_READY, NOT_CONNECTED = 305, 340, 330, 338, 341
NO_TEMPLATE, NO_GROUP, NOT_SAVED = 312, 313, 316


@dataclass(frozen=True)
class Command:
    """A command.

    Attributes:
        verb: with its sign, `!` or `?`, if it has one.
        arguments: what stands between semicolons.
    """

    verb: str
    arguments: list[str]


def parse(line: str) -> Command:
    """Return the command of a line."""
    verb, _, rest = line.partition(" " if line.startswith("?POS ") else ":")
    return Command(verb.strip(), [part.strip() for part in rest.split(";")] if rest else [])


def good(text: str, code: int = 300) -> bytes:
    """Return the answer of a command that is carried out."""
    return f"ACK-{code} {text}\r\n".encode()


def bad(code: int, text: str) -> bytes:
    """Return the answer of a command that is not."""
    return f"ERR-{code} {text}\r\n".encode()


class LineCutter:
    """Cuts lines out of the stream of a client; one that is too long is dropped."""

    def __init__(self) -> None:
        self._buffer = b""

    def feed(self, data: bytes) -> list[str]:
        """Take bytes, cut anywhere; return the lines that are complete and not empty."""
        *lines, self._buffer = (self._buffer + data).split(b"\n")
        if len(self._buffer) > LONGEST_BYTES:
            self._buffer = b""
        found = (
            line.decode("utf-8", errors="replace").strip() for line in lines if len(line) <= LONGEST_BYTES
        )
        return [line for line in found if line]
