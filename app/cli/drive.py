"""What commands that drive a plan are given on the command line, whether it is new or goes on."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class DriveOptions:
    """How a plan is driven.

    Attributes:
        answers: TOML file of prompt id to answer.
        arm: the cell's name as typed to let real hardware move.
        speed: bench seconds in one real second; None for that of the run that goes on.
        keep_drives: leave the drives on at the end.
        waive_walk: why a real arm may be driven where it was not walked.
        as_json: events as JSON instead of talk.
    """

    answers: Path | None
    arm: str | None
    speed: float | None
    keep_drives: bool
    waive_walk: str | None
    as_json: bool
