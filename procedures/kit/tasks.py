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


@dataclass(frozen=True, kw_only=True)
class SetUpScaleBar:
    """Stand the scale bar on its tripod, level, with a retroreflector at either end.

    Attributes:
        place_mm: of its middle, in the frame of the arm's base.
        turn_deg: of its direction about z, from x.
    """

    do: Literal["set-up-scale-bar"] = "set-up-scale-bar"
    place_mm: tuple[float, float, float]
    turn_deg: float = 0.0


@dataclass(frozen=True, kw_only=True)
class PlaceTarget:
    """Put the retroreflector of a tracker back into its nest, and see that the nest sits firmly."""

    do: Literal["place-target"] = "place-target"
    target: str


@dataclass(frozen=True, kw_only=True)
class LeadTracker:
    """Lead the beam of a tracker to the retroreflector that it shall follow.

    Attributes:
        target: where that sits; "arm" for the one that a SCARA carries.
    """

    do: Literal["lead-tracker"] = "lead-tracker"
    target: str


@dataclass(frozen=True, kw_only=True)
class SeatInCup:
    """Lead a nest of the tool by hand until its ball sits in the ballbar's cup, or clamp the cup under the ball.

    Attributes:
        target: the nest.
    """

    do: Literal["seat-in-cup"] = "seat-in-cup"
    target: str


@dataclass(frozen=True, kw_only=True)
class MountBallbar:
    """Hang the ballbar between its cup and a nest of the tool.

    Attributes:
        target: the nest.
        centre_mm: where the cup is put first, in the frame of the arm's base; None: it stays where it is.
    """

    do: Literal["mount-ballbar"] = "mount-ballbar"
    target: str
    centre_mm: tuple[float, float, float] | None = None


@dataclass(frozen=True, kw_only=True)
class TakeBallbarOff:
    """Take the ballbar off and put the retroreflectors back."""

    do: Literal["take-ballbar-off"] = "take-ballbar-off"


@dataclass(frozen=True, kw_only=True)
class ReadBallbar:
    """Type what the ballbar shows: its deviation from its nominal length, mm; "none" where it shows no number.

    A question with this task is the one kind that hands on an emulated bench answer with a number.
    """

    do: Literal["read-ballbar"] = "read-ballbar"


@dataclass(frozen=True, kw_only=True)
class ExportBallbar:
    """Have the ballbar's program write its recording of the last mounting into the file that is typed."""

    do: Literal["export-ballbar"] = "export-ballbar"


@dataclass(frozen=True, kw_only=True)
class MountArtefact:
    """Fasten a ball or a cylinder to what a joint turns, on the joint's axis, and set indicators to it.

    Attributes:
        joint: number of the joint, from 1.
        turned: by half a turn against the joint, with the indicators on the other side.
    """

    do: Literal["mount-artefact"] = "mount-artefact"
    joint: int
    turned: bool = False


@dataclass(frozen=True, kw_only=True)
class TapArtefact:
    """Push the artefact towards the indicator in x; away from it where negative."""

    do: Literal["tap-artefact"] = "tap-artefact"
    by_um: float


@dataclass(frozen=True, kw_only=True)
class ReadIndicator:
    """Type what an indicator shows, µm: more where the artefact is nearer.

    Hands on an emulated bench answer a question with this task with a number, as one with `ReadBallbar`.

    Attributes:
        direction: in which it reads, "x" or "y".
    """

    do: Literal["read-indicator"] = "read-indicator"
    direction: Literal["x", "y"]


@dataclass(frozen=True, kw_only=True)
class TakeIndicatorOff:
    """Take artefact and indicators away."""

    do: Literal["take-indicator-off"] = "take-indicator-off"


TaskAtAnAxis = MountArtefact | TapArtefact | ReadIndicator | TakeIndicatorOff
"""What a person does with an artefact on the axis of a joint, and the indicators that read it."""

TaskInTheRoom = (
    SetUpScaleBar
    | PlaceTarget
    | LeadTracker
    | SeatInCup
    | MountBallbar
    | TakeBallbarOff
    | ReadBallbar
    | ExportBallbar
)
"""What a person does with a tracker, its targets and a ballbar around an arm."""

Task = (
    TurnScrew
    | PlaceReflector
    | MountInterferometer
    | MountOptics
    | AlignOptics
    | ClearBeam
    | TaskAtAnAxis
    | TaskInTheRoom
)
