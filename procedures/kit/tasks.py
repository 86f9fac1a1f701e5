"""What a person does on the bench before a question is answered, as data; an emulated bench has it done."""

from dataclasses import dataclass
from typing import Literal

OpticsKind = Literal["angular", "linear"]
"""Of an interferometer that stands beside the arm."""


@dataclass(frozen=True, kw_only=True)
class TurnScrew:
    """Turn an adjustment screw.

    Attributes:
        screw: its name, "stage" or "level".
        turns: how far; clockwise is positive.
    """

    do: Literal["turn-screw"] = "turn-screw"
    screw: str
    turns: float


@dataclass(frozen=True, kw_only=True)
class PlaceReflector:
    """Put a reflector into its nest."""

    do: Literal["place-reflector"] = "place-reflector"
    reflector: str


@dataclass(frozen=True, kw_only=True)
class MountInterferometer:
    """Take the interferometer off the arm and mount it turned about the arm's last axis.

    Attributes:
        turned_deg: angle against its mounting at the beginning of the run.
    """

    do: Literal["mount-interferometer"] = "mount-interferometer"
    turned_deg: float


@dataclass(frozen=True, kw_only=True)
class MountOptics:
    """Set optics up: the retroreflector on the arm, the interferometer and the laser on their stands.

    Attributes:
        optics: which.
        on: axis with which an angular retroreflector turns, or X, Y, Z of the base frame, along which a linear one
            moves.
    """

    do: Literal["mount-optics"] = "mount-optics"
    optics: OpticsKind
    on: str


@dataclass(frozen=True, kw_only=True)
class AlignOptics:
    """Adjust what is set up until the returning beam is as strong as it gets."""

    do: Literal["align-optics"] = "align-optics"


@dataclass(frozen=True, kw_only=True)
class ClearBeam:
    """Take away what stands in the beam."""

    do: Literal["clear-beam"] = "clear-beam"


Task = TurnScrew | PlaceReflector | MountInterferometer | MountOptics | AlignOptics | ClearBeam
