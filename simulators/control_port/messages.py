"""Requests of the control port and what answers them; faults have a module of their own.

Durations are bench time. The models import nothing of the emulation, so that clients can use them.
"""

import json
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from catseye.simulators.control_port.exchange import Answer, Request, known
from catseye.simulators.control_port.faults import Fault, fault_named
from catseye.simulators.control_port.gauge_messages import OPERATIONS as GAUGE_OPERATIONS
from catseye.simulators.control_port.survey_messages import OPERATIONS as SURVEY_OPERATIONS
from catseye.simulators.errors import EmulatorError

JogKey = Literal["A1+", "A1-", "A2+", "A2-", "A3+", "A3-", "A4+", "A4-", "A5+", "A5-", "A6+", "A6-"]
"""What an operator's hand presses to turn an axis."""

ModeSwitch = Literal["T1", "T2", "AUT", "EX", "AUTO", "MANR", "MANF"]
"""Where an operator's hand turns the mode switch to."""

PanelKey = Literal["start", "stop", "reset", "confirm", "drives", "main", "guard", ModeSwitch, JogKey]
"""What an operator's hand does at a controller's panel."""


class Identity(Answer):
    """Who answers, its bench time and its bench seconds in one real second.

    Attributes:
        behind_s: bench time by which it has fallen behind that speed, since the computer is too slow for it.
        started: tells this start of the bench from any other: what stands on it is as at the beginning again.
        truth: tells its true arm from any other, and says nothing about it.
    """

    name: str
    time_s: float
    speed: float
    behind_s: float = 0.0
    started: str = ""
    truth: str = ""


class Truth(Answer):
    """The true arm in the result format."""

    truth: dict[str, Any]


class BeamState(BaseModel):
    """Where the beam really goes.

    Attributes:
        reflector: that returns it, None without a return.
        returns: it is returned.
        lost: latch of the interferometer.
        lost_of: latches of all length counters by the name of the device.
        nearest: reflector that is missed least.
        miss_mm: distance of its centre from the beam's line.
        largest_miss_mm: since a counter was zeroed last.
        length_mm: true length of the beam to the nearest reflector.
        direction_deg: true world direction.
    """

    reflector: str | None
    returns: bool
    lost: bool
    lost_of: dict[str, bool]
    nearest: str
    miss_mm: float
    largest_miss_mm: float
    length_mm: float
    direction_deg: float


class MountState(BaseModel):
    """How the beam lies on the arm; `turns` is what each screw's head has turned, clockwise positive.

    Attributes:
        turned_deg: angle of the interferometer about the last axis against its first mounting.
        ahead_mm: how much farther along the beam its length begins than in that mounting.
    """

    turned_deg: float
    ahead_mm: float
    offset_mm: float
    pitch_mrad: float
    height_j3_mm: float
    turns: dict[str, float]


class Air(BaseModel):
    """The true state of the air, which no sensor knows."""

    temperature_c: float
    pressure_hpa: float
    humidity_percent: float


class ArmState(Answer):
    """The true state of an arm; joints in deg or mm.

    Attributes:
        joints: as commanded.
        true_joints: as they really are.
        alarm: of the controller, 0 for none.
        air: around the bench.
        coils: outputs by the name of the device.
    """

    time_s: float
    joints: tuple[float, ...]
    true_joints: tuple[float, ...]
    moving: bool
    servo: bool
    alarm: int
    air: Air
    coils: dict[str, list[bool]]


class State(ArmState):
    """The true state of a bench whose arm carries the beam.

    Attributes:
        play: states of the play of the joints that have any, -1...1.
        xy_mm: true position of the axis that turns the beam.
        in_place: nests with a reflector in them.
    """

    play: tuple[float, ...]
    xy_mm: tuple[float, float]
    beam: BeamState
    mount: MountState
    in_place: list[str]
    laser_ready: bool


class TrackedPlace(Answer):
    """The axis that turns the beam as a laser tracker sees it, with the standard uncertainty of a coordinate."""

    x_mm: float
    y_mm: float
    u_mm: float


class JournalEntry(BaseModel):
    """What the bench saw.

    Attributes:
        time_s: bench time.
        kind: `request` for what came over the wire, `motion` for what the arm did.
        text: the request or the event.
    """

    model_config = ConfigDict(frozen=True)

    time_s: float
    kind: str
    text: str


class Log(Answer):
    """The last events of a device, oldest first."""

    entries: list[JournalEntry]


class OpticsState(Answer):
    """What an interferometer beside a serial arm looks at.

    Attributes:
        kind: of the retroreflector, None for none.
        joint: that carries it, None for none.
        returns: the beam is returned.
        miss: 0 for a full signal, 1 where it is lost.
        spacing_mm: true distance of the prisms of the angular retroreflector.
        tilts_mrad: how far the beam is misaligned, by the screws' names.
        turns: what each screw's head has turned, clockwise positive.
    """

    kind: Literal["angular", "linear"] | None
    joint: str | None
    returns: bool
    miss: float
    spacing_mm: float
    tilts_mrad: dict[str, float]
    turns: dict[str, float]


class Nests(Answer):
    """Names of the nests with a reflector in them."""

    in_place: list[str]


class Identify(Request[Identity]):
    """Who is there?"""

    op = "identify"
    answer = Identity


class ReadTruth(Request[Truth]):
    """What is the true arm?"""

    op = "truth"
    answer = Truth


class ReadArm(Request[ArmState]):
    """What is the true state of the arm, whatever it carries?"""

    op = "arm"
    answer = ArmState


class ReadState(Request[State]):
    """What is the true state of a bench whose arm carries the beam?"""

    op = "state"
    answer = State


class Track(Request[TrackedPlace]):
    """Where does the laser tracker see the arm?"""

    op = "tracker"
    answer = TrackedPlace


class ReadLog(Request[Log]):
    """What came over the wire of a device? For the robot the arm's motions too."""

    op = "log"
    answer = Log
    device: str


class SetSpeed(Request[Answer]):
    """Set how many bench seconds pass in a real second."""

    op = "speed"
    value: float = Field(gt=0.0)


class TurnScrew(Request[Answer]):
    """Turn a screw of the mount, clockwise positive: of the arm's own, or of the stage beside a serial arm."""

    op = "turn_screw"
    screw: Literal["stage", "level", "pitch", "yaw"]
    # A screw has an end, and so has a hand's patience.
    turns: float = Field(ge=-20.0, le=20.0)


class MountInterferometer(Request[Answer]):
    """Take the interferometer off the arm and mount it so far turned against its first mounting."""

    op = "mount_interferometer"
    turned_deg: float = Field(ge=-360.0, le=360.0)


class PlaceReflector(Request[Nests]):
    """Put the reflector into a nest, the others are empty then; "all" fills them all."""

    op = "place_reflector"
    answer = Nests
    reflector: str


class MountAngularOptics(Request[OpticsState]):
    """Fasten the angular retroreflector to what a joint of a serial arm turns, and lead the beam to it roughly.

    Attributes:
        joint: its name.
        lever_mm: distance of the retroreflector from the joint's axis.
        offset_mm: along the beam, from the plane through that axis in which it should stand.
    """

    op = "mount_angular_optics"
    answer = OpticsState
    joint: str
    lever_mm: float = Field(default=60.0, ge=0.0, le=1000.0)
    offset_mm: float = Field(default=0.0, ge=-1000.0, le=1000.0)


class MountLinearOptics(Request[OpticsState]):
    """Fasten the linear retroreflector to the tool of a serial arm, with the beam along an axis of the base."""

    op = "mount_linear_optics"
    answer = OpticsState
    axis: Literal["X", "Y", "Z"]


class ReadOptics(Request[OpticsState]):
    """What does the interferometer beside a serial arm look at?"""

    op = "optics"
    answer = OpticsState


class ClearBeam(Request[Answer]):
    """Take away what stands in the beam."""

    op = "clear_beam"


class PressKey(Request[Answer]):
    """Press or turn something on the controller's operator panel."""

    op = "press"
    key: PanelKey


_KINDS: tuple[type[Request[Any]], ...] = (
    Identify,
    ReadTruth,
    ReadArm,
    ReadState,
    Track,
    ReadLog,
    SetSpeed,
    TurnScrew,
    MountInterferometer,
    PlaceReflector,
    MountAngularOptics,
    MountLinearOptics,
    ReadOptics,
    ClearBeam,
    PressKey,
    Fault,
    *GAUGE_OPERATIONS,
    *SURVEY_OPERATIONS,
)

_OPERATIONS = {kind.op: kind for kind in _KINDS}


def decode_request(line: bytes) -> Request[Any]:
    """Read a request.

    Raises:
        EmulatorError: it is no JSON object, or there is no such operation or fault.
        ValidationError: an argument is wrong.
    """
    try:
        document = json.loads(line)
    except (ValueError, RecursionError) as error:
        raise EmulatorError("a request is one JSON object on one line") from error
    if not isinstance(document, dict):
        raise EmulatorError("a request is one JSON object on one line")
    operation = known(_OPERATIONS, "op", document.pop("op", None))
    if operation is Fault:
        return fault_named(document.pop("name", None), document)
    return operation.model_validate(document)
