"""Requests of the control port about what stands in the room of a serial arm, and their answers. Places are in mm.

The frame of the room is the nominal frame of the arm's base.
"""

from typing import Annotated, Any

from pydantic import Field

from catseye.simulators.control_port.exchange import Answer, Request
from catseye.simulators.survey import Place

Far = Annotated[float, Field(ge=-20_000.0, le=20_000.0)]
Frame = tuple[tuple[float, float, float, float], ...]
"""Four rows of a homogeneous transform into the room."""


class SurveyState(Answer):
    """Where everything really is at this moment.

    Attributes:
        base: of the arm, without what its links do.
        flange: of the arm.
        nests: places of all nests in the room, by name.
        empty: nests without a retroreflector.
        tracker: frame of the laser tracker.
        locked: nest that its beam follows, None for none.
        cmm: frame of the optical CMM.
        ballbar: nest in which the ballbar hangs, None for none.
    """

    base: Frame
    flange: Frame
    nests: dict[str, Place]
    empty: list[str]
    tracker: Frame
    locked: str | None
    cmm: Frame
    ballbar: str | None


class BallbarReading(Answer):
    """What the ballbar shows: by how much it is longer than its nominal length; None: over range, or not mounted."""

    deviation_mm: float | None
    mounted: str | None


class BallbarRecording(Answer):
    """What the ballbar's program has recorded since the last mounting, over range left out.

    Attributes:
        t_s: since then.
        deviation_mm: from its nominal length.
    """

    t_s: list[float]
    deviation_mm: list[float]


class ReadSurvey(Request[SurveyState]):
    """Where is everything in the room?"""

    op = "survey"
    answer = SurveyState


class SetUpScaleBar(Request[Answer]):
    """Stand the scale bar on its tripod: its middle, and its direction about z; its ends are bar1 and bar2."""

    op = "set_up_scale_bar"
    x_mm: Far
    y_mm: Far
    z_mm: Far
    turn_deg: float = Field(default=0.0, ge=-360.0, le=360.0)


class PlaceTarget(Request[Answer]):
    """Put a retroreflector back into its nest, and fasten the nest."""

    op = "place_target"
    target: str


class LeadTracker(Request[Answer]):
    """Lead the beam of the laser tracker by hand to a retroreflector; that of a SCARA is called arm."""

    op = "lead_tracker"
    target: str


class PlaceCup(Request[Answer]):
    """Clamp the ballbar's cup under the ball in a nest of the tool, where that is now."""

    op = "place_cup"
    target: str


class MountBallbar(Request[BallbarReading]):
    """Hang the ballbar between its cup and a nest of the tool, in place of the retroreflectors there.

    Attributes:
        target: the nest.
        centre_mm: where the cup is put first, in the room; None: it stays where it is.
    """

    op = "mount_ballbar"
    answer = BallbarReading
    target: str
    centre_mm: tuple[Far, Far, Far] | None = Field(default=None, strict=False)


class TakeBallbarOff(Request[Answer]):
    """Take the ballbar off and put the retroreflectors back."""

    op = "take_ballbar_off"


class ReadBallbar(Request[BallbarReading]):
    """What does the ballbar show?"""

    op = "ballbar"
    answer = BallbarReading


class ReadBallbarRecording(Request[BallbarRecording]):
    """What has the ballbar's program recorded?"""

    op = "ballbar_recording"
    answer = BallbarRecording


SurveyRequest = (
    ReadSurvey
    | SetUpScaleBar
    | PlaceTarget
    | PlaceCup
    | MountBallbar
    | TakeBallbarOff
    | ReadBallbar
    | ReadBallbarRecording
)

OPERATIONS: tuple[type[Request[Any]], ...] = (
    ReadSurvey,
    SetUpScaleBar,
    PlaceTarget,
    LeadTracker,
    PlaceCup,
    MountBallbar,
    TakeBallbarOff,
    ReadBallbar,
    ReadBallbarRecording,
)
