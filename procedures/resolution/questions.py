"""What measurements of motion resolution ask."""

from typing import Final

from catseye.procedures.kit.beam.questions import BEAM_LOST
from catseye.procedures.kit.questions import Question

DRIVE: Final = Question(
    "drive/<joint>/<place>",
    "confirm",
    "stands and cables are out of the way; no leaves the place out",
    "drive/A1/middle",
    motion=True,
)

OPTICS: Final = Question(
    "mount/<joint>/<place>",
    "choice",
    "the optics are mounted, or the place is left out",
    "mount/A1/middle",
    choices=("mounted", "skip", "stop"),
    safe_answer="stop",
)

ALIGN: Final = Question(
    "align/<joint>/<place>/<number>",
    "choice",
    "the optics are aligned, or the place is left out",
    "align/A1/middle/1",
    choices=("aligned", "skip", "stop"),
    safe_answer="stop",
    motion=True,
    rests_after=("skip", "stop"),
)

SLOW_COUNTER: Final = Question(
    "slow-counter",
    "choice",
    "the counter is read more slowly than the steps need",
    "slow-counter",
    choices=("stop", "anyway"),
    safe_answer="stop",
    motion=True,
)

CAMPAIGN: Final = (DRIVE, OPTICS, ALIGN, SLOW_COUNTER, BEAM_LOST)
