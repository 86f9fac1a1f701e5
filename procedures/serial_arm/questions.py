"""What procedures of a serial arm ask."""

from typing import Final

from catseye.procedures.kit.questions import Question

TURN: Final = Question(
    "turn/<joint>-<joint>",
    "confirm",
    "the target sits in its nest; the arm turns two joints",
    "turn/A1-A2",
    motion=True,
)

BAR: Final = Question(
    "bar/<place>",
    "choice",
    "the scale bar is laid, or its place is left out",
    "bar/1",
    choices=("laid", "skip"),
    safe_answer="skip",
)

BALLBAR_MOUNTED: Final = Question(
    "<bare, mount or off>/<nest>/<number>",
    "choice",
    "the ballbar is mounted, or taken off, as the text says",
    "mount/N1/1",
    choices=("done", "stop"),
    safe_answer="stop",
    motion=True,
)

READING: Final = Question(
    "reading/<nest>/<number>[/<attempt>]",
    "number",
    "what the ballbar reads",
    "reading/N1/0001",
    unit="mm",
    motion=True,
)

LENGTHS_FILE: Final = Question(
    "lengths/<nest>[/<attempt>]", "text", "path of the file that the ballbar has written", "lengths/N1"
)

SEATED: Final = Question(
    "cup/<number>[/<attempt>]",
    "choice",
    "the ball is led into the cup",
    "cup/1",
    choices=("done", "stop"),
    safe_answer="stop",
)

COMPARED: Final = Question(
    "bar[/<attempt>]",
    "choice",
    "the bar is mounted for comparison, or that is left out",
    "bar",
    choices=("skip", "done", "stop"),
    safe_answer="skip",
)
