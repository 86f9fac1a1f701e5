"""What is asked about the beam, whatever is measured with it."""

from dataclasses import replace
from typing import Final

from catseye.procedures.kit.questions import Question

BEAM_LOST: Final = Question(
    "beam/<step>[/<number>]",
    "choice",
    "the beam is lost: try again, leave the place out, or end the run",
    "beam/P1/0042",
    choices=("retry", "skip", "stop"),
    safe_answer="stop",
    motion=True,
)

BEAM_NEEDED: Final = replace(
    BEAM_LOST, about="the beam is lost: try again, or end the run", choices=("retry", "stop")
)
"""Where no place can be left out."""

UNSETTLED: Final = Question(
    "unsettled/<where>/<number>",
    "choice",
    "the readings scatter: measure again, take them, or leave the place out",
    "unsettled/point 3/1",
    choices=("again", "take", "skip"),
    safe_answer="skip",
    motion=True,
    # The run drives on after any of them.
    rests_after=(),
)
